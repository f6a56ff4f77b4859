"""What packages of ROS have in common, whichever ROS or DDS it is: their messages and names."""
