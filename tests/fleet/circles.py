"""Robots of a fleet as real nodes in virtual time: each message arrives at once."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime.node import health, node, topics
from eddi_runtime.node.node import Node
from eddi_runtime.node.topics import Input, Output
from eddi_runtime.peers import Fleet, Source

from eddi_scaffold.common.identifiers import full_topic
from eddi_scaffold.kinds.consert import BETWEEN_ROBOTS, MESSAGES
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings.node import GivenInput
from eddi_scaffold.recordings.playing import compiled
from runtime_lib.tests.node.message_package import converter, package

MESSAGE_CLASSES = package("eddi_messages", {**MESSAGES, **BETWEEN_ROBOTS})
PERIOD = 0.125


class Robots:
    """All nodes, and a clock for them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 64.0
        self.active: dict[str, set[str]] = {}
        self._nodes: list[_Node] = []
        clock = SimpleNamespace(
            monotonic=lambda: self.now, monotonic_ns=lambda: round(self.now * 1e9)
        )
        for module in (health, node, topics):
            monkeypatch.setattr(module, "time", clock)

    def start(self, robot: str, monitor: BoundMonitor) -> None:
        """Start the node of a monitor on a robot."""
        assert monitor.config is not None
        config = monitor.config.config
        used = {one.id: one for binding in monitor.inputs for one in binding.requires}
        words = [one for one in used.values() if one.peers is not None]
        parts: dict[str, Any] = {
            "INPUTS": [Input(o.id, o.topic, None) for o in used.values() if o not in words],
            "OUTPUTS": [
                Output(one.id, one.topic, MESSAGE_CLASSES.ConSertOutput)
                for one in config.EDDIOutputs
            ],
            "FREQUENCY": 1 / PERIOD,
        }
        if config.Fleet is not None:
            sources = tuple(
                Source(
                    o.id, _names(o.peers.robots), o.peers.model, o.peers.digest, o.peers.guarantee
                )
                for o in words
                if o.peers is not None
            )
            fleet = config.Fleet
            word = MESSAGE_CLASSES.RobotGuarantees
            parts["FLEET"] = Fleet(fleet.robot, fleet.topic, word, fleet.lease, sources)
        running = compiled(monitor)
        made = type("RosNode", (_Node,), parts)(self, robot, running, GivenInput(monitor.inputs))
        made.init_publisher()
        made.init_subscriber()
        self._nodes.append(made)

    def publish(self, topic: str, message: Any) -> None:
        """Give a message to all that listen."""
        if hasattr(message, "guarantees"):
            self.active[topic] = {one.id for one in message.guarantees if one.active}
        for one in self._nodes:
            for source in one.heard.get(topic, ()):
                one.receive(source, message)

    def run(self, seconds: float, sensors: Sequence[str] = ()) -> None:
        """Let time pass, in which sensors say at each step that all is fine; others are silent."""
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            for topic in sensors:
                self.publish(topic, SimpleNamespace(data=True))
            for one in self._nodes:
                one.step()


class _Node(Node):
    def __init__(self, robots: Robots, robot: str, running: Any, given: Any) -> None:
        super().__init__(running, given, converter(MESSAGE_CLASSES), None)
        self.eddi_input.bind(running.inputs)
        for spec in running.inputs:
            setattr(self.eddi_input, spec.attribute, spec.default)
        self.robots, self.robot = robots, robot
        self.heard: dict[str, list[str]] = {}

    def full(self, topic: str) -> str:
        return full_topic(topic, f"/{self.robot}", "")

    def advertise(self, channel: Any) -> Any:
        return lambda message: self.robots.publish(self.full(channel.topic), message)

    def subscribe(self, source: Any) -> None:
        self.heard.setdefault(self.full(source.topic), []).append(source.id)

    def receive(self, source: str, message: Any) -> None:
        self._receipts.receive(source, message)


def _names(robots: Any) -> tuple[str, ...]:
    return () if robots == "any" else robots
