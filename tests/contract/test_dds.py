"""What is special of DDS: bytes on the wire, names on the graph, and words of the command line."""

from __future__ import annotations

import re
import signal
import subprocess
import sys

import pytest

pytest.importorskip("cyclonedds", reason="no DDS here")

from cyclonedds.qos import Policy
from cyclonedds.util import duration
from eddi_runtime.node.start import StartError
from eddi_runtime.transports.dds.graph import reading, told, writing
from eddi_runtime.transports.dds.messages import OWN, Unreadable, converter, message_classes
from eddi_runtime.transports.dds.node import MonitorNode, arguments, domain_id

from tests.contract.stages import CONFIG, DdsStage, environment, free_domain

PARTS = {
    "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
    "my_msgs/Part": "std_msgs/Header header, bool[] flags, uint8 small, float64[2] pair",
    "my_msgs/All": "bool b, byte o, char c, int8 i8, uint8 u8, int16 i16, uint16 u16, int32 i32,"
    " uint32 u32, int64 i64, uint64 u64, float32 f32, float64 f64, string text, uint8[] raw,"
    " uint8[3] three, string[] texts, my_msgs/Part part, my_msgs/Part[] parts, my_msgs/Part[2] two",
    "std_msgs/Empty": "",
    "std_msgs/Bool": "bool data",
    "std_msgs/String": "string data",
    "std_msgs/Float64": "float64 data",
    "eddi_messages/Guarantee": "string id, bool active",
    "eddi_messages/ConSertOutput": "eddi_messages/Guarantee[] guarantees",
}
CLASSES = message_classes(PARTS)


def test_bytes_are_those_of_rosbags():
    typesys = pytest.importorskip("rosbags.typesys")
    numpy = pytest.importorskip("numpy")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    for name in ("my_msgs/Part", "my_msgs/All"):
        text = "\n".join(part.strip() for part in PARTS[name].split(","))
        store.register(typesys.get_types_from_msg(text, name.replace("/", "/msg/")))
    made = CLASSES.my_msgs_All
    part = {"flags": [True, False], "small": 7, "pair": [0.5, -1.5]}
    numbers = {"o": 1, "c": 2, "i8": -3, "u8": 4, "i16": -5, "u16": 6, "i32": -7, "u32": 8}
    numbers |= {"i64": -9, "u64": 10, "f32": 0.25, "f64": 0.1, "b": True, "text": "ünï"}
    ours = made(
        **numbers,
        raw=[1, 2],
        three=b"\1\2\3",
        texts=["", "a"],
        part=CLASSES.my_msgs_Part(**part),
        parts=[CLASSES.my_msgs_Part(**part)],
    )
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    other = types["my_msgs/msg/Part"]

    def theirs(flags, small, pair):
        return other(
            header=header, flags=numpy.array(flags, bool), small=small, pair=numpy.array(pair)
        )

    empty = theirs([], 0, [0.0, 0.0])
    message = types["my_msgs/msg/All"](
        **numbers,
        raw=numpy.array([1, 2], numpy.uint8),
        three=numpy.array([1, 2, 3], numpy.uint8),
        texts=["", "a"],
        part=theirs(**part),
        parts=[theirs(**part)],
        two=[empty, empty],
    )
    expected = bytes(store.serialize_cdr(message, "my_msgs/msg/All"))
    assert bytes(ours.serialize()) == expected
    again = made.deserialize(expected)
    assert (again.text, again.part.pair, again.three) == ("ünï", [0.5, -1.5], b"\1\2\3")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\0\1\0",
        b"\0\1\0\0",
        b"\0\1\0\0\2",  # no Boolean
        b"\0\1\0\0\xff",
        b"\0\1\0\0\1\0\0\0\0",  # longer than the message
        b"\0\0\0\0\1",  # written for the other byte order
        CLASSES.std_msgs_String(data="hello").serialize(),
        CLASSES.std_msgs_Float64(data=1.0).serialize(),
    ],
)
def test_bytes_that_are_no_boolean(data):
    assert isinstance(CLASSES.std_msgs_Bool.deserialize(data), Unreadable)


def test_padding_may_hold_anything():
    text = bytearray(CLASSES.my_msgs_Part(pair=[1.0, 2.0], small=3).serialize())
    padding = [k for k in range(4, len(text)) if text[k] == 0]
    same = []
    for k in padding:
        changed = CLASSES.my_msgs_Part.deserialize(bytes(text[:k] + b"\x5a" + text[k + 1 :]))
        same.append(getattr(changed, "pair", None) == [1.0, 2.0])
    assert any(same)
    assert CLASSES.std_msgs_Bool.deserialize(b"\0\1\0\0\1\x5a\x5a\x5a").data is True


def test_messages_are_filled_and_checked():
    made = converter(CLASSES).message(
        ("ConSertOutput", {"guarantees": [("Guarantee", {"id": "G", "active": True})]})
    )
    assert CLASSES.eddi_messages_ConSertOutput.deserialize(made.serialize()).guarantees[0].active
    assert CLASSES.std_msgs_Empty().serialize() == b"\0\1\0\0\0"


