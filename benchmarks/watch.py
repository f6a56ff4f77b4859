"""What `watch` costs: 100 guarantees at 10 Hz on a real graph, while a page is open.

Figures are seconds of processor time per second, of the whole process with its page, and of the
process with rospy that it starts on ROS 1. The peer is a
node of rospy that subscribes to the same status topics and keeps the last message of each, as the
smallest view would. Goal: below 0.1. "All change" gives each guarantee a random state once a
second.

    python benchmarks/watch.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import contextlib
import http.client
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the world of real ROS processes is that of the tests

from eddi_scaffold.kinds.consert import MESSAGES  # noqa: E402
from tests.contract.stages import environment, free_domain, why_no_dds  # noqa: E402
from tests.ros1.world import PYTHON, World, make_messages, until, why_no_ros  # noqa: E402

ROS1_PUBLISHER = """
import random, sys, rospy
from eddi_messages.msg import ConSertStatus, GuaranteeStatus
monitors, guarantees, change = map(int, sys.argv[1:])
rospy.init_node("publisher")
made = []
for m in range(monitors):
    topic = rospy.Publisher("/robot/m%d/guarantees/status" % m, ConSertStatus, queue_size=5)
    rows = [GuaranteeStatus("G%d" % g, 0, ["RtE_%d" % g, "RtE_x"]) for g in range(guarantees)]
    made.append((topic, ConSertStatus(model_id="M%d" % m, model_digest="d" * 64, guarantees=rows)))
rate, step = rospy.Rate(10), 0
while not rospy.is_shutdown():
    step += 1
    for topic, message in made:
        message.header.stamp = rospy.Time.now()
        if change and step % 10 == 0:
            for row in message.guarantees:
                row.verdict = random.choice((0, 2))
        topic.publish(message)
    rate.sleep()
"""
ROS1_PEER = """
import sys, rospy
from eddi_messages.msg import ConSertStatus
rospy.init_node("peer")
last = {}
for m in range(int(sys.argv[1])):
    topic = "/robot/m%d/guarantees/status" % m
    rospy.Subscriber(topic, ConSertStatus, lambda one, topic=topic: last.update({topic: one}))
rospy.spin()
"""
DDS_PUBLISHER = """
import os, random, sys, time
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from eddi_runtime.transports.dds.graph import told, writing
from eddi_runtime.transports.dds.messages import message_classes, stamp
of = vars(message_classes({
    "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
    "eddi_messages/GuaranteeStatus": "string id, uint8 verdict, string[] missing",
    "eddi_messages/ConSertStatus": "std_msgs/Header header, string model_id, string model_digest,"
    " eddi_messages/GuaranteeStatus[] guarantees, string[] accepted",
}))
monitors, guarantees, change = map(int, sys.argv[1:])
node, made = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"])), []
cls, row = of["eddi_messages_ConSertStatus"], of["eddi_messages_GuaranteeStatus"]
for m in range(monitors):
    topic = Topic(node, "rt/robot/m%d/guarantees/status" % m, cls)
    writer = DataWriter(node, topic, told(cls, writing({}, 1)))
    lacks = [["RtE_%d" % g, "RtE_x"] for g in range(guarantees)]
    rows = [row(id="G%d" % g, verdict=0, missing=one) for g, one in enumerate(lacks)]
    made.append((writer, cls(model_id="M%d" % m, model_digest="d" * 64, guarantees=rows)))
step = 0
while True:
    step += 1
    for writer, message in made:
        message.header.stamp.sec, message.header.stamp.nanosec = step, 1
        if change and step % 10 == 0:
            for one in message.guarantees:
                one.verdict = random.choice((0, 2))
        writer.write(message)
    time.sleep(0.1)
