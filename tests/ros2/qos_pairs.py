"""Writers and readers of two participants, one pair for each way to offer and to request.

Prints for each pair whether they meet, what our node would say of it, and whether the reader is
told what was written before it was there.
"""

import itertools
import json
import time

import rclpy
from eddi_runtime.node.topics import reading_qos, writing_qos
from eddi_runtime.transports.ros2.process import keeps, profile, refused
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Bool

RELIABILITY, DURABILITY = ("best_effort", "reliable"), ("volatile", "transient_local")
DEADLINES = ({}, {"deadline": 0.5}, {"deadline": 2.0})


def pairs():
    """Return what is offered, and what is requested."""
    kinds = [
        {"reliability": one, "durability": two}
        for one, two in itertools.product(RELIABILITY, DURABILITY)
    ]
    yield from itertools.product(kinds, kinds)  # 16
    yield from itertools.product(DEADLINES, DEADLINES)  # 9
    for more in ({"lifespan": 0.5}, {"lifespan": 60.0}, {"depth": 1}):
        yield from (
            (more, kind) for kind in ({}, {"depth": 7}, {"durability": "transient_local"})
        )  # 9


def main():
    """Run all at once."""
    nodes = []
    for name in ("writers", "readers"):
        context = rclpy.Context()
        rclpy.init(context=context)
        nodes.append(rclpy.create_node(name, context=context))
    wanted = list(pairs())
    profiles = [
        (profile(writing_qos(offered, 1)), profile(reading_qos(asked, 5)))
        for offered, asked in wanted
    ]
    heard = [False] * len(wanted)
    writers = [
        nodes[0].create_publisher(Bool, f"/pair{k}", qos) for k, (qos, _) in enumerate(profiles)
    ]
    for writer in writers:
        writer.publish(Bool(data=True))
    time.sleep(1.0)  # longer than the shorter lifespan

    def receiver(k):
        def receive(_):
            heard[k] = True

        return receive

    readers = [
        nodes[1].create_subscription(Bool, f"/pair{k}", receiver(k), qos)
        for k, (_, qos) in enumerate(profiles)
    ]
    spinner = SingleThreadedExecutor(context=nodes[1].context)
    spinner.add_node(nodes[1])
    expected = [not refused(asked, [offered]) for offered, asked in profiles]
    end = time.monotonic() + 20.0

    def met():
        return [writer.get_subscription_count() > 0 for writer in writers]

    while met() != expected and time.monotonic() < end:
        spinner.spin_once(timeout_sec=0.05)
    settled = time.monotonic() + 2.0  # more come than should, or what was kept
    while time.monotonic() < settled:
        spinner.spin_once(timeout_sec=0.05)
    for found, told, (offered, asked), late, (has, wants) in zip(
        met(), expected, wanted, heard, profiles, strict=True
    ):
        reliable = wants.reliability == ReliabilityPolicy.RELIABLE
        kept = told and keeps(has) and keeps(wants) and reliable
        kept &= offered.get("lifespan", 9.0) > 1.0
        row = {"offered": offered, "asked": asked, "met": found, "expected": told}
        print(json.dumps({**row, "late": late, "kept": kept}))
    assert len(readers) == len(writers)


if __name__ == "__main__":
    main()
