"""Publishes frames on a real ROS 1, as the camera of the example would; runs on ROS' own Python.

safeml_stream.py FRAMES.json    a list of frames, each a list of numbers (may be empty)
"""

import json
import sys

import rospy
from std_msgs.msg import Bool, Float32MultiArray

RATE = 20.0


def main(file):
    with open(file) as stream:  # noqa: PTH123 - an old Python may run this
        frames = json.load(stream)
    rospy.init_node("camera")
    features = rospy.Publisher("/camera/features", Float32MultiArray, queue_size=100)
    marker = rospy.Publisher("/camera/marker", Bool, queue_size=10)
    rate = rospy.Rate(RATE)
    while features.get_num_connections() == 0 or marker.get_num_connections() == 0:
        rate.sleep()
    for frame in frames:
        features.publish(Float32MultiArray(data=frame))
        marker.publish(Bool(data=True))
        rate.sleep()
    rospy.sleep(1.0)


if __name__ == "__main__":
    main(sys.argv[1])
