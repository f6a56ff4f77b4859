"""Why a guarantee is lost, from the last monitor to the sensor: one sentence, wherever it stands.

A real launch of the example; its log, ``/diagnostics``, ``explain`` and ``watch`` are compared.
"""

import os
import re
import shutil
import sys
from itertools import pairwise

import pytest

from eddi_scaffold.watch.robot_graph import robot_graph
from tests.cli.command import ROOT, run
from tests.ros1.test_watch import Watch
from tests.ros1.world import HERE, RUNTIME, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

PACKAGES = HERE.parents[1] / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
NAMES = ("conserta", "consertb")
LAUNCH = """
  <include file="$(find {name})/launch/eddi_monitor.launch">
    <arg name="startup_grace" value="2.0"/>
  </include>
  <param name="{name}/watchdog_period" value="0.5"/>"""
BODY = ("RtE_E0.data", "RtE_E0.data or RtE_E0.worn")  # the message has no such field
INFO, WARN, ERROR = 2, 4, 8  # of rosgraph_msgs/Log
BOOL = "std_msgs/Bool"
CLAIM = "System_A_G1"
FAR = "RtE_A_D0 <- System_A_G0_c2 <- RtE_A_E0 <- /rte/e0b"
RAISED = "process_RtE_A_E0 raised AttributeError in EDDIInput.py line 36"


def timeless(text):
    return re.sub(r"\d+\.\d s", "T s", text)


def send(probe, topic, *, value=True):
    probe.do("every", topic=topic, kind=BOOL, fields={"data": value}, hz=10)


class Robot:
    """``roslaunch`` of two monitors, and who listens to them."""

    def __init__(self, world, folder):
        self.world, self.master, self.folder = world, world.master(), folder
        self.mark = 0
        self.ear = world.probe(self.master)
        self.ear.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        self.ear.subscribe("/rosout", "rosgraph_msgs/Log")
        self.ear.subscribe("/conserta/guarantees/why", "eddi_messages/Why")
        words = ("-m", "eddi_scaffold", "watch", "--text", "--master", self.master.uri)
        env = {**os.environ, "PYTHONPATH": f"{ROOT}:{RUNTIME}", "PYTHONUNBUFFERED": "1"}
        self.watch = world.process([sys.executable, *words], env)

    def __enter__(self):
        packages = shutil.copytree(PACKAGES, self.folder / "eddi_monitor")
        body = packages / "conserta" / "src" / "conserta" / "EDDIInput.py"
        body.write_text(body.read_text().replace(*BODY))
        launch = self.folder / "robot.launch"
        parts = "".join(LAUNCH.format(name=name) for name in NAMES)
        launch.write_text(f"<launch>{parts}\n</launch>\n")
        paths = [self.world.messages, RUNTIME, *(packages / name / "src" for name in NAMES)]
        env = {**self.world.env(self.master), "ROS_PACKAGE_PATH": str(packages)}
        env["PYTHONPATH"] = os.pathsep.join(map(str, paths))
        self.launch = self.world.process(["/usr/bin/roslaunch", str(launch)], env)
        return self

    def __exit__(self, *_):
        self.launch.end(timeout=30.0)  # it ends its nodes

    def sensor(self, topic):
        probe = self.world.probe(self.master)
        send(probe, topic)
        return probe

    def logs(self, level, wanted):
        """Wait for a line of the log that is like this but for its times."""
        fits = lambda of: re.fullmatch(wanted, timeless(of["msg"]))  # noqa: E731
        lines = lambda: [  # noqa: E731
            event["data"]
            for event in self.ear.outputs("/rosout", self.mark)
            if event["data"]["name"] == "/conserta"
        ]
        try:
            line = until(lambda: [*filter(fits, lines())], 20.0)[0]
        except AssertionError:
            raise AssertionError(f"{wanted}: {[of['msg'] for of in lines()]}") from None
        assert line["level"] == level

    def asked(self, status):
        done = run("explain", CLAIM, "--master", self.master.uri, cwd=self.folder)
        assert (done.status, done.err) == (status, "")
        return timeless(done.out).splitlines()

    def says(self, chain, level=WARN):
        """Wait until everybody has the sentence, and return the claim of the message."""
        sentence = f"{CLAIM} <- {chain}"
        self.logs(level, f"(lost|still) {re.escape(sentence)}")
        fits = lambda _, __, of: timeless(of[f"guarantee.{CLAIM}"]) == f"inactive: {sentence}"  # noqa: E731
        self.ear.diagnostics("/conserta", fits)
        first, second = self.asked(1)
        assert first == f"ConSertA: {sentence}"
        assert re.fullmatch(rf"  since \d\d:\d\d:\d\d\.\d{{3}}  {re.escape(chain)}", second)
        self.watches(f"unknown   {sentence}")
        return self.ear.outputs("/conserta/guarantees/why")[-1]["data"]["claims"][1]

    def watches(self, state):
        line = f"  /  ConSertA  {CLAIM}  {state}\n"
        until(lambda: timeless(self.watch.text).rpartition(line)[1], what=self.watch.text)

    def recovers(self, chain):
        """Wait until everybody says that the claim holds again."""
        self.logs(INFO, re.escape(f"again {CLAIM} after T s ({chain})"))
        active = lambda _, __, of: of[f"guarantee.{CLAIM}"] == "active"  # noqa: E731
        self.ear.diagnostics("/conserta", active)
        assert self.asked(0) == [f"ConSertA: {CLAIM} holds"]
        self.watches("active")
        self.mark = self.ear.mark()


