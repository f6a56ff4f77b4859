"""Configurations that belong together: one monitor's output is another one's input."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.monitors.publications import check_path, messages_of

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
    for name, path in binding.key_paths.get(source.id, {}).items():
        yield key, name, path
