"""``watch`` on a real graph: monitors are found, followed, lost and found again."""

import os
import signal
import subprocess
import sys
import time

import pytest

from eddi_scaffold.kinds.consert import MESSAGES
from eddi_scaffold.watch.fleet import FleetState
from eddi_scaffold.watch.ros1 import Ros1Graph
from tests.cli.command import ROOT
from tests.ros1.world import make_messages

pytestmark = pytest.mark.ros
BOOL, OUTPUT, STATUS = "std_msgs/Bool", "eddi_messages/ConSertOutput", "eddi_messages/ConSertStatus"


class Watch:
    """The view in this process."""

    def __init__(self, master):
        self.source = Ros1Graph(master.uri)
        self.state = FleetState()
        self.changes = []
        self.shown = self.state.snapshot(0.0)

    def until(self, condition, timeout=15.0):
        """Look on until a condition of the robots by their names holds."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            now, messages = self.source.receive(0.1)
            self.changes += self.state.look(now)
            for message in messages:
                self.changes += self.state.take(message)
            self.shown = self.state.snapshot(now)
            if condition({one.name: one.monitors for one in self.shown.robots}):
                return now
        raise AssertionError(f"never; {self.shown}, {self.source.notes()}")

    def close(self):
        self.source.close()


def states(monitors, node):
    return {
        v.id: v.state for one in monitors if one.node.endswith(f"/{node}") for v in one.verdicts
    }


@pytest.fixture
def watch(master):
    found = Watch(master)
    yield found
    found.close()


ALL = {"System_A_G0": "active", "System_A_G1": "active"}
NONE, UNKNOWN = dict.fromkeys(ALL, "not active"), dict.fromkeys(ALL, "unknown")


def test_two_robots_live_die_and_come_back(world, master, watch):
    own = "/rte/e0a:=/robot1/rte/e0a"
    one = world.node(master, "conserta", own, "__ns:=/robot1")
    world.node(master, "conserta", "__ns:=/robot2")
    source = world.probe(master)
    demand = {"guarantees": [{"id": "System_A_G0_c2", "active": True}]}
    source.do("every", topic="/robot1/consertb/guarantees", kind=OUTPUT, fields=demand, hz=10)
    source.do("every", topic="/robot1/rte/e0a", kind=BOOL, fields={"data": True}, hz=10)

    watch.until(lambda robots: states(robots.get("/robot1", ()), "conserta") == ALL)
    watch.until(lambda robots: states(robots.get("/robot2", ()), "conserta") == NONE)
    reported = lambda robots: robots["/robot1"][0].report is not None  # noqa: E731
    watch.until(reported)
    (monitor,) = (r.monitors[0] for r in watch.shown.robots if r.name == "/robot1")
    assert monitor.name == "ConSertA"
    ages = {one.id: (one.state, one.age) for one in monitor.report.inputs}
    assert ages["RtE_A_D0"][0] == "ok"
    assert 0.0 <= ages["RtE_A_D0"][1] < 1.0
    assert monitor.report.steps > 0

    killed = time.monotonic()
    one.send(signal.SIGKILL)
    at = watch.until(lambda robots: states(robots["/robot1"], "conserta") == UNKNOWN)
    assert 2.5 < at - killed < 4.5
    world.node(master, "conserta", own, "__ns:=/robot1")
    watch.until(lambda robots: states(robots["/robot1"], "conserta") == ALL, 20.0)
    wanted = [c.state for c in watch.changes if (c.robot, c.id) == ("/robot1", "System_A_G1")]
    # a node that starts may be heard before it knows anything
    assert wanted[-1] == "active"
    assert "unknown" in wanted[-3:-1]


def test_another_definition_is_not_believed_and_a_master_comes_back(world, tmp_path):
    master = world.master()
    watch = Watch(master)
    changed = MESSAGES["GuaranteeStatus"].replace("string id", "string name")
    other = make_messages(tmp_path / "other", {**MESSAGES, "GuaranteeStatus": changed})
    liar = world.probe(master, other)
    fields = {"model_id": "Liar", "guarantees": [{"name": "G", "verdict": 2, "missing": []}]}
    liar.publish("/liar/guarantees/status", STATUS, fields, latch=True)
    world.node(master, "conserta", "__ns:=/honest")
    watch.until(lambda robots: states(robots.get("/honest", ()), "conserta") == NONE)
    watch.until(lambda _: any("another definition" in one for one in watch.source.notes()))
    assert [one.name for one in watch.shown.robots] == ["/honest"]
    master.process.end()
    watch.until(lambda _: any("does not answer" in one for one in watch.source.notes()))
    last = watch.shown.robots[0].monitors[0].last  # the node is followed all the same
    watch.until(lambda robots: robots["/honest"][0].last > last + 0.5)
    master.start()
    world.node(master, "conserta", "__ns:=/new")
    watch.until(lambda robots: states(robots.get("/new", ()), "conserta") == NONE, 20.0)
    watch.close()
    assert "watch" not in str(master.call("getSystemState"))


def test_the_command_prints_and_ends(world, master):
    world.node(master, "conserta", "__ns:=/robot7")
    env = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"}
    words = ["watch", "--text", "--master", master.uri, "--robot", "seven=/robot7"]
    command = [sys.executable, "-m", "eddi_scaffold", *words]
    with subprocess.Popen(command, env=env, stdout=subprocess.PIPE, text=True) as running:
        line = running.stdout.readline()
        assert "  seven  ConSertA  System_A_G0  not active   RtE_A_" in line
        running.send_signal(signal.SIGINT)
        assert running.wait(10) == 130