def test_words_of_the_command_line():
    words = ["x", "--ros-args", "-r", "__ns:=/robot1", "--remap", "in/a:=/sim/a", "-r", "/b:=~/b"]
    given = arguments([*words, "-p", "frequency:=5", "-p", "diagnostics:=false", "--"], "rover")
    assert given.full_name == "/robot1/rover"
    assert given.topic("in/a") == given.topic("/robot1/in/a") == "/sim/a"
    assert given.topic("/b") == "/robot1/rover/b"
    assert given.topic("in/c") == "/robot1/in/c"
    assert given.parameters == {"frequency": 5, "diagnostics": False}
    assert arguments(["--ros-args", "-r", "__node:=x"], "rover").full_name == "/x"
    assert arguments([], "rover").topic("a") == "/a"


@pytest.mark.parametrize(
    "words",
    [
        ["-p"],
        ["-p", "x"],
        ["-x", "a:=b"],
        ["-r", "a:=b-c"],
        ["-r", "__node:=a b"],
        ["-r", "__ns:=1"],
    ],
)
def test_words_that_are_not_understood(words):
    with pytest.raises(StartError):
        arguments(["--ros-args", *words], "rover")


@pytest.mark.parametrize("words", [["--help"], ["-p", "frequency:=5.0"], ["-p", "--ros-args"]])
def test_an_option_before_ros_args_starts_nothing(words):
    with pytest.raises(StartError, match=f"{words[0]}: --ros-args -r NAME:=NAME"):
        arguments(words, "rover")


def test_a_parameter_that_nothing_reads_is_said(monkeypatch, capsys):
    class Rover(MonitorNode):
        NAME, FREQUENCY, STARTUP_GRACE = "rover", 10.0, 10.0

    known = ["use_sim_time:=true", "partition:=a", "robot:=b", "ros_distro:=iron", "queue_size:=2"]
    for given, names in ((known, []), (["partitoin:=a", *known], ["partitoin"])):
        words = [word for one in [*given, "frequency:=0"] for word in ("-p", one)]
        monkeypatch.setattr("sys.argv", ["rover", "--ros-args", *words])
        assert Rover.main(list, list) == 1  # for the frequency
        lines = [f"rover: warning: no parameter is called {t}: nothing reads it" for t in names]
        *warned, refused = capsys.readouterr().err.splitlines()
        assert warned == lines
        assert refused.startswith("rover: error: parameter ~frequency: ")


def test_domains():
    assert (domain_id("0"), domain_id("232")) == (0, 232)
    for text in ("233", "-1", "", "one", "1.0"):
        with pytest.raises(StartError):
            domain_id(text)


def test_an_endpoint_tells_the_hash_of_its_type():
    made = message_classes({"std_msgs/Bool": "bool data"}, {"std_msgs/Bool": "RIHS01_0"})
    with_hash = told(made.std_msgs_Bool, writing({}, 1))
    assert Policy.Userdata(b"typehash=RIHS01_0;") in with_hash
    assert Policy.Durability.TransientLocal in with_hash
    assert told(CLASSES.std_msgs_Bool, writing({}, 1)) == writing({}, 1)
    assert re.fullmatch("RIHS01_[0-9a-f]{64}", OWN.diagnostic_msgs_DiagnosticArray.HASH)


def test_a_person_says_how_topics_are_read_and_written():
    assert Policy.Reliability.BestEffort in reading({}, 5)
    assert Policy.History.KeepLast(5) in reading({}, 5)
    given = reading({"reliability": "reliable", "durability": "transient_local", "depth": 9}, 5)
    assert Policy.Durability.TransientLocal in given
    assert Policy.History.KeepLast(9) in given
    assert Policy.Durability.TransientLocal in writing({}, 1)
    given = writing({"durability": "volatile", "deadline": 0.5, "lifespan": 2.0}, 1)
    for one in (
        Policy.Durability.Volatile,
        Policy.Deadline(duration(milliseconds=500)),
        Policy.Lifespan(duration(seconds=2)),
    ):
        assert one in given


ASKING = """
import os, sys, threading
def end_with_the_test():
    os.read(0, 1)
    os._exit(2)
threading.Thread(target=end_with_the_test, daemon=True).start()
from eddi_runtime.transports.dds.graph import Graph, reading, writing
from eddi_runtime.transports.dds.messages import OWN
for _ in range(20):
    graph = Graph(int(sys.argv[1]), "/", "rover", "humble")
    graph.reader("/a", OWN.diagnostic_msgs_DiagnosticArray, print, reading({}, 1))
    write = graph.writer("/b", OWN.diagnostic_msgs_DiagnosticArray, writing({}, 1))
    graph.start()
    ended, asked = threading.Event(), threading.Event()
    def ask():
        while not ended.is_set():
            graph.publications(), graph.listening("/a")
            asked.set()
    threads = [threading.Thread(target=ask, daemon=True) for _ in range(3)]
    for one in threads: one.start()
    asked.wait()
    graph.close()
    assert (graph.publications(), graph.listening("/a")) == ([], (False, False, None))
    write(None)
    ended.set()
    for one in threads: one.join()
"""


