"""Nodes whose states others decide, on a transport of their own that delivers at once.

Steps are in a thread of their own, as on a robot, 200 per second; nothing here waits for longer
than that takes.
"""

from __future__ import annotations

import contextlib
import threading
import time
from types import SimpleNamespace

import pytest
from eddi_runtime.node import life_cycle
from eddi_runtime.node.life_cycle import LifeCycle
from eddi_runtime.node.node import Node

from runtime_lib.tests.node.message_package import STD_MSGS, converter
from runtime_lib.tests.node.robot import full, generated

EVIDENCE, GUARANTEES = "/rte/e0b", "/consertb/guarantees"
ACTIVE = {"System_A_G0_c2"}


class Graph:
    """The process of a node: its topics, of each the last message.

    Attributes:
        enabled: what is published is sent.
        said: topic -> messages, of which a late listener gets the last one.
    """

    def __init__(self):
        self.enabled = False
        self.said, self.advertised, self.listeners = {}, set(), {}

    @contextlib.contextmanager
    def until(self, ending):
        self.ending = ending
        yield

    def start(self):
        pass

    def stop_listening(self):
        self.listeners.clear()

    def stop_publishing(self):
        self.advertised.clear()

    def publisher(self, topic):
        self.advertised.add(topic)
        return lambda message: self.enabled and self.said.setdefault(topic, []).append(message)

    def publish(self, topic, value):
        if topic in self.listeners:
            self.listeners[topic](STD_MSGS.Bool(data=value))

    def active(self):
        """Return what a listener believes that has just come."""
        return {one.id for one in self.said[GUARANTEES][-1].guarantees if one.active}


class OnGraph(Node):
    FREQUENCY = 200.0

    def __init__(self, monitor, eddi_input, graph):
        super().__init__(monitor, eddi_input, converter(self.MESSAGES), None)
        self.graph_of_test = graph

    def advertise(self, channel):
        return self.graph_of_test.publisher(full(channel.topic))

    def subscribe(self, source):
        receive = self._receipts.receive
        self.graph_of_test.listeners[full(source.topic)] = lambda message: receive(
            source.id, message, 0.0
        )

    def run(self, begun):
        self.run_on("/consertb", lambda: self.graph_of_test.publisher("/diagnostics"), begun)


class Robot:
    def __init__(self, monkeypatch):
        found = generated("consertb", OnGraph, monkeypatch)
        self.cls = type("RosNode", (found["RosNode"],), {"FREQUENCY": 200.0})
        self.graph, self.inputs = Graph(), []
        self.input_class = found["EDDIInput"]
        self.monitor_class = found["EDDIMonitor"]
        self.life = LifeCycle(self.graph, self.make)
        self.status = None
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def make(self):
        self.inputs.append(self.input_class())
        return self.cls(self.monitor_class(), self.inputs[-1], self.graph)

    def run(self):
        self.status = self.life.run(lambda: None)

    def activate(self):
        self.life.prepare()
        self.graph.enabled = True
        self.life.activate()

    def deactivate(self):
        self.life.deactivate()
        self.graph.enabled = False

    def until(self, condition):
        end = time.monotonic() + 5.0
        while not condition():
            assert time.monotonic() < end
            time.sleep(0.002)

    def sense(self):
        """Have the sensor publish that it is healthy, until the guarantee is active."""

        def active():
            self.graph.publish(EVIDENCE, True)
            return self.graph.said.get(GUARANTEES) and self.graph.active() == ACTIVE

        self.until(active)

    def end(self):
        self.life.ending.begin()
        self.thread.join(5.0)
        return self.status


@pytest.fixture
def robot(monkeypatch):
    made = Robot(monkeypatch)
    yield made
    assert made.end() == 0


def test_inactive_it_is_there_and_says_nothing(robot):
    assert robot.graph.advertised == set()
    robot.life.configure()
    assert GUARANTEES in robot.graph.advertised
    robot.graph.enabled = True  # it would be heard
    time.sleep(0.05)
    assert robot.graph.said == {}
    assert robot.graph.listeners == {}
    robot.life.clean_up()
    assert robot.graph.advertised == set()


def test_its_last_word_is_that_nothing_is_known(robot):
    robot.life.configure()
    robot.activate()
    robot.sense()
    robot.deactivate()
    assert robot.graph.active() == set()
    said = len(robot.graph.said[GUARANTEES])
    robot.graph.enabled = True
    time.sleep(0.05)
    assert len(robot.graph.said[GUARANTEES]) == said
    assert robot.graph.listeners == {}


def test_a_step_that_hangs_leaves_no_guarantee_behind(robot, monkeypatch):
    """Also of it nothing counts later, and there is no second monitor beside it."""
    monkeypatch.setattr(life_cycle, "_STEP_S", 0.1)
    lines = []
    monkeypatch.setattr(life_cycle, "LOG", SimpleNamespace(error=lambda *a: lines.append(a)))
    robot.life.configure()
    robot.activate()
    robot.sense()
    hangs, on = threading.Event(), threading.Event()

    def processing(values, proceed=robot.inputs[-1].processing):
        proceed(values)
        hangs.set()
        on.wait(10.0)

    robot.inputs[-1].processing = processing
    assert hangs.wait(5.0)
    assert robot.graph.active() == ACTIVE
    robot.life.deactivate()
    said = len(robot.graph.said[GUARANTEES])
    assert robot.graph.active() == set()
    assert "left behind" in lines[0][0]
    with pytest.raises(RuntimeError, match="the last step has not ended yet"):
        robot.activate()
    on.set()
    robot.until(robot.life._idle.is_set)
    later = robot.graph.said[GUARANTEES][said:]
    assert not any(one.active for message in later for one in message.guarantees)
    robot.activate()
    robot.sense()


def test_a_process_that_ends_while_it_is_active(monkeypatch):
    robot = Robot(monkeypatch)
    robot.life.configure()
    robot.activate()
    robot.sense()
    assert robot.end() == 0
    assert robot.graph.active() == set()


def test_what_cannot_work_is_not_configured_and_leaves_nothing(robot, monkeypatch):
    def refuse(self):
        raise ValueError("no camera")

    with monkeypatch.context() as patch:
        patch.setattr(robot.input_class, "__init__", refuse)
        with pytest.raises(ValueError, match="no camera"):
            robot.life.configure()
    with monkeypatch.context() as patch:
        patch.setattr(robot.cls, "init_publisher", refuse)
        with pytest.raises(ValueError, match="no camera"):
            robot.life.configure()
    assert robot.graph.advertised == set()
    robot.life.configure()
    robot.activate()
    robot.sense()


def test_deactivated_at_once(robot):
    robot.life.configure()
    for _ in range(20):
        robot.activate()
        robot.deactivate()
        assert robot.graph.active() == set()
