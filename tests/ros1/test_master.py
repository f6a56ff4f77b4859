"""What the ROS master does to a node: it dies, returns, hangs, has a clock, knows our name."""

import signal
import time

import pytest

from eddi_scaffold.kinds.consert import MESSAGES
from eddi_scaffold.kinds.consert.compile import FORMAT
from tests.ros1.world import Master, free_port, make_messages, until

pytestmark = pytest.mark.ros
BOOL = "std_msgs/Bool"
OUT = "eddi_messages/ConSertOutput"


def test_a_roscore_that_dies_and_returns(world, model_files):
    """Rows 4 and 5: connections go on; the node registers again, or ends so that it is respawned.

    Guards our use of rospy's topic manager for the installed version of ros_comm.
    """
    master = world.master()
    probe = world.probe(master)
    for topic, kind in (("/guarantees", OUT), ("/diagnostics", "diagnostic_msgs/DiagnosticArray")):
        probe.subscribe(topic, kind)
    model = f"compiled:={model_files['tester']}"
    node = world.node(master, "tester", model, "_watchdog_period:=0.5")
    leaving = world.node(
        master, "tester", model, "_watchdog_period:=0.5", "_on_master_loss:=exit", "__name:=leaving"
    )
    probe.publish("/flag", BOOL, {"data": True}, latch=True)
    probe.active("/guarantees", {"G_F"}, after=0)
    for name in ("/tester", "/leaving"):  # connected and watched
        probe.diagnostics(name, lambda lv, t, v: v["master"] == "ok", after=0)

    master.process.destroy()
    mark = probe.mark()
    probe.active("/guarantees", {"G_F"}, after=mark)  # existing connections go on
    level, text, _ = probe.diagnostics(
        "/tester", lambda lv, t, v: v["master"] == "lost", after=mark
    )
    assert level >= 1
    assert "ROS master lost" in text
    lost = "does not answer, going on without it"
    until(lambda: lost in node.text, what="the line about the master")

    again = Master(world, master.port).start()
    returned = time.monotonic()
    until(lambda: again.call("lookupNode", "/tester"), what="registered again")
    assert time.monotonic() - returned < 2 * 0.5 + 0.5
    assert leaving.wait() == 3
    probe.diagnostics("/tester", lambda lv, t, v: v["master"] == "re-registered")
    new = world.probe(again)
    new.subscribe("/guarantees", OUT)
    new.active("/guarantees", {"G_F"}, after=0)  # state was kept, a new subscriber is served
    mark = new.mark()
    new.publish("/how", "std_msgs/String", {"data": "true"}, latch=True)  # a new publisher, too
    new.active("/guarantees", {"G_E", "G_F"}, after=mark)
    services = dict(again.call("getSystemState")[2])
    assert "/tester/set_logger_level" in services
    status, seconds = node.end()
    assert status == 0
    assert seconds < 2.0
    assert node.text.count(lost) == 1


def test_no_roscore_at_start_and_one_that_hangs(world, model_files):
    """Row 6: waits with one line, ends on SIGTERM; a master that hangs delays no end."""
    absent = Master(world)
    model = f"compiled:={model_files['tester']}"
    waiting = world.node(absent, "tester", model)
    ended = world.node(absent, "tester", model, "__name:=other")
    for node in (waiting, ended):
        until(lambda node=node: "does not answer" in node.text, what="the line that it waits")
    assert ended.end(signal.SIGTERM)[1] < 2.0
    absent.start()
    until(lambda: absent.call("lookupNode", "/tester"), what="start after the wait")
    assert waiting.text.count("does not answer") == 1
    until(lambda: "monitor of Tester" in waiting.text)

    probe = world.probe(absent)
    probe.subscribe("/guarantees", OUT)
    probe.publish("/flag", BOOL, {"data": True}, latch=True)
    probe.active("/guarantees", {"G_F"}, after=0)
    absent.process.send(signal.SIGSTOP)
    for value in (False, True, False):  # each one writes a log line, too
        mark = probe.mark()
        sent = probe.publish("/flag", BOOL, {"data": value})
        expected = {"G_F"} if value else set()
        seen = probe.active("/guarantees", expected, after=mark)
        assert seen["t"] - sent["t"] < 0.1 + 0.4
    status, seconds = waiting.end()
    assert status == 0
    assert seconds < 2.5


