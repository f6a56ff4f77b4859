"""A robot in one process: nodes of the example on a transport of its own, in virtual time.

The nodes are the generated ``RosNode.py``; only what they take from a transport is replaced, by
one that delivers at once. The order within a step is that of every adapter.
"""

from __future__ import annotations

import runpy
import sys
from contextlib import nullcontext
from types import SimpleNamespace

from eddi_runtime import __version__
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node import health
from eddi_runtime.node.outputs import beside, channels, check_outputs, each, picked
from eddi_runtime.node.receipts import Receipt
from eddi_runtime.node.schedule import Schedule
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


class ToyNode:
    """Base class of a generated node, as ``MonitorNode`` of a transport is.

    Attributes:
        busy: seconds that a step takes.
        error: what goes wrong in a step.
        steps: times of the steps.
        levels: (time, level of the inputs), whenever that changed.
    """

    STARTUP_GRACE = 10.0

    def __init__(self, robot, eddi_monitor, eddi_input):
        self.robot, self.monitor, self.eddi_input = robot, eddi_monitor, eddi_input
        self.core = eddi_monitor.monitor
        eddi_input.bind(self.core.inputs)
        self.schedule = Schedule(1.0 / self.FREQUENCY, self.MODE == "on_change")
        self.health = health.Health(self.core, eddi_input, self.schedule.period, self.STARTUP_GRACE)
        self.receipts = {}
        self.busy, self.error = 0.0, ""
        self.steps, self.levels = [], []
        self.converter = converter(self.MESSAGES)
        result = self.core.message(self.core.execute_step(object()))
        check_outputs(self.converter, result, self.core, self.OUTPUTS)
        self.core.reset()

    def receive(self, topic, message, age=0.0):
        for source in self.INPUTS:
            if full(source.topic) == topic:
                before = self.receipts.get(source.id)
                count = 1 if before is None else before.received + 1
                self.receipts[source.id] = Receipt(message, self.robot.now, count, age)
                if self.MODE == "on_change":
                    self.turn()

    def step(self):
        started = self.robot.now
        receipts = dict(self.receipts)
        ages = {name: one.age_at(started) for name, one in receipts.items()}
        t_ns = self.robot.t_ns()
        self.eddi_input.begin_step(ages, None, t_ns)
        self.eddi_input.processing({name: one.message for name, one in receipts.items()})
        output = self.monitor.execute_step(self.eddi_input, t_ns)
        self.robot.now += self.busy
        for channel in channels(self.OUTPUTS):
            trees = beside(self.core, channel.of) if channel.of else self.core.message(output)
            for one in each(self.converter.messages(trees)):
                self.robot.publish(full(channel.topic), picked(one, channel), self)
        self.steps.append(started)
        if self.health.after_step(output, receipts, self.error, self.robot.now - started):
            self.levels.append((started - BEGIN, self.health._level))

    def turn(self):
        """Do what the loop does when a step is due."""
        started = self.robot.now
        self.step()
        self.schedule.stepped(started, self.robot.now)

    def report(self, *, periodic=True):
        return self.health.collect(
            identity={"runtime_version": __version__},
            receipts=self.receipts,
            overruns=self.schedule.overruns,
            master="not watched",
            wrong_types=(),
            periodic=periodic,
            topics={source.id: full(source.topic) for source in self.INPUTS},
        )

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
        monkeypatch.setattr(health, "LOG", SimpleNamespace(**levels))
        monkeypatch.setattr(health, "time", SimpleNamespace(monotonic=lambda: self.now))

    def t_ns(self):
        """Return the time of a step, of a clock that may be set back."""
        return round((self.now - self.set_back) * 1e9)

    def start(self, package, **changed):
        """Start the generated node of a package; class attributes may be changed."""
        script = WORKSPACE / package / "scripts" / "RosNode.py"
        ours = SimpleNamespace(
            Input=Input, Output=Output, MonitorNode=ToyNode, reported=nullcontext
        )
        with self._patch.context() as patch:
            patch.syspath_prepend(str(WORKSPACE / package / "src"))
            patch.setitem(sys.modules, "eddi_runtime.ros1", ours)
            for module in (EDDI_MESSAGES, STD_MSGS):
                name = module.__name__
                patch.setitem(sys.modules, name, module)
                patch.setitem(sys.modules, name.partition(".")[0], SimpleNamespace(msg=module))
            forget(package)  # another one of this name may have been imported
            found = runpy.run_path(str(script))
            forget(package)
        cls = type("RosNode", (found["RosNode"],), {"FREQUENCY": HERTZ, **changed})
        node = cls(self, found["EDDIMonitor"](), found["EDDIInput"]())
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
        """Have a sensor publish a Boolean at these times."""
        for t in times:
            self._planned.append((BEGIN + t, topic, STD_MSGS.Bool(data=value)))
        self._planned.sort(key=lambda one: one[0])

    def run(self, until):
        """Let time pass."""
        while True:
            due = [one.schedule.wait_s(self.now) + self.now for one in self._nodes]
            planned = [at for at, _, _ in self._planned[:1]]
            following = min(due + planned)
            if following > BEGIN + until:
                break
            self.now = max(self.now, following)
            if planned and planned[0] <= following:
                _, topic, message = self._planned.pop(0)
                self.publish(topic, message)
            else:
                self._nodes[due.index(following)].turn()
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


def full(topic):
    """Return the full name of a topic."""
    return topic if topic.startswith("/") else f"/{topic}"


def forget(package):
    """Let the next import of a package find it anew."""
    for name in [one for one in sys.modules if one.partition(".")[0] == package]:
        del sys.modules[name]
