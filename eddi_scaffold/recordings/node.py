"""A node without ROS: what is between its subscribers and the monitor, and what it publishes.

What reaches it is ROS messages, or objects with their fields.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.inputs import UNKNOWN_AGE, Word
from eddi_runtime.monitor import Tree
from eddi_runtime.node.topics import Receipt
from eddi_runtime.peers import Fleet, Peers
from eddi_runtime.plain_values import by_id, by_key, by_name, follow, given, joined

from eddi_scaffold.common.identifiers import full_topic
from eddi_scaffold.config.field_paths import PlainStep, plain_step
from eddi_scaffold.config.field_types import element, is_primitive
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.publications import Publication, publications

Message = SimpleNamespace  # one attribute for each field, and `message_type`

SECOND = 1_000_000_000  # nanoseconds
WORDS = Fleet("", "", None, 0.0).words().id
"""By which a node knows the messages between robots; they start no step."""
_HELPERS: Mapping[str, Callable[..., Any]] = {
    called.__name__: called for called in (by_id, by_key, by_name, given, joined)
}
PLAIN_DEFAULTS: Mapping[str, Any] = {"bool": False, "string": "", "float32": 0.0, "float64": 0.0}


def blank(message_type: str) -> Message:
    """Return a message in which every field has the default of its type."""
    fields = known_messages()[message_type].items()
    return Message(message_type=message_type, **{name: _default(type_) for name, type_ in fields})


def _default(type_: str) -> Any:
    if type_.endswith("]"):
        return []
    return PLAIN_DEFAULTS.get(type_, 0) if is_primitive(type_) else blank(type_)


def message_of(tree: Tree) -> Message:
    """Return a message of the product's own package, with an empty header."""
    name, fields = tree
    types = known_messages()[f"eddi_messages/{name}"].items()
    content = {
        field: blank(type_) if type_ == "std_msgs/Header" else _content(type_, fields[field])
        for field, type_ in types
    }
    return Message(**content, message_type=f"eddi_messages/{name}")


def _content(type_: str, value: Any) -> Any:
    if (inner := element(type_)) is not None:
        return [_content(inner, item) for item in value]
    if type_ in ("float32", "float64"):
        return float(value)
    return value if is_primitive(type_) else message_of(value)


class Channel(NamedTuple):
    """One topic of a monitor."""

    topic: str  # its full name
    publication: Publication
    path: Sequence[PlainStep]  # to the one value of the message that goes here, empty for all of it


class Publications:
    """The topics of one monitor, which has a configuration without errors."""

    def __init__(self, monitor: BoundMonitor, namespace: str = "") -> None:
        assert monitor.config is not None
        outputs, problems = publications(monitor, monitor.config)
        assert not problems, problems
        self.channels = []
        for entry in outputs:
            topic = full_topic(entry.output.topic, namespace, monitor.package)
            self.channels.append(Channel(topic, entry, [*map(plain_step, entry.path)]))

    @property
    def topics(self) -> frozenset[str]:
        """Their full names."""
        return frozenset(channel.topic for channel in self.channels)

    def messages(
        self, running: RuntimeMonitor[Any], output: Any, topics: Collection[str]
    ) -> list[tuple[str, Message]]:
        """Return topic and message of what a step publishes, on some topics."""
        by_message: dict[str, Sequence[Message]] = {}
        published: list[tuple[str, Message]] = []
        for topic, entry, path in self.channels:
            if topic not in topics:
                continue
            of = entry.of
            if of not in by_message:
                trees = getattr(running, f"{of}_message")() if of else running.message(output)
                trees = trees if isinstance(trees, list) else [] if trees is None else [trees]
                by_message[of] = [message_of(tree) for tree in trees]
            for message in by_message[of]:
                if entry.output.event not in (None, getattr(message, "id", None)):
                    continue
                if not path:
                    published.append((topic, message))
                    continue
                with suppress(AttributeError, LookupError):  # it does not have the value
                    value = Message(message_type=entry.type, data=follow(message, path))
                    published.append((topic, value))
        return published


@dataclass(frozen=True)
class Received:
    """One message that a node was given."""

    t: int  # nanoseconds
    source: str  # id of the simulator output
    message: Any
    latched: bool = False  # it came on subscription and can be of any age


@dataclass(frozen=True)
class Step:
    """One step of a node."""

    t: float  # time in seconds
    inputs: Mapping[str, Any]  # input id -> what the monitor read, None when unknown
    output: Any  # what it gave


Process = Callable[..., object]  # makes an attribute of messages


def processing_of(
    eddi_input: Any, bindings: Sequence[tuple[InputBinding, Process]]
) -> Callable[..., None]:
    """Return a ``processing`` that calls these for the inputs, as a generated one does."""
    bound = []
    for binding, process in bindings:
        update = eddi_input.update
        if binding.model.every_message:
            update = eddi_input.update_each
        elif binding.computed is not None:
            update = eddi_input.update_expression
        requires = [requirement.id for requirement in binding.requires]
        bound.append((binding.model.id, update, process, requires))

    def processing(simulator_outputs: Mapping[str, Any], _t_ns: int | None = None) -> None:
        for id_, update, process, requires in bound:
            update(id_, process, simulator_outputs, requires)
        eddi_input.processed(simulator_outputs)

    return processing


