"""A robot in one process: nodes of the example on a transport of its own, in virtual time.

The nodes are the generated ``RosNode.py``; only what they take from a transport is replaced, by
one that delivers at once.
"""

from __future__ import annotations

import math
import runpy
import sys
from contextlib import nullcontext
from types import SimpleNamespace

from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node import claim_log, health, node, topics
from eddi_runtime.node.node import Node
from eddi_runtime.node.topics import Input, Output

from runtime_lib.tests.node.message_package import (
    EDDI_MESSAGES,
    STD_MSGS,
    WORKSPACE,
    converter,
)

BEGIN = 64.0
"""Of the monotonic clock, which starts when the machine does."""
HERTZ = 8.0
"""Of every node, unless a test changes it: times on this grid are exact."""


class ToyNode(Node):
    """Base class of a generated node, as ``MonitorNode`` of a transport is.

    Attributes:
        busy: seconds that a step takes.
        error: what is wrong with an output.
        steps: times of the steps.
        levels: (time, level of the inputs), whenever that changed.
    """

    def __init__(self, robot, eddi_monitor, eddi_input):
        super().__init__(eddi_monitor, eddi_input, converter(self.MESSAGES), None)
        self.robot = robot
        self.busy, self.error = 0.0, ""
        self.steps, self.levels = [], []
        self.core, self.schedule, self.health = self._core, self._schedule, self._health
        self.subscribed, self.tell_at = {}, robot.now
        self._wake_teller = self.wake
        self.prepare()
        self.init_publisher()
        self.init_subscriber()

    def wake(self):
        self.tell_at = self.robot.now

    def subscribe(self, source):
        self.subscribed[full(source.topic)] = source.id

    def resolved(self, topic):
        return full(topic)

    def advertise(self, channel):
        return lambda message: self.robot.publish(full(channel.topic), message, self)

    def now_ns(self):
        return self.robot.t_ns()

    def report_now(self):
        self.levels.append((self.steps[-1] - BEGIN, self._health._level))
        super().report_now()

    def receive(self, topic, message, age=0.0):
        source = self.subscribed.get(full(topic))
        if source is not None:
            self._receipts.receive(source, message, age)
            if self.MODE == "on_change" and not topic.endswith("/why"):
                self.turn()

    def create_ros_msg(self, eddi_output):
        self.robot.now += self.busy
        return super().create_ros_msg(eddi_output)

    def _publish(self, output):
        return super()._publish(output) or self.error

    def step(self):
        self.steps.append(self.robot.now)
        super().step()

    def turn(self):
        """Do what the loop does when a step is due."""
        started = self.robot.now
        self.step()
        self._schedule.stepped(started, self.robot.now)

    def told(self):
        """Do what the thread does that tells how monitors are."""
        waits = self.tell(periodic=self.robot.now % 1.0 == 0.0).waits
        self.tell_at = self.robot.now + 0.125 if waits else math.floor(self.robot.now + 1.0)

    def report(self, *, periodic=True):
        return self.status(self.graph(), periodic=periodic)

    def values(self):
        return dict(self.report(periodic=False).values)


class Robot:
    """A clock, topics, and the nodes that run.

    Attributes:
        now: of the monotonic clock; times in arguments count from ``BEGIN``.
        told: (time, topic, message) of all that nodes published.
        lines: what the nodes logged.
    """

    def __init__(self, monkeypatch):
        self.now = BEGIN
        self.set_back = 0.0
        self.told, self.lines = [], []
        self._patch = monkeypatch
        self._planned, self._nodes, self._latched = [], [], {}
        levels = {
            one: lambda text, *values, level=one: self.lines.append((level, text % values))
            for one in ("info", "warn", "error")
        }
        for module in (claim_log, health, node):
            monkeypatch.setattr(module, "LOG", SimpleNamespace(**levels))
        clock = SimpleNamespace(monotonic=lambda: self.now)
        for module in (health, node, topics):
            monkeypatch.setattr(module, "time", clock)

    def t_ns(self):
        """Return the time of a step, of a clock that may be set back."""
        return round((self.now - self.set_back) * 1e9)

    def start(self, package, eddi_input=None, **changed):
        """Start the generated node of a package; its ``EDDIInput``, class attributes may differ."""
        found = generated(package, ToyNode, self._patch)
        cls = type("RosNode", (found["RosNode"],), {"FREQUENCY": HERTZ, **changed})
        node = cls(self, found["EDDIMonitor"](), (eddi_input or found["EDDIInput"])())
        node.step()  # before anything can arrive
        for topic, (message, _) in self._latched.items():
            node.receive(topic, message, UNKNOWN_AGE)
        node.schedule.start(self.now)
        self._nodes.append(node)
        return node

    def kill(self, node):
        """End a process: it publishes nothing more, and nothing of it is latched any more."""
        self._nodes.remove(node)
        self._latched = {t: one for t, one in self._latched.items() if one[1] is not node}

    def publish(self, topic, message, node=None):
        if node is not None:
            self.told.append((self.now - BEGIN, topic, message))
            self._latched[topic] = (message, node)
        for one in list(self._nodes):
            one.receive(topic, message)

    def sense(self, topic, *times, value=True):
        """Have a sensor publish a Boolean, or what is given in its place, at these times."""
        for t in times:
            self._planned.append((BEGIN + t, topic, STD_MSGS.Bool(data=value)))
        self._planned.sort(key=lambda one: one[0])

    def run(self, until):
        while True:
            due = [one.schedule.wait_s(self.now) + self.now for one in self._nodes]
            telling = [one.tell_at for one in self._nodes]
            planned = [at for at, _, _ in self._planned[:1]]
            following = min(due + planned + telling)
            if following > BEGIN + until:
                break
            self.now = max(self.now, following)
            if planned and planned[0] <= following:
                _, topic, message = self._planned.pop(0)
                self.publish(topic, message)
            elif following in due:
                self._nodes[due.index(following)].turn()
            else:
                self._nodes[telling.index(following)].told()
        self.now = max(self.now, BEGIN + until)

    def active(self, topic, after=0.0):
        """Return (time, ids of active guarantees) at each change of what was published."""
        found = []
        for t, of, message in self.told:
            if of == topic and t >= after:
                ids = {one.id for one in message.guarantees if one.active}
                if not found or found[-1][1] != ids:
                    found.append((t, ids))
        return found


def generated(package, base, monkeypatch):
    """Return what is in the generated ``RosNode.py`` of a package, with a base class of ours."""
    script = WORKSPACE / package / "scripts" / "RosNode.py"
    ours = SimpleNamespace(Input=Input, Output=Output, MonitorNode=base, reported=nullcontext)
    with monkeypatch.context() as patch:
        patch.syspath_prepend(str(WORKSPACE / package / "src"))
        patch.setitem(sys.modules, "eddi_runtime.transports.ros1", ours)
        for module in (EDDI_MESSAGES, STD_MSGS):
            name = module.__name__
            patch.setitem(sys.modules, name, module)
            patch.setitem(sys.modules, name.partition(".")[0], SimpleNamespace(msg=module))
        forget(package)  # another one of this name may have been imported
        found = runpy.run_path(str(script))
        forget(package)
    return found


def full(topic):
    return topic if topic.startswith("/") else f"/{topic}"


def forget(package):
    for name in [one for one in sys.modules if one.partition(".")[0] == package]:
        del sys.modules[name]
