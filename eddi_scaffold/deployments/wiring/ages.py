"""Default age limits where the period of the publisher is known: 2.5 of its periods.

A message of a monitor that has died counts by its age alone, so every input on a topic of a monitor
needs a limit. The period of the topics of sensors is not known here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry
from eddi_scaffold.deployments.wiring.check import members_of
from eddi_scaffold.deployments.wiring.deployment import Deployment, Member, deployment
from eddi_scaffold.deployments.wiring.lifetimes import limit_of
from eddi_scaffold.deployments.wiring.support import Participant, published
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.problems import Problem, info

_PERIODS = 2.5


def with_default_ages(
    monitors: Sequence[BoundMonitor], others: Callable[[], Sequence[Participant]] = lambda: ()
) -> list[tuple[ConfigFile, list[Problem]] | None]:
    """Return the configuration of each monitor with the limits that it lacks, if it lacks any.

    Args:
        monitors: those that run together.
        others: returns those that run with them; called where some limit is lacking.

    Returns:
        For each monitor ``None``, or its new configuration, and what to report of it (K053).
    """
    if not any(_lacks_some(one) for one in monitors):
        return [None] * len(monitors)
    own = {one.package for one in monitors}
    beside = [one for one in others() if one.package not in own]
    together = deployment(members_of(monitors), beside)
    members = {id(member.monitor): member for member in together.members}
    periods = dict(_periods(together))
    return [_completed(members[id(one)], periods) if _lacks_some(one) else None for one in monitors]


def without_ages(participants: Sequence[Participant]) -> Iterator[tuple[str, str]]:
    """Yield each package that would get a limit if it were generated now, and a sentence of it.

    It was generated before the monitor whose topic it reads.

    Args:
        participants: the monitors of a workspace, as their packages remember them.
    """
    periods = dict(_periods(deployment((), participants)))
    for one in participants:
        for input_, seconds in _ages(one, periods):
            topics = ", ".join(one.topics(input_))
            text = (
                f"input {input_!r} (from {topics}) has no max_age, and stays as it was if its "
                f"publisher dies; {seconds:g} s, {_PERIODS} periods, if its configuration is "
                "given to `generate` again"
            )
            yield one.package, text


def _lacks_some(monitor: BoundMonitor) -> bool:
    return monitor.config is not None and any(
        binding.max_age is None and binding.requires for binding in monitor.inputs
    )


def _completed(
    member: Member, periods: Mapping[str, Mapping[str, float]]
) -> tuple[ConfigFile, list[Problem]] | None:
    ages = dict(_ages(member.participant, periods))
    if not ages:
        return None
    config = member.config.config
    entries = [
        entry.model_copy(update={"max_age": ages[entry.id]}) if entry.id in ages else entry
        for entry in config.EDDIInputs
    ]
    reported = [
        _report_limit(entry, member.config, index)
        for index, entry in enumerate(entries)
        if entry.id in ages
    ]
    return replace(
        member.config, config=config.model_copy(update={"EDDIInputs": entries})
    ), reported


def _report_limit(entry: InputEntry, config: ConfigFile, index: int) -> Problem:
    message = (
        f"input {entry.id!r} has no max_age: it is unknown after {entry.max_age:g} s, "
        f"{_PERIODS} periods of the monitor that publishes it"
    )
    return info("K053", message, config.place("EDDIInputs", index))


def _ages(
    participant: Participant, periods: Mapping[str, Mapping[str, float]]
) -> Iterator[tuple[str, float]]:
    """Yield each input that has no limit at all and reads monitors only, with its limit."""
    specs = {spec["id"]: spec for spec in participant.document["inputs"]}
    for entry in participant.config.config.EDDIInputs:
        spec = specs.get(entry.id)
        if spec is None or spec["max_age"] is not None:
            continue
        found = [
            [period for of, period in periods.get(topic, {}).items() if of != participant.name]
            for topic in participant.topics(entry.id)
        ]
        if found and all(found) and math.isinf(limit_of(participant, entry.id)):
            yield entry.id, _PERIODS * max(max(one) for one in found)


def _periods(together: Deployment) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield each topic of a monitor, with the periods of those that publish it, by their names."""
    for topic, found in together.publishers.items():
        yield topic, {one.member.name: 1 / one.member.participant.frequency for one in found}
    for other in together.others:
        for topic, _ in published(other):
            if topic not in together.publishers:
                yield topic, {other.name: 1 / other.frequency}
