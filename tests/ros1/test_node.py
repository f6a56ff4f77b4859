"""What only rospy does to a node; the rest is tested in virtual time (`runtime_lib/tests`)."""

import signal
import socket
import struct
import xmlrpc.client

import pytest

from tests.ros1.world import until

pytestmark = pytest.mark.ros
BOOL, TEXT = "std_msgs/Bool", "std_msgs/String"


def test_none_in_a_message_made_by_hand(world, master, probe, model_files):
    """An overridden create_ros_msg may do anything, nothing stays active, nothing dies."""
    start = probe.mark()
    probe.subscribe("/hand/guarantees")
    model = f"compiled:={model_files['tester']}"
    node = world.node(master, "tester", model, "__ns:=/hand", env={"TESTER_HAND_MADE": "1"})
    probe.publish("/hand/how", TEXT, {"data": "true"}, latch=True)
    probe.active("/hand/guarantees", {"G_E"}, after=start)
    mark = probe.mark()
    probe.publish("/hand/flag", BOOL, {"data": True}, latch=True)
    probe.active("/hand/guarantees", set(), after=mark)
    _level, text, _ = probe.diagnostics("/hand/tester", lambda lv, *_: lv == 2, after=mark)
    assert "SerializationError" in text or "error" in text.lower()
    assert node.end()[0] == 0


def test_latched_evidence_may_be_of_any_age(world, master, probe, model_files):
    """Without a limit it counts, which is said; with one from the second message on."""
    start = probe.mark()
    for space in ("again", "old"):
        probe.subscribe(f"/{space}/guarantees")
        probe.publish(f"/{space}/flag", BOOL, {"data": True}, latch=True)
    arguments = [f"compiled:={model_files['tester']}", "__ns:=/again", "_frequency:=20"]
    first = world.node(master, "tester", *arguments)
    probe.active("/again/guarantees", {"G_F"}, after=start)
    first.send(signal.SIGKILL)
    first.wait()
    mark = probe.mark()
    second = world.node(master, "tester", *arguments)  # takes a dead registration over
    probe.active("/again/guarantees", {"G_F"}, after=mark)
    level, text, _ = probe.diagnostics(
        "/again/tester", lambda lv, t, v: v.get("F") == "latched", after=mark
    )
    assert (level, "F latched: age unknown" in text) == (1, True)
    mark = probe.mark()
    probe.do("every", topic="/again/flag", kind=BOOL, fields={"data": True}, hz=20)
    probe.diagnostics("/again/tester", lambda lv, t, v: v.get("F") == "ok", after=mark)
    probe.do("stop", topic="/again/flag")

    third = world.node(master, "tester", f"compiled:={model_files['tester_half']}", "__ns:=/old")
    _, text, _ = probe.diagnostics("/old/tester", lambda lv, t, v: v.get("F") == "stale")
    assert "/old/flag: latched, its age is not known" in text
    for event in probe.outputs("/old/guarantees", start):
        assert not any(one["active"] for one in event["data"]["guarantees"])
    mark = probe.mark()
    probe.publish("/old/flag", BOOL, {"data": True})
    probe.active("/old/guarantees", {"G_F"}, after=mark)
    assert [node.end()[0] for node in (second, third)] == [0, 0]


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
    """The period is kept while two subscribers take nothing.

    The outputs have 60 kB each, so that the buffers of the system (some MB) are full at once.
    """
    start = probe.mark()
    model = f"compiled:={model_files['wide']}"
    world.node(master, "tester", model, "__ns:=/hung", "_frequency:=100")
    md5, kind = "c306fb7ec8f6dbe6af438338cb2d6720", "eddi_messages/ConSertOutput"
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
