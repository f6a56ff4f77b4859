"""Publishes the messages of a bag as fast as they were recorded: `rosbag play` is not in Debian."""

import importlib
import sys
import time

import rosbag
import rospy

rospy.init_node("play_bag")
with rosbag.Bag(sys.argv[1]) as bag:
    publishers = {}
    for topic, info in bag.get_type_and_topic_info().topics.items():
        package, name = info.msg_type.split("/")
        message_class = getattr(importlib.import_module(package + ".msg"), name)
        publishers[topic] = rospy.Publisher(topic, message_class, queue_size=10)
    while not all(of.get_num_connections() for of in publishers.values()):
        time.sleep(0.05)
    print("playing", flush=True)
    start = time.monotonic()
    for topic, message, stamp in bag.read_messages():
        time.sleep(max(0.0, start + stamp.to_sec() - bag.get_start_time() - time.monotonic()))
        publishers[topic].publish(message)
    time.sleep(1.0)