class GivenInput(EDDIInputBase):
    """``EDDIInput`` of a package without hand-written lines."""

    def __init__(self, bindings: Sequence[InputBinding]) -> None:
        super().__init__()
        lines = [(binding, generated_lines(self, binding)) for binding in bindings]
        self.processing = processing_of(self, lines)


class _Words(Peers):
    """What a node that is played tells other robots, and hears of them."""

    def _echoed(self, message: Any) -> float:
        # A recorded robot answered another run of this node: by its clock that was its last word.
        if not isinstance(message, Message) and self._told:
            return self._told[-1][1]
        return super()._echoed(message)


class ReplayedNode:
    """One process of a monitor, which has received nothing yet.

    Args:
        eddi_input: an ``EDDIInput`` as a package has it: with a method ``processing``.
        running: the monitor; it should have been reset.
        step: what takes the place of ``running.execute_step``, where a package wraps it.
        fleet: the robots among which it is one.
    """

    def __init__(
        self,
        eddi_input: Any,
        running: RuntimeMonitor[Any],
        step: Callable[..., Any] | None = None,
        fleet: Fleet | None = None,
    ) -> None:
        self._running = running
        running.deferred = True  # what a robot did is not done again
        self._execute = step or running.execute_step
        self._eddi_input = eddi_input
        for spec in running.inputs:
            setattr(self._eddi_input, spec.attribute, spec.default)
        self._eddi_input.bind(running.inputs)
        self._latest: dict[str, Received] = {}
        self._words: _Words | None = None
        if fleet is not None:
            name = (fleet.robot, running.model_id, "replayed")
            self._words = _Words(name, running.digest, fleet.lease, fleet.sources)
        # input id -> the first exception of its hand-written lines and its traceback
        self.raised: dict[str, tuple[str, str]] = {}

    def step(self, t: int, messages: Sequence[Received], clock: int | None = None) -> Step:
        """Take messages over, update every input, and evaluate.

        Args:
            t: nanoseconds, of the clock of the messages.
            messages: those that came since the last step.
            clock: nanoseconds of the step itself, where another clock counts for it.
        """
        new: dict[str, list[Any]] = defaultdict(list)
        for message in messages:
            if message.source != WORDS:
                self._latest[message.source] = message
            new[message.source].append(message.message)
        now = t if clock is None else clock
        latest = {name: last.message for name, last in self._latest.items()}
        ages = {
            name: UNKNOWN_AGE if message.latched else (t - message.t) / SECOND
            for name, message in self._latest.items()
        }
        for spec in self._running.inputs:  # a column is as old as the messages in its place
            for name in spec.requires if spec.id in ages else ():
                ages[name] = max(ages[spec.id], ages.get(name, 0.0))
        words: Mapping[str, Word] = {}
        if self._words is not None:
            receipts: dict[str, Receipt] = {}
            words = self._words.take(receipts, new, t / SECOND)
            ages |= {name: receipt.age_at(t / SECOND) for name, receipt in receipts.items()}
            fit = (name for name in receipts if not words[name].unfit)
            latest |= {name: receipts[name].message for name in fit}
        with redirect_stdout(sys.stderr):  # hand-written code may print: data are ours alone
            self._eddi_input.begin_step(ages, new, now, words or None)
            self._eddi_input.processing(latest)
            self._eddi_input.end_step()
            output = self._execute(self._eddi_input, now)
        for name, state in self._eddi_input.states.items():
            if state.state == "invalid" and getattr(state, "detail", ""):
                self.raised.setdefault(name, (state.reason, state.detail))
        values = {
            input_.id: getattr(self._eddi_input, input_.attribute, None)
            for input_ in self._running.inputs
        }
        return Step(t / SECOND, values, output)

    def word(self, output: Any, t: int) -> Message | None:
        """Return what it tells other robots after a step, ``None`` where it is alone."""
        tree = self._running.message(output) if self._words is not None else None
        if self._words is None or not isinstance(tree, tuple):
            return None
        return message_of(self._words.told(message_of(tree), self._running, t / SECOND))


def generated_lines(target: EDDIInputBase, binding: InputBinding) -> Process:
    """Return what ``process_<input>`` does in a package without hand-written lines."""
    if binding.computed is not None:
        name = binding.model.id
        return lambda *_: setattr(target, binding.attribute, target.expression(name))
    # made of checked names and literals: the same line is code in a package
    code = compile(binding.expression or "None", "EDDIInput", "eval")

    def process(*messages: Any) -> None:
        names = dict(zip(binding.arguments, messages, strict=True))
        setattr(target, binding.attribute, eval(code, {**_HELPERS}, names))  # noqa: S307

    return process
