"""The rclpy program of benchmarks/ros_node.py: the least a node can do, which answers at once."""

import sys

import rclpy
from eddi_messages.msg import ConSertOutput, Guarantee
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Bool


def main() -> None:
    """Answer without monitor, ages, diagnostics or any check."""
    (name,) = sys.argv[1:]
    rclpy.init()
    node = Node(name)
    topic = f"/{name}/rover/guarantees"
    publisher = node.create_publisher(ConSertOutput, topic, QoSProfile(depth=1))

    def answer(message: Bool) -> None:
        made = Guarantee(id="Slow", active=message.data)
        publisher.publish(ConSertOutput(guarantees=[made]))

    node.create_subscription(Bool, f"/{name}/in/healthy", answer, QoSProfile(depth=5))
    rclpy.spin(node)


if __name__ == "__main__":
    main()