def test_the_end_waits_for_who_asks_about_the_graph():
    """A participant that is deleted while a thread reads from it ends the process by a signal."""
    lock, domain = free_domain()
    with lock:
        command = [sys.executable, "-c", ASKING, str(domain)]
        pipes = {"stdin": subprocess.PIPE, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, env=environment(domain), **pipes) as asking:
            said = asking.stderr.read()  # its stdin is open for as long as this test runs
    assert (asking.returncode, said) == (0, b"")


def promises_that_are_broken(stage):
    """Name the deadline, and the sign of life, that a publisher owes."""
    name = "/robot2/rover"
    for one, promise, words in (
        ("Healthy", {"deadline": 0.5}, "has missed its deadline of 0.5 s)"),
        ("Steady", {"lease": 0.5}, "gives no sign of life)"),
    ):
        topic, mark = f"/robot2/in/{one.lower()}", stage.ear.mark()
        stage.feed(stage.source, topic, "std_msgs/Bool", True, **promise)
        stage.ear.diagnostics(name, lambda _, __, found, one=one: found[one] == "ok", 10.0, mark)
        stage.source.do("stop", topic=topic)
        stage.told(f"limit 0.8 s (its publisher {words}", name, after=mark)


def in_another_partition(stage):
    """See nothing of a robot there, and all of the one here."""
    mark = stage.ear.mark()
    stage.start("/robot3", "partition:=apart")
    stage.start("/robot4")
    stage.told("in/healthy", "/robot4/rover", after=mark)
    heard = [one for one in stage.ear.events(mark) if one.get("topic") == "/diagnostics"]
    assert not any("/robot3/" in str(one) for one in heard)


@pytest.mark.slow
def test_the_graph_knows_the_name_and_the_monitor_knows_why(tmp_path):
    config = tmp_path / "config.yml"
    kept = "in/clear, qos: {durability: transient_local, reliability: reliable}"
    config.write_text(CONFIG.read_text("utf-8").replace("in/clear", kept), "utf-8")
    stage = DdsStage(tmp_path, config)
    try:
        stage.begin()
        stage.ear.subscribe("ros_discovery_info", "rmw_dds_common/ParticipantEntitiesInfo")
        node = stage.start("/robot1", "ros_distro:=humble")
        known = stage.ear.wait(lambda event: event.get("topic") == "ros_discovery_info")
        (entry,) = known["data"]["node_entities_info_seq"]
        assert (entry["node_namespace"], entry["node_name"]) == ("/robot1", "rover")
        assert len(entry["reader_gid_seq"]) == 4
        ids = [one["data"] for one in entry["writer_gid_seq"]]
        assert len(set(ids)) == len(ids) == 4  # guarantees, status, why, diagnostics
        assert all(re.fullmatch(r"[0-9a-f]{32}0{16}", one) for one in ids)

        stage.feed(stage.source, "/robot1/in/healthy", "other/Bool", 1, connected=False)
        stage.feed(stage.source, "/robot1/in/clean", "std_msgs/Float64", 5.0, connected=False)
        more = {"connected": False, "best_effort": True}
        stage.feed(stage.source, "/robot1/in/mode", "std_msgs/String", "park", **more)
        name = "/robot1/rover"
        stage.told("/robot1/in/mode: best_effort is offered, reliable is needed", name)
        stage.told("/robot1/in/healthy: another definition of the message comes", name)
        stage.told("(nobody publishes it, the nearest name is /robot1/in/clean)", name)

        mark = stage.ear.mark()
        assert node.end(signal.SIGTERM)[0] == 0
        gone = stage.ear.wait(lambda event: event.get("topic") == "ros_discovery_info", after=mark)
        assert gone["data"]["node_entities_info_seq"] == []

        more = {"latch": True}
        stage.source.publish("/robot2/in/clear", "std_msgs/Float64", {"data": 5.0}, **more)
        stage.start("/robot2")
        _, values = stage.told("/robot2/in/clear: latched", "/robot2/rover")
        assert values["Clear"] == "stale"
        other = stage.new_probe()
        stage.feed(other, "/robot2/in/healthy", "std_msgs/Bool", True)
        other.wait(lambda event: event["event"] == "connected")
        stage.told("/robot2/in/mode", "/robot2/rover", after=stage.ear.mark())
        other.popen.kill()
        # lease of the participant
        stage.told("/robot2/in/healthy: publisher gone", "/robot2/rover", timeout=30.0)
        promises_that_are_broken(stage)

        in_another_partition(stage)
        broken = stage.start("/", "frequency:=fast")
        assert broken.wait() == 1
        assert "rover: error: parameter ~frequency" in broken.text
    finally:
        stage.destroy()
