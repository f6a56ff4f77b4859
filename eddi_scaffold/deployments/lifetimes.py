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

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.support import WiredMonitor, supports, topics_read
from eddi_scaffold.deployments.topics import Deployment
from eddi_scaffold.kinds import JsonValue


@dataclass(frozen=True)
class ClaimLifetime:
    """When a claim goes away at the latest after a source fell silent.

    Attributes:
        claim: monitor and output.
        source: full name of a topic that no participant publishes.
        seconds: while all monitors live; infinite where an input has no age limit.
        any_seconds: whatever dies on the way, at any times.
    """

    claim: str
    source: str
    seconds: float
    any_seconds: float

    def as_json(self) -> dict[str, JsonValue]:
        """Return a row of ``trace --json``; no bound is null."""
        return {
            "claim": self.claim,
            "source": self.source,
            "bound_s": _number(self.seconds),
            "bound_any_s": _number(self.any_seconds),
        }

    def as_text(self) -> str:
        """Return one sentence."""
        if math.isinf(self.seconds):
            return f"{self.claim} may outlive {self.source} for ever"
        return (
            f"{self.claim} goes away at most {self.seconds:.3g} s after {self.source} fell silent"
        )


_Times = dict[str, tuple[float, float]]
"""Source -> bound while all monitors live, and bound whatever dies."""


def bounds(participants: Sequence[WiredMonitor]) -> list[ClaimLifetime]:
    """Return the bounds of all claims, in the order of the participants; claims have no ring."""
    support = supports(participants)
    owners = {
        participant.claim(output): (participant, output)
        for participant in participants
        for output in participant.claims
    }
    published = {topic for participant in participants for topic in participant.published()}
    known: dict[str, _Times] = {}
    for claim in in_order(support):
        one, output = owners[claim]
        known[claim] = _times(one, output, published, known, support[claim])
    return [
        ClaimLifetime(claim, source, *times)
        for claim in owners
        for source, times in sorted(known.get(claim, {}).items())
    ]


def _times(
    one: WiredMonitor,
    output: str,
    published: set[str],
    known: Mapping[str, _Times],
    below: Sequence[str],
) -> _Times:
    """Return the bounds of one claim from those of the claims that it rests on."""
    of = one.claims[output]
    step = 1 / one.frequency + of.hold_s
    inputs = of.rests_on
    found: _Times = {}
    ages = [0.0]
    for name, reads in topics_read(one).items():
        if name not in inputs:
            continue
        age = limit_of(one, name)
        for topic, _ in reads:
            if topic in published:
                ages.append(age)
            else:
                _raise(found, topic, (age + step, age + step))
    for claim in below:
        for source, (alive, dying) in known[claim].items():
            _raise(found, source, (alive + step, dying + max(ages) + step))
    return found


def _raise(found: _Times, source: str, times: tuple[float, float]) -> None:
    first, second = found.get(source, (0.0, 0.0))
    found[source] = max(first, times[0]), max(second, times[1])


def limit_of(one: WiredMonitor, name: str) -> float:
    """Return the seconds after which an input is unknown: the smallest limit that it has."""
    input_ = next(input_ for input_ in one.facts.inputs if input_.id == name)
    limits = (input_.timeout_s, input_.max_age)
    return min((limit for limit in limits if isinstance(limit, int | float)), default=math.inf)


def _number(seconds: float) -> float | None:
    return None if math.isinf(seconds) else round(seconds, 9)


_PERIODS = 2
"""Of a publisher that a limit must allow; a little more is what is advised."""
_ADVISED = 2.5


def check_ages(together: Deployment) -> Iterator[Problem]:
    """Report inputs that give up on a monitor between two of its steps (K029).

    Nobody has decided on a limit that is not written: where it does not fit, that is an error.
    """
    publishers: dict[str, list[WiredMonitor]] = {}
    for participant in together.participants:
        for topic in participant.published():
            publishers.setdefault(topic, []).append(participant)
    there = set(map(id, together.others))  # what is between these was told when they were made
    for reader in together.participants:
        for index, source in _reads(reader):
            for provider in publishers.get(reader.topic(source.topic), ()):
                if not there.issuperset((id(reader), id(provider))):
                    yield from _check(reader, index, source, provider)


def _reads(reader: WiredMonitor) -> Iterator[tuple[int, SimulatorOutput]]:
    """Yield each entry of ``EDDIInputs``, by its index, with each message that it reads."""
    config = reader.config.config
    required = {input_.id: input_.requires for input_ in reader.facts.inputs}
    for index, entry in enumerate(config.EDDIInputs):
        for source in config.SimulatorOutputs:
            if source.id in required.get(entry.id, ()):
                yield index, source


def _check(
    reader: WiredMonitor, index: int, source: SimulatorOutput, provider: WiredMonitor
) -> Iterator[Problem]:
    entry, period = reader.config.config.EDDIInputs[index], 1 / provider.frequency
    limit = source.limit if entry.max_age is None else entry.max_age
    if not isinstance(limit, float) or limit >= _PERIODS * period:
        return
    place = reader.config.place("EDDIInputs", index, "max_age")
    is_default = entry.max_age is None and source.max_age is None
    hint = f"at least {_PERIODS} periods: max_age: {_PERIODS * period:g}"
    if is_default:
        hint = f"write `max_age: {_ADVISED * period:g}` in its entry of EDDIInputs"
    yield problem(
        "K029.default_below_period" if is_default else "K029.below_period",
        place,
        hint=hint,
        input=entry.id,
        limit=limit,
        source=provider.name,
        period=period,
    )
