"""The rclpy program of benchmarks/ros_node.py: the least a node can do, which answers at once."""

import rclpy
from eddi_messages.msg import ConSertOutput, Guarantee
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Bool


def main() -> None:
    """Answer without monitor, ages, diagnostics or any check."""
    rclpy.init()
    node = Node("peer")
    publisher = node.create_publisher(ConSertOutput, "/peer/rover/guarantees", QoSProfile(depth=1))

    def answer(message: Bool) -> None:
        made = Guarantee(id="Slow", active=message.data)
        publisher.publish(ConSertOutput(guarantees=[made]))

    node.create_subscription(Bool, "/peer/in/healthy", answer, QoSProfile(depth=5))
    rclpy.spin(node)


if __name__ == "__main__":
    main()
