"""Configurations that belong together: one monitor's output is another one's input."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eddi_scaffold.config import ConfigFile, Input
from eddi_scaffold.problems import Problem, warning

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


def _limit(item: Input) -> float | None:
    return item.max_age if isinstance(item.max_age, float) else None
