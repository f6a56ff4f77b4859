"""A ROS 1 graph as a source, without ROS: its master is asked, its publishers are listened to.

Nothing is registered at the master, so nobody on the graph notices.
"""
