"""Configurations that belong together: one monitor's output is another one's input."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from eddi_scaffold.common.identifiers import full_topic, package_name
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS
from eddi_scaffold.monitors.publications import check_path

_LONG = 100.0
"""Seconds of a limit that are more likely meant as milliseconds."""


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
    providers = {given: monitor for monitor in monitors for given in _given(monitor)}
    for monitor in monitors:
        if monitor.config is not None:
            for binding in monitor.inputs:
                yield from _unknown_ids(monitor.config, binding, providers)


def _unknown_ids(
    config: ConfigFile, binding: InputBinding, providers: Mapping[tuple[str, str], BoundMonitor]
) -> Iterable[Problem]:
    for index, item in enumerate(config.config.EDDIInputs):
        if item.id != binding.model.id:
            continue
        for source in binding.requires:
            provider = providers.get((_full(config, source.topic), source.type))
            if provider is None or provider.config is config:
                continue
            for key, text, path in _paths(item, binding, source):
                place = config.place("EDDIInputs", index, key)
                yield from check_path(text, path, provider, place)


def _given(monitor: BoundMonitor) -> Iterable[tuple[str, str]]:
    """Yield topic and type of the messages that a monitor publishes."""
    kind, beside = monitor.kind, monitor.model.companion_messages()
    config = monitor.config
    for output in config.config.EDDIOutputs if config is not None else ():
        assert config is not None
        topic = _full(config, output.topic)
        yield topic, f"eddi_messages/{kind.output_message}"
        for name, message in beside.items():
            yield f"{topic}/{name}", f"eddi_messages/{message}"


def _full(config: ConfigFile, topic: str) -> str:
    """Return the full name of a topic: a relative one and an absolute one may be the same."""
    return full_topic(topic, "", package_name(config.config.Model.id))


def _paths(
    item: InputEntry, binding: InputBinding, source: SimulatorOutput
) -> Iterable[tuple[str, str, Sequence[field_paths.PlainStep]]]:
    """Yield the paths of an input into one message: key of the entry, text, steps."""
    if item.field is not None:
        try:
            yield (
                "field",
                item.field,
                [field_paths.plain_step(s) for s in field_paths.parse_field(item.field)],
            )
        except field_paths.FieldPathError:  # no path, which is reported elsewhere
            return
    key = next((key for key in EXPRESSION_KEYS if getattr(item, key) is not None), "id")
    for name, path in binding.key_paths.get(source.id, {}).items():
        yield key, name, path
