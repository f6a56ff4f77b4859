"""How long a reader of rclpy counts a publisher that was killed; prints the seconds.

With the word ``publish`` it is the publisher.
"""

import subprocess
import sys
import time

import rclpy
from std_msgs.msg import Bool

TOPIC = "/dies"


def wait(node, count):
    """Wait until there are so many publishers."""
    end = time.monotonic() + 60.0
    while node.count_publishers(TOPIC) != count:
        assert time.monotonic() < end, f"not {count} publishers"
        time.sleep(0.01)


def main():
    """Kill a publisher."""
    rclpy.init()
    node = rclpy.create_node("publisher" if "publish" in sys.argv else "reader")
    if "publish" in sys.argv:
        node.create_publisher(Bool, TOPIC, 1)
        rclpy.spin(node)
    with subprocess.Popen([sys.executable, __file__, "publish"]) as publisher:
        try:
            wait(node, 1)
            time.sleep(1.0)  # its last announcement is as old as any
        finally:
            publisher.kill()
        killed = time.monotonic()
    wait(node, 0)
    print(time.monotonic() - killed)


if __name__ == "__main__":
    main()
