"""Why a guarantee is lost, from the last monitor to the sensor, on real nodes of the example."""

import os
import re
from itertools import pairwise

import pytest

from eddi_scaffold.watch.robot_graph import robot_graph
from tests.ros1.test_watch import Watch
from tests.ros1.world import HERE, RUNTIME, until

pytestmark = pytest.mark.ros

PACKAGES = HERE.parents[1] / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
BOOL = "std_msgs/Bool"
CHAIN = "System_A_G1 <- RtE_A_D0 <- System_A_G0_c2 <- RtE_A_E0 <- /rte/e0b"


class Robot:
    """The two nodes, and who listens to them."""

    def __init__(self, world):
        self.world, self.master = world, world.master()
        self.ear = world.probe(self.master)
        self.ear.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        self.ear.subscribe("/conserta/guarantees/why", "eddi_messages/Why")
        self.log = [self.start(name) for name in ("consertb", "conserta")][-1]

    def start(self, name):
        paths = [self.world.messages, RUNTIME, PACKAGES / name / "src"]
        env = {"PYTHONPATH": os.pathsep.join(map(str, paths))}
        script = PACKAGES / name / "scripts" / "RosNode.py"
        more = ("_startup_grace:=2.0", "_watchdog_period:=0.5")
        return self.world.node(self.master, name, *more, script=script, env=env)

    def sensor(self, *topics):
        probe = self.world.probe(self.master)
        for topic in topics:
            probe.do("every", topic=topic, kind=BOOL, fields={"data": True}, hz=10)
        return probe

    def logs(self, line):
        try:
            until(lambda: re.search(line, self.log.text), 20.0, line)
        except AssertionError as late:
            raise AssertionError(f"{late}: {self.log.text}") from None

    def says(self, sentence):
        """Wait until diagnostics and the message have a sentence; return the message's claim."""
        claim = "guarantee.System_A_G1"
        self.ear.diagnostics(
            "/conserta", lambda _, __, values: re.fullmatch(sentence, values[claim]), 20.0
        )
        return self.ear.outputs("/conserta/guarantees/why")[-1]["data"]["claims"][1]


def is_joined(robot):
    """Return whether the graph of a robot leads down from the guarantee to the topic."""
    graph = robot_graph(robot)
    heads = {node.id: " ".join(node.lines[:2]) for node in graph.nodes}
    joined = [(heads[edge.target], heads[edge.source]) for edge in graph.edges]
    way = ["System_A_G1 unknown", "ConSertA ConSert", "RtE_A_D0 unknown", "System_A_G0_c2 unknown"]
    return {*pairwise([*way, "ConSertB ConSert", "RtE_A_E0 stale", "/rte/e0b gone"])} <= {*joined}


def test_the_sentence_leads_from_a_guarantee_to_the_sensor(world):
    """What is dead, late and of another type two monitors away; and what came again."""
    robot = Robot(world)
    watch = Watch(robot.master)
    robot.logs(f"missing {CHAIN}: no message yet, ")
    robot.sensor("/rte/e0a")
    dead = robot.sensor("/rte/e0b")
    robot.says("active")

    dead.popen.kill()
    robot.logs(rf"(?m)\[WARN\].* (lost|still) {CHAIN}: publisher gone \d\.\d s$")
    claim = robot.says(rf"inactive: {CHAIN}: publisher gone \d+\.\d s")
    (cause,) = claim["causes"]
    assert (claim["id"], claim["verdict"]) == ("System_A_G1", 1)
    assert cause["monitors"] == ["ConSertA", "ConSertB"]
    assert (cause["topic"], cause["state"], cause["limit"]) == ("/rte/e0b", 0, 2.0)
    watch.until(lambda _: is_joined(watch.shown.robots[0]))
    watch.close()

    late = robot.sensor("/rte/e0b")
    robot.says("active")
    robot.logs(r"\[INFO\].* again System_A_G1 after \d+\.\d s \(RtE_A_D0 <- ")

    late.do("stop", topic="/rte/e0b")
    robot.says(rf"inactive: {CHAIN}: nothing for \d\.\d s, limit 2 s \(its publisher is there\)")
    late.destroy()
    world.probe(robot.master).publish("/rte/e0b", "std_msgs/String", {"data": "1"}, latch=True)
    robot.says(rf"inactive: {CHAIN}: std_msgs/String comes, std_msgs/Bool is needed")
    assert "Traceback" not in robot.log.text
