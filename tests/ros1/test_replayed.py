"""A bag of real nodes with hand-written code, replayed: the verdicts that the nodes published."""

import json
import os
import shutil
import signal
import time
from pathlib import Path

import pytest

from eddi_scaffold.recordings.bags import opened
from tests.cli.command import EXAMPLE, edit, run
from tests.ros1.world import PYTHON, demand, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

TOPICS = {f"consert{letter}": f"/consert{letter}/guarantees" for letter in "ab"}
DEMAND = "self.RtE_A_D0 = given(by_id(consertb.guarantees, 'System_A_G0_c2').active, True)"
BY_HAND = "self.RtE_A_D0 = self.count_good(consertb) == 0"
MEMBERS = "    def setup(self):\n"
METHOD = """\
    def count_good(self, message):
        return sum(one.active for one in message.guarantees)

"""
SLACK_S = 0.75  # two steps, and a machine that others use as well


def changes(said):
    """Return (t, active guarantees) of each change."""
    found = []
    for t, active in said:
        if not found or found[-1][1] != active:
            found.append((t, active))
    return found


def recorded(bag):
    """Return name of a monitor -> the changes of its verdicts, in seconds of the bag."""
    said = {name: [] for name in TOPICS}
    with opened(bag) as reader:
        for connection, t, data in reader.messages(reader.connections):
            name = connection.topic.split("/")[1]
            if name in said:
                rows = reader.deserialize(connection, data).guarantees
                active = {row.id for row in rows if row.active}
                said[name].append(((t - reader.start_time) / 1e9, active))
    return {name: changes(of) for name, of in said.items()}


def replayed(*words, cwd):
    done = run("run", *words, "--bag", "robot.bag", "--json", cwd=cwd)
    assert done.status == 0, done.err
    said = {name: [] for name in TOPICS}
    for step in map(json.loads, done.out.splitlines()):
        active = {row["id"] for row in step["outputs"] if row["active"]}
        said[step["monitor"].lower()].append((step["t"], active))
    return {name: changes(of) for name, of in said.items()}


def test_the_replay_says_what_the_nodes_said(world, tmp_path):
    pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    demand(None if Path("/usr/bin/rosbag").exists() else "there is no rosbag: python3-rosbag")
    packages = shutil.copytree(EXAMPLE / "expected", tmp_path / "ws") / "src/eddi_monitor"
    body = packages / "conserta/src/conserta/EDDIInput.py"
    edit(body, DEMAND, BY_HAND)
    edit(body, MEMBERS, METHOD + MEMBERS)
    core = world.master()
    env = world.env(core)
    own = os.pathsep.join(str(packages / name / "src") for name in TOPICS)
    env["PYTHONPATH"] = f"{own}{os.pathsep}{env['PYTHONPATH']}"
    bag = tmp_path / "robot.bag"
    command = ["rosbag", "record", "-O", bag, "/rte/e0a", "/rte/e0b", *TOPICS.values()]
    recorder = world.process([PYTHON, "/usr/bin/rosbag", *map(str, command[1:])], env)
    probe = world.probe(core)
    for topic in TOPICS.values():
        probe.subscribe(topic)
    nodes = [
        world.process([PYTHON, str(packages / name / "scripts/RosNode.py")], env) for name in TOPICS
    ]
    for topic in TOPICS.values():
        probe.active(topic, set(), 30.0, after=0)
    until(lambda: bag.with_suffix(".bag.active").exists(), 30.0, recorder.text)
    time.sleep(2.0)

    def send(letter, value):
        fields = {"data": value}
        probe.do("every", topic=f"/rte/e0{letter}", kind="std_msgs/Bool", fields=fields, hz=20)

    def silence(letter):
        probe.do("stop", topic=f"/rte/e0{letter}")

    own, one, both = TOPICS["conserta"], {"System_A_G0"}, {"System_A_G0", "System_A_G1"}
    send("a", True)
    probe.active(own, both, after=0)
    time.sleep(2.0)
    send("b", True)
    probe.active(own, one)
    time.sleep(2.0)
    silence("b")  # unknown after its age
    probe.active(own, both)
    silence("a")
    probe.active(own, set())
    send("b", False)
    time.sleep(1.0)
    send("a", True)
    probe.active(own, both)
    time.sleep(1.0)
    for process in [recorder, *nodes]:
        process.end(signal.SIGINT)
    until(bag.exists, 10.0, recorder.text)

    nodes_said = recorded(bag)
    assert len(nodes_said["conserta"]) == 6
    for words in [("-w", "ws"), (packages / "consertb", packages / "conserta")]:
        for name, said in replayed(*words, cwd=tmp_path).items():
            assert [active for _, active in said] == [active for _, active in nodes_said[name]]
            for (t, _), (node_t, _) in zip(said, nodes_said[name], strict=True):
                assert abs(t - node_t) < SLACK_S, (name, said, nodes_said[name])
    without = replayed("-w", "ws", "--no-code", cwd=tmp_path)
    assert [active for _, active in without["conserta"]][:3] == [set(), one, both]
