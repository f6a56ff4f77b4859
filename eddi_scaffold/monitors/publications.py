"""What a monitor publishes: its messages, or one value of them as a message of ``std_msgs``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, OutputEntry, SimulatorOutput
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS, head_of
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.monitors.message_types import known_messages

MESSAGE_PACKAGE = "eddi_messages"
STATUS = "status"  # Name of the message with the facts behind a result
_OF_STD_MSGS = {"bool": "Bool", "float": "Float64", "int": "Int64", "str": "String"}


@dataclass(frozen=True)
class Publication:
    """One topic that a node publishes."""

    output: OutputEntry  # the entry of `EDDIOutputs`, or one that the model asks for
    type: str  # message type (`std_msgs/Bool`)
    place: Place  # where its topic is named
    message: str  # type of the message that contains the value, or of the whole message
    path: field_paths.FieldPath = ()  # place of the value in the message; empty for all of it
    of: str = ""  # which message of the monitor: empty for the result, else a companion message


def publications(
    monitor: BoundMonitor, config: ConfigFile
) -> tuple[list[Publication], list[Problem]]:
    """Return what the node publishes, and what is wrong with it (K020, K029)."""
    messages = messages_of(monitor)
    published: list[Publication] = []
    problems: list[Problem] = []
    parts = list(monitor.model.separate_outputs())
    for index, output in enumerate(config.config.EDDIOutputs):
        places = partial(config.place, "EDDIOutputs", index)
        if output.event is not None and output.event not in parts:
            hint = did_you_mean(output.event, parts) or f"there are: {', '.join(parts) or 'none'}"
            problems.append(problem("K020.event", places("event"), hint=hint, event=output.event))
            continue
        if output.field is None:
            for name, type_ in messages.items():  # the result, then its additional messages
                own = output
                if name:
                    own = _output(f"{output.id}/{name}", f"{output.topic}/{name}")
                published.append(Publication(own, type_, places("topic"), type_, of=name))
            continue
        try:
            path = field_paths.parse_field(output.field)
            begins = getattr(path[0], "name", "")  # the first message that has it, else the result
            has_it = (name for name, type_ in messages.items() if begins in known_messages()[type_])
            of = next(has_it, "")
            whole, type_ = _value_at(path, messages[of])
        except field_paths.FieldPathError as failure:
            place, advice = places("field"), failure.hint
            problems.append(problem("K020.field", place, hint=advice, reason=failure))
            continue
        plain = [field_paths.plain_step(step) for step in path]
        problems += check_path(output.field, plain, monitor, places("field"))
        published.append(Publication(output, type_, places("topic"), messages[of], whole, of))
    for topic in monitor.model.own_topics():
        path = tuple(
            field_paths.Attribute(s) if isinstance(s, str) else field_paths.ByKey(s[1])
            for s in topic.path
        )
        whole, type_ = _value_at(path, messages[topic.of])
        own = _output(topic.id, topic.topic)
        published.append(Publication(own, type_, topic.place, messages[topic.of], whole, topic.of))
    return published, problems


def check_path(
    text: str, path: Sequence[field_paths.PlainStep], provider: BoundMonitor, place: Place
) -> Iterator[Problem]:
    """Report the id that a path into a message asks for, and the monitor does not have (K020)."""
    ids = provider.model.element_keys()
    before = ""
    for step in path:
        if isinstance(step, str):
            before += f".{step}" if before else step
            continue
        key = step if isinstance(step, int) else step[-1] if step[0] != "*" else 0
        known = ids.get(before)
        if known is not None and isinstance(key, str) and key not in known:
            hint = did_you_mean(key, known) or f"it gives: {', '.join(known) or 'none'}"
            fields = {"reference": text, "model": provider.model.name, "expected": key}
            yield problem("K020.part", place, hint=hint, **fields)
            return
        before += f"[{key}]"


def messages_of(monitor: BoundMonitor) -> dict[str, str]:
    """Return name -> type of the monitor's messages; the name of the result is empty."""
    names = {"": monitor.kind.output_message, **monitor.model.companion_messages()}
    return {name: f"{MESSAGE_PACKAGE}/{message}" for name, message in names.items()}


def _output(name: str, topic: str) -> OutputEntry:
    return OutputEntry.model_construct(id=name, topic=topic, field=None, event=None)


def _value_at(path: field_paths.FieldPath, message: str) -> tuple[field_paths.FieldPath, str]:
    """Return a path with its keys, and the type of ``std_msgs`` for the single value at its end."""
    resolved = field_paths.resolve(path, message, known_messages().get)
    if resolved.type not in _OF_STD_MSGS:
        raise field_paths.FieldPathError(f"the path ends at {resolved.type}, not at a single value")
    return resolved.path, f"std_msgs/{_OF_STD_MSGS[resolved.type]}"


_LONG = 100.0  # Seconds of a limit that are more likely meant as milliseconds


def check_limits(config: ConfigFile) -> Iterable[Problem]:
    """Warn of what is hardly ever too old: milliseconds may be meant (K029)."""
    for section in ("SimulatorOutputs", "EDDIInputs"):
        for index, item in enumerate(getattr(config.config, section)):
            limit = item.max_age
            if isinstance(limit, float) and limit >= _LONG:
                place = config.place(section, index, "max_age")
                yield problem("K029.long", place, input=item.id, limit=limit, seconds=limit / 1000)


def check_ids(monitors: Sequence[BoundMonitor]) -> Iterable[Problem]:
    """Report inputs that take what no other monitor publishes: ``evidence[RtE_gone]`` (K020)."""
    configured = [(monitor, monitor.config) for monitor in monitors if monitor.config is not None]
    providers = {
        (f"{monitor.topic(output.topic)}/{name}".rstrip("/"), message): monitor
        for monitor, config in configured
        for output in config.config.EDDIOutputs
        for name, message in messages_of(monitor).items()
    }
    for monitor, config in configured:
        entries = {entry.id: (k, entry) for k, entry in enumerate(config.config.EDDIInputs)}
        for binding in monitor.inputs:
            for source in binding.requires if binding.model.id in entries else ():
                provider = providers.get((monitor.topic(source.topic), source.type))
                if provider is None or provider is monitor:
                    continue
                index, entry = entries[binding.model.id]
                for key, text, path in _paths(entry, binding, source):
                    place = config.place("EDDIInputs", index, key)
                    yield from check_path(text, path, provider, place)


def _paths(
    item: InputEntry, binding: InputBinding, source: SimulatorOutput
) -> Iterable[tuple[str, str, Sequence[field_paths.PlainStep]]]:
    """Yield the paths of an input into one message: key of the entry, text, steps."""
    if item.field is not None:
        try:
            steps = [field_paths.plain_step(step) for step in field_paths.parse_field(item.field)]
            yield "field", item.field, steps
        except field_paths.FieldPathError:  # no path, which is reported elsewhere
            return
    key = next((key for key in EXPRESSION_KEYS if getattr(item, key) is not None), "id")
    computed: Mapping[str, Any] = binding.computed or {}
    paths = computed.get("paths", {})
    for name in (name for name in paths if head_of(name) == attribute(source.id)):
        yield key, name, paths[name]
