"""ROS 1 adapter of the runtime: the only part of it that imports rospy."""