"""
CASES = {
    "10 monitors of 10 guarantees": (10, 10, 0),
    "10 monitors of 10, all change": (10, 10, 1),
    "100 monitors of 1 guarantee": (100, 1, 0),
}
Row = dict[str, object]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one case each, shorter")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    seconds = 3.0 if options.quick else 15.0
    cases = dict(list(CASES.items())[: 1 if options.quick else None])
    rows = [*ros1(cases, seconds), *dds(cases, seconds)]
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
        return
    print(f"{'case':42} {'watch':>8} {'peer':>8} {'ratio':>7}")
    for row in rows:
        numbers = (row["ours_s"], row["peer_s"], row["ratio"])
        shown = " ".join(f"{'-' if one is None else f'{one:.3f}':>8}" for one in numbers)
        print(f"{row['case']:42} {shown}  {row.get('reason', '')}")


def row(case: str, ours: float | None, peer: float | None, reason: str = "") -> Row:
    ratio = peer / ours if peer is not None and ours else None
    found: Row = {"case": case, "ours_s": ours, "peer": "rospy", "peer_s": peer, "ratio": ratio}
    return {**found, "reason": reason} if reason else found


def ros1(cases: dict[str, tuple[int, int, int]], seconds: float) -> Iterator[Row]:
    reason = why_no_ros()
    if reason is not None:
        yield from (row(f"ROS 1, {case}", None, None, reason) for case in cases)
        return
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        messages = make_messages(folder / "messages", MESSAGES)
        for case, numbers in cases.items():
            world = World(folder, messages)
            try:
                master = world.master()
                env = world.env(master)
                words = [str(one) for one in numbers]
                world.process([PYTHON, "-c", ROS1_PUBLISHER, *words], env)
                peer = world.process([PYTHON, "-c", ROS1_PEER, words[0]], env)
                with watching(["--master", master.uri], dict(os.environ), numbers) as ours:
                    spent, of_peer = measured([ours, peer.popen.pid], seconds)
                yield row(f"ROS 1, {case}", spent, of_peer)
            finally:
                world.destroy()


def dds(cases: dict[str, tuple[int, int, int]], seconds: float) -> Iterator[Row]:
    reason = why_no_dds()
    if reason is not None:
        yield from (row(f"DDS, {case}", None, None, reason) for case in cases)
        return
    for case, numbers in cases.items():
        lock, domain = free_domain()
        env = environment(domain, ROOT)
        command = [sys.executable, "-c", DDS_PUBLISHER, *map(str, numbers)]
        publisher = subprocess.Popen(command, env=env)
        try:
            with watching(["--domain", str(domain)], env, numbers) as ours:
                (spent,) = measured([ours], seconds)
            yield row(f"DDS, {case}", spent, None, "rospy knows no DDS")
        finally:
            publisher.kill()
            publisher.wait()
            lock.close()


@contextlib.contextmanager
def watching(words: list[str], env: dict[str, str], numbers: tuple[int, int, int]) -> Iterator[int]:
    """Yield the process of the command, once its page shows every guarantee, and keep it open."""
    env = {**env, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"}
    command = [sys.executable, "-m", "eddi_scaffold", "watch", *words]
    process = subprocess.Popen(command, env=env, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        said = process.stderr.readline()
        found = re.search(r":(\d+)/", said)
        assert found is not None, said
        port = int(found[1])
        wanted = numbers[0] * numbers[1]
        until(lambda: page(port).count('<th scope="row">') == wanted, 60.0, "every guarantee")
        stop = threading.Event()
        reader = threading.Thread(target=follow, args=(port, stop.is_set), daemon=True)
        reader.start()
        yield process.pid
        stop.set()
    finally:
        process.kill()
        process.wait()


def page(port: int) -> str:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", "/")
    text = connection.getresponse().read().decode()
    connection.close()
    return text


def follow(port: int, stopped: Callable[[], bool]) -> None:
    """Read the events of the page, and its graph as often as a browser would."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", "/events")
    stream = connection.getresponse()
    picture = b""
    with contextlib.suppress(OSError, ValueError):
        while not stopped() and (line := stream.readline()):
            pictures = re.findall(rb"/graph/0\.svg\?[0-9]+", line)
            if pictures and pictures[0] != picture:
                picture = pictures[0]
                other = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
                other.request("GET", picture.decode())
                other.getresponse().read()
                other.close()


def measured(pids: list[int], seconds: float) -> list[float]:
    """Return the share of a core that processes take."""
    time.sleep(1.0)
    before, start = [spent(pid) for pid in pids], time.monotonic()
    time.sleep(seconds)
    passed = time.monotonic() - start
    return [(spent(pid) - one) / passed for pid, one in zip(pids, before, strict=True)]


def spent(pid: int) -> float:
    """Return the processor time of a process, and of its child with rospy."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    own = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return own + sum(spent(int(child)) for child in children)


if __name__ == "__main__":
    main()
