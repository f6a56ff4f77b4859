#!/usr/bin/env python3
import rospy

from sensor_msgs.msg import Imu
from eddi_messages.msg import Guarantee, ConSertOutput

from EDDIInput import EDDIInput
from EDDIMonitor import EDDIMonitor


class RosNode:

    def __init__(self, monitor):
        self.monitor = monitor
        self.rate = rospy.Rate(10)
        self.eddi_input = EDDIInput()
        self.simulator_values = {}

    def imu_callback(self, data):
        self.simulator_values['imu'] = data

    def station_callback(self, data):
        self.simulator_values['station'] = data

    def init_subscriber(self):
        rospy.Subscriber('/imu', Imu, self.imu_callback)
        rospy.Subscriber('/station/guarantees', ConSertOutput, self.station_callback)

    def init_publisher(self):
        self.rover_pub = rospy.Publisher('/rover/guarantees', ConSertOutput, queue_size=1)

    def ros_main(self):
        rospy.init_node('rover')
        self.init_subscriber()
        self.init_publisher()
        while not rospy.is_shutdown():
            self.eddi_input.processing(self.simulator_values)
            output = self.monitor.execute_step(self.eddi_input)
            self.rover_pub.publish([Guarantee(**one) for one in output])
            self.rate.sleep()


if __name__ == '__main__':
    RosNode(EDDIMonitor()).ros_main()
