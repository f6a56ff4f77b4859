"""ROS 1 bags as inputs of a monitor: the messages that its node would have received.

Needs the extra ``bags`` (rosbags), and no ROS.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eddi_runtime import EDDIInputBase
from eddi_runtime.access import by_id, joined

from eddi_scaffold.binding import InputBinding, Monitor
from eddi_scaffold.config import ConfigFile, SimulatorOutput
from eddi_scaffold.problems import EddiError, Place, Problem, did_you_mean, error, warning
from eddi_scaffold.recording import Frame

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor

_HELPERS: Mapping[str, Callable[..., Any]] = {"by_id": by_id, "joined": joined}


@dataclass(frozen=True)
class Received:
    """One message of a bag.

    Attributes:
        t: nanoseconds since the first message of the bag, of any topic.
        source: id of the simulator output.
    """

    t: int
    source: str
    message: Any


@dataclass(frozen=True)
class Bag:
    """What a monitor's node would have received from a bag.

    Attributes:
        end: nanoseconds from the first to the last message of the bag, of any topic.
    """

    messages: tuple[Received, ...]
    end: int


def read_bag(path: Path, config: ConfigFile, wanted: Sequence[SimulatorOutput]) -> Bag:
    """Read the messages of some topics.

    Args:
        path: a ROS 1 bag.
        config: for places.
        wanted: the simulator outputs that inputs require.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), or holds a topic
            with another type than the configuration says (I012).
    """
    try:
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra
    except ImportError:
        hint = "pip install 'eddi-scaffold[bags]'"
        raise EddiError(error("I010", "rosbags is not installed", hint=hint)) from None
    place = Place(str(path))
    try:
        store = get_typestore(Stores.ROS1_NOETIC)
        with AnyReader([path], default_typestore=store) as reader:
            by_topic: dict[str, list[SimulatorOutput]] = defaultdict(list)
            for source in wanted:
                by_topic[absolute(source.topic)].append(source)
            found = [one for one in reader.connections if absolute(one.topic) in by_topic]
            _refuse(_wrong_types(found, by_topic, config))
            start = reader.start_time
            messages = tuple(
                Received(t - start, source.id, reader.deserialize(data, connection.msgtype))
                for connection, t, data in reader.messages(found)
                for source in by_topic[absolute(connection.topic)]
            )
            return Bag(messages, reader.end_time - start)
    except EddiError:
        raise
    except Exception as failed:  # noqa: BLE001 - a damaged bag makes rosbags raise anything
        reason = " ".join(str(failed).split()) or type(failed).__name__
        raise EddiError(error("I011", f"cannot read the bag: {reason}", place)) from None


def _refuse(problems: Iterable[Problem]) -> None:
    found = list(problems)
    if found:
        raise EddiError(*found)


def absent(path: Path, bag: Bag, wanted: Sequence[SimulatorOutput]) -> Problem:
    """Return a warning for the topics without a message in the bag (I013); info when none lacks."""
    there = {one.source for one in bag.messages}
    lacking = [source.topic for source in wanted if source.id not in there]
    message = (
        f"no message of {', '.join(lacking)} in the bag" if lacking else "every topic is there"
    )
    level = warning if lacking else _quiet
    return level("I013", message, Place(str(path)))


def _quiet(code: str, message: str, place: Place) -> Problem:
    return Problem("info", code, message, place)


def absolute(topic: str) -> str:
    """Return a topic as it stands in a bag."""
    return topic if topic.startswith("/") else f"/{topic.lstrip('~/')}"


def _wrong_types(
    connections: Sequence[Any], by_topic: Mapping[str, list[SimulatorOutput]], config: ConfigFile
) -> Iterator[Problem]:
    for connection in connections:
        of = connection.msgtype.replace("/msg/", "/")
        for source in by_topic[absolute(connection.topic)]:
            if of != source.type:
                message = (
                    f"{source.topic} is a {of} in the bag, the configuration says {source.type}"
                )
                index = config.config.SimulatorOutputs.index(source)
                place = config.place("SimulatorOutputs", index, "type")
                yield error("I012", message, place, did_you_mean(of, [source.type]))


def written_by_hand(monitor: Monitor) -> list[str]:
    """Return the inputs whose values only code of a person gives: they stay unknown here."""
    return [one.model.id for one in monitor.inputs if one.requires and not one.is_given]


def frames_of(monitor: Monitor, running: RuntimeMonitor, bag: Bag) -> Iterator[Frame]:
    """Yield the steps of the node: one per period, or in mode ``on_change`` one per message, too.

    Messages that came at the same time count as one change.
    """
    assert monitor.config is not None
    section = monitor.config.config.Model
    running.reset()
    node = _Node(monitor.inputs, running)
    for t, messages in _instants(bag, 1e9 / section.frequency, section.mode == "on_change"):
        yield node.step(t, messages)


def _instants(bag: Bag, period: float, on_change: bool) -> Iterator[tuple[int, Sequence[Received]]]:
    """Yield the times of steps with the messages since the last one."""
    waiting = 0
    step = 1
    due = period
    times = sorted({one.t for one in bag.messages}) if on_change else []
    position = 0
    while True:
        change = times[position] if position < len(times) else None
        t = round(due) if change is None or due <= change else change
        if t > bag.end:
            return
        if change is not None and t >= change:
            position += 1
        fresh = waiting
        while waiting < len(bag.messages) and bag.messages[waiting].t <= t:
            waiting += 1
        yield t, bag.messages[fresh:waiting]
        step += 1
        due = t + period if on_change else step * period


class _Node:
    """The part of a node between its subscribers and the monitor."""

    def __init__(self, bindings: Sequence[InputBinding], running: RuntimeMonitor) -> None:
        self._running = running
        self._eddi_input = EDDIInputBase()
        self._eddi_input.bind(running.inputs)
        self._bindings = bindings
        self._process = [_process(self._eddi_input, binding) for binding in bindings]
        self._latest: dict[str, Any] = {}
        self._times: dict[str, int] = {}
        for spec in running.inputs:
            setattr(self._eddi_input, spec.attribute, spec.default)

    def step(self, t: int, messages: Sequence[Received]) -> Frame:
        """Take messages over, update every input, and evaluate."""
        new: dict[str, list[Any]] = defaultdict(list)
        for one in messages:
            self._latest[one.source] = one.message
            self._times[one.source] = one.t
            new[one.source].append(one.message)
        ages = {name: (t - at) / 1e9 for name, at in self._times.items()}
        self._eddi_input.begin_step(ages, new, t)
        for binding, process in zip(self._bindings, self._process, strict=True):
            update = self._eddi_input.update
            if binding.model.every_message:
                update = self._eddi_input.update_each
            elif binding.computed is not None:
                update = self._eddi_input.update_expression
            update(binding.model.id, process, self._latest, [one.id for one in binding.requires])
        output = self._running.execute_step(self._eddi_input, t)
        values = {one.model.id: getattr(self._eddi_input, one.attribute) for one in self._bindings}
        return Frame(t / 1e9, values, output)


def _process(target: EDDIInputBase, binding: InputBinding) -> Callable[..., None]:
    """Return what ``process_<input>`` does in a package without hand-written lines."""
    tree = ast.parse(binding.expression, mode="eval").body if binding.expression else None

    if binding.computed is not None:
        name = binding.model.id
        return lambda *_: setattr(target, binding.attribute, target.expression(name))

    def process(*messages: Any) -> None:
        names = dict(zip(binding.arguments, messages, strict=True))
        value = None if tree is None else _value(tree, names)
        setattr(target, binding.attribute, value)

    return process


def _value(tree: ast.expr, names: Mapping[str, Any]) -> Any:
    """Evaluate the few forms of which our own expressions are made."""
    if isinstance(tree, ast.Name):
        return names[tree.id]
    if isinstance(tree, ast.Constant):
        return tree.value
    if isinstance(tree, ast.Attribute):
        return getattr(_value(tree.value, names), tree.attr)
    if isinstance(tree, ast.Subscript):
        return _value(tree.value, names)[_value(tree.slice, names)]
    if isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name):
        return _HELPERS[tree.func.id](*(_value(argument, names) for argument in tree.args))
    raise TypeError(f"no expression of ours: {ast.dump(tree)}")
