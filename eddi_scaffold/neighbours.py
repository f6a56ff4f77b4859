"""Configurations that belong together: one monitor's output is another one's input."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold import fields
from eddi_scaffold.binding import Monitor
from eddi_scaffold.config import ConfigFile, Input
from eddi_scaffold.problems import Problem, did_you_mean, error, warning

_PERIODS = 2


def check_neighbours(configs: Sequence[ConfigFile]) -> Iterable[Problem]:
    """Warn where an input gives up on a monitor that is only between two of its steps (K029)."""
    providers = {
        output.topic: config.config.Model
        for config in configs
        for output in config.config.EDDIOutputs
    }
    for config in configs:
        topics = {source.id: source.topic for source in config.config.SimulatorOutputs}
        for index, item in enumerate(config.config.EDDIInputs):
            for provider in (providers.get(topics.get(name, "")) for name in item.requires):
                limit = _limit(item)
                if provider is None or limit is None or limit * provider.frequency >= _PERIODS:
                    continue
                message = (
                    f"input {item.id!r} is unknown after {limit} s, but {provider.id} publishes "
                    f"only every {1 / provider.frequency:g} s"
                )
                place = config.place("EDDIInputs", index, "max_age")
                hint = f"at least {_PERIODS} periods: max_age: {_PERIODS / provider.frequency:g}"
                yield warning("K029", message, place, hint)


def check_ids(monitors: Sequence[Monitor]) -> Iterable[Problem]:
    """Report inputs that take what no monitor beside them gives: ``evidence[RtE_gone]`` (K047)."""
    providers = {
        (output.topic, f"eddi_messages/{monitor.kind.output_message}"): monitor
        for monitor in monitors
        if monitor.config is not None
        for output in monitor.config.config.EDDIOutputs
    }
    for config in (one.config for one in monitors if one.config is not None):
        sources = {source.id: source for source in config.config.SimulatorOutputs}
        for index, item in enumerate(config.config.EDDIInputs):
            for source in (sources[name] for name in item.requires if name in sources):
                provider = providers.get((source.topic, source.type))
                if provider is None or provider.config is config or item.field is None:
                    continue
                place = config.place("EDDIInputs", index, "field")
                for name, known in _missing(item.field, provider):
                    message = f"{item.field!r}: {provider.model.name} gives no {name!r}"
                    hint = did_you_mean(name, known) or f"it gives: {', '.join(known) or 'none'}"
                    yield error("K047", message, place, hint)


def _missing(field: str, provider: Monitor) -> Iterable[tuple[str, Sequence[str]]]:
    """Yield the id that a field path asks for and the monitor does not have, with those it has."""
    try:
        first, second = fields.parse_field(field)[:2]
    except ValueError:  # no path, which is said elsewhere, or one of one step
        return
    if isinstance(first, fields.Attribute) and isinstance(second, fields.ById):
        known = provider.kind.ids(provider.model).get(first.name)
        if known is not None and second.id not in known:
            yield second.id, known


def _limit(item: Input) -> float | None:
    return item.max_age if isinstance(item.max_age, float) else None
