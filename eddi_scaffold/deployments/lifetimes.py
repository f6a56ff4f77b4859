"""How long a claim may outlive its sources, and whether messages come often enough.

From the last message of a source to the loss of a claim behind n monitors pass at most the age
limit of the first monitor's input and one period of every monitor on the way: a step may fall just
before the limit. When monitors on the way may die as well, every age limit counts. The times of
transport and computing are not in these figures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.deployments.support import (
    Deployment,
    WiredMonitor,
    publishers_of,
    supports,
    supports_of_inputs,
)
from eddi_scaffold.kinds import JsonValue


@dataclass(frozen=True)
class ClaimLifetime:
    """When a claim goes away at the latest after a source fell silent."""

    claim: str  # monitor and output
    source: str  # full name of a topic that no participant publishes
    seconds: float  # while all monitors live; infinite where an input has no age limit
    any_seconds: float  # whatever dies on the way, at any times

    def as_json(self) -> dict[str, JsonValue]:
        """Return a row of ``trace --json``; no bound is null."""
        return {
            "claim": self.claim,
            "source": self.source,
            "bound_s": None if math.isinf(self.seconds) else round(self.seconds, 9),
            "bound_any_s": None if math.isinf(self.any_seconds) else round(self.any_seconds, 9),
        }

    def as_text(self) -> str:
        """Return one sentence."""
        if math.isinf(self.seconds):
            return f"{self.claim} may outlive {self.source} for ever"
        return (
            f"{self.claim} goes away at most {self.seconds:.3g} s after {self.source} fell silent"
        )


Effect = Literal["silence", "unknown", "value"]
"""What a topic suffers: no more messages, those that say nothing, or bad values; from then on."""
Times = dict[str, tuple[float, float]]
"""Topic -> bound while all monitors live, and bound whatever dies."""


def bounds(participants: Sequence[WiredMonitor]) -> list[ClaimLifetime]:
    """Return the bounds of all claims, in the order of the participants; claims have no ring."""
    published = publishers_of(participants)
    return [
        ClaimLifetime(claim, source, *times)
        for claim, of in times_of_claims(participants, "silence").items()
        for source, times in sorted(of.items())
        if source not in published
    ]


def times_of_claims(participants: Sequence[WiredMonitor], effect: Effect) -> Mapping[str, Times]:
    """Return for each claim, and topic on the way to it, after how many seconds it is lost.

    They count from the last good message of the topic. Bad values need a model that is at hand.
    """
    support = supports_of_inputs(participants)
    owners = {of.claim(output): (of, output) for of in participants for output in of.claims}
    known: dict[str, Times] = {}
    for claim in in_order(supports(participants)):
        below = {name: [known[of] for of in claims] for name, claims in support[claim].items()}
        known[claim] = _times(*owners[claim], below, effect)
    return {claim: known.get(claim, {}) for claim in owners}


def _times(
    monitor: WiredMonitor, output: str, below: Mapping[str, Sequence[Times]], effect: Effect
) -> Times:
    """Return the times of one claim from those of the claims that it rests on, by input."""
    claim = monitor.claims[output]
    inputs = {input_.id: input_ for input_ in monitor.facts.inputs}
    step_s = 1 / monitor.frequency + claim.hold_s  # a step may fall just before the limit
    times: Times = {}

    def keep_longest(topic: str, alive_s: float, dying_s: float) -> None:
        first, second = times.get(topic, (0.0, 0.0))
        times[topic] = max(first, alive_s), max(second, dying_s)

    for name, claims in below.items():
        limits = inputs[name].timeout_s, inputs[name].max_age
        limit_s = min((of for of in limits if isinstance(of, int | float)), default=math.inf)
        held_s = claim.held_s(name)
        first_s = limit_s + held_s if effect == "silence" else held_s
        if effect == "value" and monitor.bound is not None:
            first_s = monitor.bound.lag(output, name)
            held_s = max(held_s, first_s)  # what comes from below may be unknown as well
        for topic, _ in monitor.topics_read[name]:
            keep_longest(topic, first_s + step_s, limit_s + held_s + step_s)
        for topic, (alive_s, dying_s) in (item for of in claims for item in of.items()):
            keep_longest(topic, alive_s + held_s + step_s, dying_s + limit_s + held_s + step_s)
    return times


_PERIODS = 2  # of a publisher that a limit must allow


def check_ages(together: Deployment) -> Iterator[Problem]:
    """Report inputs that give up on a monitor between two of its steps (K029).

    Nobody has decided on a limit that is not written: where it does not fit, that is an error.
    """
    there = set(map(id, together.others))  # what is between these was reported when they were made
    for reader in together.participants:
        required = {input_.id: input_.requires for input_ in reader.facts.inputs}
        for index, entry in enumerate(reader.config.config.EDDIInputs):
            for source in reader.config.config.SimulatorOutputs:
                limit = source.limit if entry.max_age is None else entry.max_age
                if source.id not in required.get(entry.id, ()) or not isinstance(limit, float):
                    continue
                is_default = entry.max_age is None and source.max_age is None
                case = "K029.default_below_period" if is_default else "K029.below_period"
                place = reader.config.place("EDDIInputs", index, "max_age")
                for provider, _ in together.publishers.get(reader.topic(source.topic), ()):
                    period, is_new = 1 / provider.frequency, not there >= {id(reader), id(provider)}
                    if is_new and limit < (least := _PERIODS * period):
                        names = {"input": entry.id, "source": provider.name}
                        yield problem(case, place, limit=limit, period=period, least=least, **names)