def test_publishers_of_another_type(world, master, probe, model_files, tmp_path):
    """Row 7: another type and another MD5 are errors that name topic, expected and found type."""
    probe.publish("/typed/flag", "std_msgs/Float64", {"data": 1.0}, latch=True)
    other = make_messages(
        tmp_path / "other",
        {**MESSAGES, "ConSertOutput": MESSAGES["ConSertOutput"] + "bool surplus\n"},
    )
    older = world.probe(master, other)
    older.do("publish", topic="/typed/consertb/guarantees", kind=OUT, fields={}, latch=True)
    mark = probe.mark()
    world.node(
        master,
        "tester",
        f"compiled:={model_files['tester']}",
        "__ns:=/typed",
        "_watchdog_period:=0.3",
    )
    node = world.node(master, "conserta", "__ns:=/typed")
    level, text, _ = probe.diagnostics(
        "/typed/tester", lambda lv, t, v: " is needed" in t, after=mark
    )
    assert level == 2
    assert "/typed/flag: std_msgs/Float64 comes, std_msgs/Bool is needed" in text
    until(lambda: "the publisher of /typed/consertb/guarantees refuses this node" in node.text)
    assert "md5sum" in node.text
    probe.diagnostics("/typed/conserta", lambda lv, t, v: v["RtE_A_D0"] == "waiting", after=mark)
    assert node.end()[1] < 2.0


def test_a_type_that_the_master_keeps_is_no_reason_once_a_right_message_came(
    world, master, probe, model_files
):
    """The master keeps the type of a publisher that is gone, and of one beside the right one."""
    topic, right, wrong = "/kept/flag", world.probe(master), world.probe(master)
    node = world.node(
        master,
        "tester",
        f"compiled:={model_files['tester_half']}",
        "__ns:=/kept",
        "_watchdog_period:=0.3",
    )
    right.do("every", topic=topic, kind=BOOL, fields={"data": True}, hz=20)
    probe.diagnostics("/kept/tester", lambda lv, t, v: v["F"] == "ok")
    wrong.publish(topic, "std_msgs/Float64", {"data": 1.0}, latch=True)
    until(lambda: "wrong message type on /kept/flag" in node.text)
    for gone in (False, True):
        if gone:
            wrong.destroy()  # the master lists it all the same
        probe.diagnostics("/kept/tester", lambda lv, t, v: v["F"] == "ok" and " is needed" not in t)
    right.popen.kill()
    reason = "publisher gone "  # although the master lists it
    probe.diagnostics("/kept/tester", lambda lv, t, v: reason in v.get("F.reason", ""))
    assert node.end()[0] == 0


def test_one_name_for_two_nodes(world, master, probe, model_files):
    """Row 12: the second refuses to start; who loses its name all the same says so."""
    model = f"compiled:={model_files['tester']}"
    first = world.node(master, "tester", model, "__ns:=/twice")
    uri = until(lambda: master.call("lookupNode", "/twice/tester"))
    until(lambda: "monitor of" in first.text)
    second = world.node(master, "tester", model, "__ns:=/twice")
    assert second.wait() == 1
    assert f"a node with the name /twice/tester is running at {uri}" in second.text
    assert master.call("lookupNode", "/twice/tester") == uri
    assert first.popen.poll() is None

    # What an older tool does: it registers the name, and the master ends the node that had it.
    intruder = f"http://localhost:{free_port()}/"
    import xmlrpc.client

    xmlrpc.client.ServerProxy(master.uri).registerPublisher(
        "/twice/tester", "/twice/else", BOOL, intruder
    )
    assert first.wait() == 1
    assert "another one has its name" in first.text


def test_models_that_cannot_be_used(world, master, model_files, tmp_path):
    """Row 19: the node ends before it registers, with path and reason on stderr."""
    good = model_files["tester"].read_text()
    for name, text in {
        "damaged": good[: good.rindex("        return [")],
        "changed": good.replace("== 2", "== 1", 1),
        "newer": good.replace(f"consert: {FORMAT}}}", "consert: 99}"),
    }.items():
        (tmp_path / f"{name}.py").write_text(text)
    nodes = {
        name: world.node(master, "tester", f"compiled:={tmp_path}/{name}.py", f"__name:={name}")
        for name in ("damaged", "changed", "newer", "absent")
    }
    model = f"compiled:={model_files['tester']}"
    nodes["rate"] = world.node(
        master, "tester", model, "_frequency:=0", "_queue_size:=none", "__name:=rate"
    )
    for name, node in nodes.items():
        assert node.wait() == 1, node.text
        assert master.call("lookupNode", f"/{name}") is None
        assert "Traceback" not in node.text
    for name in ("damaged", "changed", "newer"):
        assert f"{tmp_path}/{name}.py: " in nodes[name].text
        assert "eddi-scaffold upgrade" in nodes[name].text
    assert "the package is not whole: No module named 'compiled'" in nodes["absent"].text
    assert "copier recopy --trust" in nodes["absent"].text
    assert "~frequency: 0.000001 to 1000000 Hz expected, got 0" in nodes["rate"].text
    assert "~queue_size" in nodes["rate"].text