def is_joined(robot):
    """Return whether the graph of a robot leads down from the guarantee to the topic."""
    graph = robot_graph(robot)
    heads = {node.id: " ".join(node.lines[:2]) for node in graph.nodes}
    joined = [(heads[edge.target], heads[edge.source]) for edge in graph.edges]
    way = ["System_A_G1 unknown", "ConSertA ConSert", "RtE_A_D0 unknown", "System_A_G0_c2 unknown"]
    return {*pairwise([*way, "ConSertB ConSert", "RtE_A_E0 stale", "/rte/e0b gone"])} <= {*joined}


def test_everybody_says_the_same_of_what_is_dead_late_wrong_or_raises(world, tmp_path):
    with Robot(world, tmp_path) as robot:
        robot.logs(WARN, f"missing {CLAIM} <- {FAR}: no message yet, T s .*")
        near, dead = robot.sensor("/rte/e0a"), robot.sensor("/rte/e0b")
        robot.ear.diagnostics("/conserta", lambda _, __, of: of[f"guarantee.{CLAIM}"] == "active")

        watch = Watch(robot.master)
        dead.popen.kill()
        claim = robot.says(f"{FAR}: publisher gone T s")
        (cause,) = claim["causes"]
        assert (claim["id"], claim["verdict"]) == (CLAIM, 1)
        assert cause["monitors"] == ["ConSertA", "ConSertB"]
        assert (cause["topic"], cause["state"], cause["limit"]) == ("/rte/e0b", 0, 2.0)
        watch.until(lambda _: is_joined(watch.shown.robots[0]))
        watch.close()
        late = robot.sensor("/rte/e0b")
        robot.recovers(f"{FAR}: publisher gone T s")

        late.do("stop", topic="/rte/e0b")
        silent = f"{FAR}: nothing for T s, limit 2 s (its publisher is there)"
        robot.says(silent)
        send(late, "/rte/e0b")
        robot.recovers(silent)

        late.destroy()
        liar = world.probe(robot.master)
        liar.publish("/rte/e0b", "std_msgs/String", {"data": "1"}, latch=True)
        robot.says(f"{FAR}: std_msgs/String comes, std_msgs/Bool is needed")
        liar.destroy()
        robot.sensor("/rte/e0b")
        robot.ear.diagnostics("/conserta", lambda _, __, of: of[f"guarantee.{CLAIM}"] == "active")

        robot.mark = robot.ear.mark()
        near.do("stop", topic="/rte/e0a")
        send(near, "/rte/e0a", value=False)
        robot.says(f"RtE_A_E0 <- /rte/e0a: {RAISED}", ERROR)
        near.do("stop", topic="/rte/e0a")
        send(near, "/rte/e0a")
        robot.recovers(f"RtE_A_E0 <- /rte/e0a: {RAISED}")
