"""Where a configuration or a model accepts less, and which claims rest on it.

"A claim is active only if it is for every value that silent sources may have" holds for all
monitors, unless a key of its own accepts less. Such keys are never silent themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eddi_scaffold.claims import Acceptance
from eddi_scaffold.deployments.wiring.support import Participant, supports
from eddi_scaffold.graphs import reached, reversed_graph
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.accepting import of_input
from eddi_scaffold.problems import Place, Problem, warning


@dataclass(frozen=True)
class Accepted:
    """One acceptance in a deployment.

    Attributes:
        monitor: name of the participant.
        what: the acceptance.
        topics: what its input is read from.
        claims: those that rest on it, of any participant.
        place: its place.
    """

    monitor: str
    what: Acceptance
    topics: tuple[str, ...]
    claims: tuple[str, ...]
    place: Place

    def as_json(self) -> dict[str, JsonValue]:
        """Return a row of ``trace --json``."""
        return {
            "monitor": self.monitor,
            "input": self.what.input,
            "key": self.what.key,
            "accepts": self.what.accepts,
            "topics": list(self.topics),
            "claims": list(self.claims),
            "seconds": self.what.seconds,
        }

    def as_text(self) -> str:
        """Return one sentence."""
        who = f"input {self.what.input!r} of {self.monitor}" if self.what.input else self.monitor
        rest = "rests" if len(self.claims) == 1 else "rest"
        on = self.what.accepts + (f" of {', '.join(self.topics)}" if self.topics else "")
        claims = ", ".join(self.claims)
        return f"{who}, `{self.what.key}`: {claims} {rest} on {on} {self.what.lasts}"


def acceptances(participants: Sequence[Participant]) -> list[Accepted]:
    """Return every acceptance on which a claim rests; claims rest on no ring."""
    users = reversed_graph(supports(participants))
    found = []
    for one in participants:
        for what in _of(one):
            above = reached(users, [one.claim(name) for name in _outputs(one, what)])
            if above:
                claims = tuple(claim for claim in users if claim in above)
                topics = tuple(one.topics(what.input)) if what.input else ()
                found.append(Accepted(one.name, what, topics, claims, _place(one, what)))
    return found


def check_acceptances(participants: Sequence[Participant]) -> Iterator[Problem]:
    """Report each acceptance (D009)."""
    for one in acceptances(participants):
        yield warning("D009", one.as_text(), one.place)


def _of(one: Participant) -> Iterator[Acceptance]:
    yield from one.kind.functions.accepted(one.document, one.frequency)
    specs = {spec["id"]: spec for spec in one.document["inputs"]}
    for index, entry in enumerate(one.config.config.EDDIInputs):
        if entry.id in specs:
            yield from of_input(entry, specs[entry.id], index)


def _outputs(of: Participant, one: Acceptance) -> Sequence[str]:
    if one.outputs is not None:
        return one.outputs
    return [
        output
        for output, inputs in of.outputs.items()
        if (one.input in inputs if one.input else inputs)
    ]


def _place(of: Participant, one: Acceptance) -> Place:
    if one.at is not None:
        return Place(of.model_file, *one.at)
    return of.config.place(*one.path)
