"""The loop: rates, wake-up by messages, names, bursts, a subscriber that hangs."""

import socket
import struct
import time
import xmlrpc.client

import pytest

from tests.ros1.world import until

pytestmark = pytest.mark.ros
BOOL, TEXT = "std_msgs/Bool", "std_msgs/String"


def test_rates_bursts_and_on_change(world, master, probe, model_files):
    """Row 21, fractions of Hz, and on_change: at once on a message, at the frequency without."""
    model = f"compiled:={model_files['tester_half']}"
    start = probe.mark()
    for space in ("slow", "burst", "change"):
        probe.subscribe(f"/{space}/guarantees")
    world.node(master, "tester", model, "__ns:=/slow", "_frequency:=2.5")
    world.node(master, "tester", model, "__ns:=/burst")
    change = {"TESTER_MODE": "on_change"}
    world.node(master, "tester", model, "__ns:=/change", "_frequency:=0.5", env=change)
    for space in ("slow", "burst", "change"):
        probe.active(f"/{space}/guarantees", set(), after=start)

    source = world.probe(master)
    source.do("every", topic="/burst/flag", kind=BOOL, fields={"data": True}, hz=1500)
    probe.active("/burst/guarantees", {"G_F"})
    mark = probe.mark()
    time.sleep(2.0)
    burst, slow = (probe.outputs(f"/{space}/guarantees", mark) for space in ("burst", "slow"))
    assert 17 <= len(burst) <= 22  # 10 Hz, whatever comes in
    assert 4 <= len(slow) <= 6
    source.do("stop", topic="/burst/flag")
    sent = source.wait(lambda e: e["event"] == "sent")
    assert sent["count"] > 1000
    _, _, values = probe.diagnostics(
        "/burst/tester", lambda lv, t, v: int(v["F.received"]) > 0.5 * sent["count"]
    )
    assert values["F"] in ("ok", "stale")

    delays = []
    for value in [True, False] * 5:
        mark = probe.mark()
        sent = probe.publish("/change/flag", BOOL, {"data": value}, connected=True)
        expected = {"G_F"} if value else set()
        delays.append(probe.active("/change/guarantees", expected, after=mark)["t"] - sent["t"])
    assert sorted(delays)[5] < 0.2  # one period of the rate is 2 s
    mark = probe.mark()
    probe.publish("/change/flag", BOOL, {"data": True})
    probe.active("/change/guarantees", {"G_F"}, after=mark)
    mark = probe.mark()
    stale = probe.active("/change/guarantees", set(), after=mark)  # nobody sends anything
    assert stale


def test_remaps_and_namespaces(world, master, probe, model_files):
    """Relative topics follow the namespace."""
    start = probe.mark()
    model = f"compiled:={model_files['tester']}"
    for topic in ("/robot1/guarantees", "/elsewhere", "/robot3/guarantees"):
        probe.subscribe(topic)
    world.node(master, "tester", model, "__ns:=/robot1")
    world.node(master, "tester", model, "__ns:=/robot2", "guarantees:=/elsewhere", "flag:=/flag2")
    master.call("setParam", "/robot3/mine/watchdog_period", 0)
    half = f"compiled:={model_files['tester_half']}"
    third = world.node(master, "tester", half, "__name:=mine", env={"ROS_NAMESPACE": "robot3"})
    probe.publish("/robot1/flag", BOOL, {"data": True}, latch=True)
    probe.active("/robot1/guarantees", {"G_F"}, after=start)
    probe.publish("/flag2", BOOL, {"data": True}, latch=True)
    probe.active("/elsewhere", {"G_F"}, after=start)
    probe.active("/robot3/guarantees", set(), after=start)
    assert master.call("lookupNode", "/robot3/mine")
    _, _, values = probe.diagnostics("/robot3/mine", lambda *_: True)
    assert f'digest = "{values["model_digest"]}"' in model_files["tester_half"].read_text()
    assert values["master"] == "not watched"
    assert third.end()[0] == 0


def hung_subscriber(master, node, topic, kind, md5):
    """Connect as a subscriber with a tiny receive buffer that never reads."""
    uri = until(lambda: master.call("lookupNode", node))
    proxy = xmlrpc.client.ServerProxy(uri)
    answer = []

    def offered():
        answer[:] = proxy.requestTopic("/hung", topic, [["TCPROS"]])
        return answer[0] == 1

    until(offered)
    _, host, port = answer[2]
    line = socket.socket()
    line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    line.connect((host, port))
    fields = {"callerid": "/hung", "topic": topic, "type": kind, "md5sum": md5}
    parts = [f"{key}={value}".encode() for key, value in fields.items()]
    header = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    line.sendall(struct.pack("<I", len(header)) + header)
    return line


def test_a_subscriber_that_hangs(world, master, probe, model_files):
    """Row 13: the period is kept while one subscriber takes nothing.

    The outputs have 60 kB each, so that the buffers of the system (some MB) are full at once.
    """
    start = probe.mark()
    model = f"compiled:={model_files['wide']}"
    world.node(master, "tester", model, "__ns:=/hung", "_frequency:=100")
    md5 = "c306fb7ec8f6dbe6af438338cb2d6720"
    kind = "eddi_messages/ConSertOutput"
    lines = [
        hung_subscriber(master, "/hung/tester", "/hung/guarantees", kind, md5) for _ in range(2)
    ]
    _, _, values = probe.diagnostics("/hung/tester", lambda *_: True, after=start)
    before = int(values["steps"])
    _, _, values = probe.diagnostics(
        "/hung/tester", lambda lv, t, v: int(v["steps"]) > before + 200, timeout=15.0
    )
    assert float(values["longest_step_ms"]) < 100.0 + 150.0  # the second: a busy machine
    for line in lines:
        line.close()
