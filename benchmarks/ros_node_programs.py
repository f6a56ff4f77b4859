"""ROS programs of benchmarks/ros_node.py; they run under /usr/bin/python3, which has rospy.

ros_node_programs.py measure N PAUSE NAME...   toggles evidence, measures until the answer
ros_node_programs.py rate HZ                   what SESAME D7.2 Fig 31 prints, with rospy.Rate
ros_node_programs.py callback                  the least a node can do: answers in the callback
"""

from __future__ import annotations

import json
import random
import sys
import threading
import time

import rospy
from eddi_messages.msg import ConSertOutput, Guarantee
from std_msgs.msg import Bool


class Target:
    """One node under test: evidence goes in, the guarantee comes back."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.seconds: list[float] = []
        self._wanted: bool | None = None
        self._sent = 0.0
        self._flipped = threading.Event()
        self._evidence = rospy.Publisher(f"/{name}/flag", Bool, queue_size=1)
        rospy.Subscriber(f"/{name}/guarantees", ConSertOutput, self._answer, tcp_nodelay=True)

    def greet(self) -> None:
        """Wait until the node is there and answers; a latched first message has no known age."""
        for value in (True, False):
            end = time.monotonic() + 120.0
            while not self._answered(value, 0.3):
                if time.monotonic() > end:
                    sys.exit(f"{self.name}: it is not there")
        self.seconds.clear()

    def toggle(self, value: bool, timeout: float) -> None:
        """Send evidence and wait for the guarantee that follows from it."""
        if not self._answered(value, timeout):
            sys.exit(f"{self.name}: no answer within {timeout} s")

    def _answered(self, value: bool, timeout: float) -> bool:
        self._flipped.clear()
        self._wanted = value
        self._sent = time.perf_counter()
        self._evidence.publish(Bool(value))
        return self._flipped.wait(timeout)

    def _answer(self, message: ConSertOutput) -> None:
        now = time.perf_counter()
        active = any(guarantee.active for guarantee in message.guarantees)
        if self._wanted is not None and active == self._wanted:
            self._wanted = None
            self.seconds.append(now - self._sent)
            self._flipped.set()


def measure(count: str, pause: str, *names: str) -> None:
    """Toggle all targets in turn at random phases; print the latencies as JSON.

    Args:
        count: toggles of each target.
        pause: seconds; the longest wait before a toggle, at least one period of the nodes.
        names: namespaces of the targets.
    """
    rospy.init_node("measure")
    random.seed(1)
    targets = [Target(name) for name in names]
    for target in targets:
        target.greet()
    for _ in range(int(count) // 2):
        for target in targets:
            for value in (True, False):
                time.sleep(random.uniform(0.003, float(pause)))
                target.toggle(value, 20.0)
    print(json.dumps({target.name: target.seconds for target in targets}))


def rate(hertz: str) -> None:
    """Run the node that D7.2 prints."""
    rospy.init_node("peer")
    values: dict[str, Bool] = {}
    rospy.Subscriber("flag", Bool, lambda message: values.update(flag=message))
    out = rospy.Publisher("guarantees", ConSertOutput, queue_size=1)
    clock = rospy.Rate(float(hertz))
    while not rospy.is_shutdown():
        active = bool(values["flag"].data) if "flag" in values else False
        out.publish(ConSertOutput([Guarantee("G_F", active)]))
        try:
            clock.sleep()
        except rospy.ROSInterruptException:
            return


def callback() -> None:
    """Answer at once, without monitor, ages, diagnostics or any check."""
    rospy.init_node("peer")
    out = rospy.Publisher("guarantees", ConSertOutput, queue_size=1, latch=True)
    rospy.Subscriber(
        "flag",
        Bool,
        lambda message: out.publish(ConSertOutput([Guarantee("G_F", message.data)])),
        queue_size=1,
        tcp_nodelay=True,
    )
    rospy.spin()


if __name__ == "__main__":
    program, *given = rospy.myargv()[1:]
    {"measure": measure, "rate": rate, "callback": callback}[program](*given)
