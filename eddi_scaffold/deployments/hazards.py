"""From hazards and requirements of an EDDI to guarantees, and to what these rest on.

That a guarantee is linked, proved, tested or withdrawn in time is known here; whether a hazard is
mitigated is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.deployments.lifetimes import ClaimLifetime, bounds
from eddi_scaffold.deployments.support import (
    Accepted,
    WiredMonitor,
    acceptances,
    claims_read,
    publishers_of,
    supports,
)
from eddi_scaffold.eddi_xml.hazard_analysis import HazardAnalysis, Item
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_rules import kind_of_message

_GIVE = "give the configurations of its monitors as well"
_LINKS = {"place", "mitigated_by", "observers", "refers_to"}  # which a row follows
State = Literal["unlinked", "observed", "linked", "proved", "tested", "in time", "stale"]


@dataclass(frozen=True)
class Verification:
    """What is known of a package at this moment."""

    is_proved: bool = False  # `verify` proved all of it
    is_tested: bool = False  # its tests pass
    # whose digest is not the one that it should be: "model", "configuration", "compiled.py", ...
    differs: tuple[str, ...] = ()
    result: str = ""  # for people: "22 vectors, 22 passed"

    def as_text(self) -> str:
        """Return it in a few words."""
        if self.differs:
            return f"stale: {', '.join(self.differs)}"
        proved = "proved" if self.is_proved else "not proved"
        tested = "tested" if self.is_tested else "not tested"
        return ", ".join(filter(None, [proved, tested, self.result]))


@dataclass(frozen=True)
class Guarantee:
    """A guarantee that an EDDI can name."""

    name: str  # CONSERT/GUARANTEE
    claim: str  # as `ClaimLifetime.claim` and `Accepted.claims` name it
    rests_on: frozenset[str]  # inputs of its ConSert; empty: it is constant
    place: Place


@dataclass(frozen=True)
class InputSupport:
    """An input that a claim rests on."""

    id: str
    method: str  # `EDDIInput.process_PathClear`, whose region may be hand-written
    topics: tuple[str, ...]  # full names of those that it is read from
    claims: tuple[str, ...]  # of other monitors, on these topics
    is_open: bool  # it reads a monitor that is not there


@dataclass(frozen=True)
class ClaimSupport:
    """A claim of a monitor with what it rests on."""

    claim: str  # monitor and output
    package: str  # of the monitor
    gates: tuple[str, ...]
    inputs: tuple[InputSupport, ...]
    known: Verification  # of the package

    def as_text(self) -> str:
        """Return lines for people."""
        gates = f" by {', '.join(self.gates)}" if self.gates else ""
        inputs = (
            f"{of.id} <- {', '.join(of.claims or of.topics)} ({of.method})"
            + (": no monitor publishes it" if of.is_open else "")
            for of in self.inputs
        )
        known = f"{self.claim}{gates} ({self.package}: {self.known.as_text()})"
        return "\n    ".join([known, *inputs])


@dataclass(frozen=True)
class HazardRow:
    """A hazard or a requirement with all that leads from it to the robot.

    Nothing in it says that a hazard is mitigated: ``states`` names links, proofs, tests and times.
    """

    item: Item
    parts: tuple[Item, ...]  # requirements, hazards and measures whose guarantees are its own
    guarantees: tuple[Guarantee, ...]  # that are linked, of monitors that there are
    observers: tuple[str, ...]  # `event motor_watch/hot`, of monitors that there are
    support: tuple[ClaimSupport, ...]  # each once: the guarantees, then what they rest on
    lifetimes: tuple[ClaimLifetime, ...]  # of the guarantees: how long they outlive silence
    accepted: tuple[Accepted, ...]  # acceptances on which the guarantees rest

    @property
    def is_linked(self) -> bool:
        """Whether a guarantee that can be withdrawn is linked."""
        return any(guarantee.rests_on for guarantee in self.guarantees)

    @property
    def is_complete(self) -> bool:
        """Whether all monitors that the guarantees rest on are there."""
        return not any(input_.is_open for of in self.support for input_ in of.inputs)

    @property
    def within_s(self) -> float | None:
        """The shortest detection time that it states, else that of its parts."""
        times = [of.within_s for of in self.parts if of.within_s is not None]
        return self.item.within_s or min(times, default=None)

    @property
    def worst(self) -> ClaimLifetime | None:
        """The longest time from silence to the loss of the guarantees; ``None``: not known."""
        bounded = {of.claim for of in self.lifetimes}
        unbounded = any(of.rests_on and of.claim not in bounded for of in self.guarantees)
        if unbounded or not self.is_complete:
            return None
        return max(self.lifetimes, key=lambda of: of.seconds, default=None)

    @property
    def bound(self) -> str:
        """The same for people."""
        return "no bound is known" if self.worst is None else self.worst.as_text()

    @property
    def is_in_time(self) -> bool:
        """Whether the bound is within the time, where there are both."""
        worst, within = self.worst, self.within_s
        return worst is not None and within is not None and round(worst.seconds, 9) <= within

    @property
    def states(self) -> tuple[State, ...]:
        """All that is known; `stale` stands for what was proved, tested and computed before."""
        if not self.guarantees:
            return ("observed",) if self.observers else ("unlinked",)
        known = [of.known for of in self.support]
        if any(of.differs for of in known):
            return ("linked", "stale")
        states: dict[State, bool] = {
            "proved": all(of.is_proved for of in known),
            "tested": all(of.is_tested for of in known),
            "in time": self.is_in_time,
        }
        is_known = self.is_linked and self.is_complete and bool(known)
        return ("linked", *(state for state, holds in states.items() if holds and is_known))

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``trace --json``."""
        return {
            **{name: of for name, of in vars(self.item).items() if name not in _LINKS},
            "line": self.item.place.line,
            "path": self.item.path,
            "states": self.states,
            "through": [{"name": of.name, "path": of.path} for of in self.parts],
            "guarantees": [of.name for of in self.guarantees],
            "observers": self.observers,
            "within_s": self.within_s,
            "bound": self.worst.as_json() if self.worst is not None else None,
            "accepted": [of.as_text() for of in self.accepted],
            "support": [of.claim for of in self.support],
        }

    def as_text(self) -> str:
        """Return lines for people."""
        of, within = self.item, self.within_s
        lines = [*of.risks, *(f"malfunction {name}" for name in of.malfunctions)]
        lines += [f"claim {name}" for name in of.claims]
        lines += [f"through {part.title} (line {part.place.line})" for part in self.parts]
        lines += [f"observed by {text}" for text in self.observers]
        lines += [f"guarantee {guarantee.name}" for guarantee in self.guarantees]
        lines += [] if within is None else [f"within {within:g} s: {self.bound}"]
        place = f"{of.place.file}:{of.place.line}"
        return "\n    ".join([f"{of.title} ({place}): {', '.join(self.states)}", *lines])


@dataclass
class HazardTrace:
    """The rows of an EDDI, with what is wrong with them."""

    analysis: HazardAnalysis  # of the EDDI, as `read_models` returns it
    monitors: Sequence[WiredMonitor]  # of the robot: `members_of` models, or `facts_of_package`
    others: Sequence[BoundMonitor] = ()  # of models that have no configuration
    verified: Mapping[str, Verification] = field(default_factory=dict)  # by package
    # by each name that the EDDI may use
    guarantees: dict[str, Guarantee] = field(init=False, default_factory=dict)
    # by the path of a hazard or requirement, in document order, hazards first
    rows: dict[str, HazardRow] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        """Follow all claims."""
        all_facts = [(of.name, of.model_file, of.facts) for of in self.monitors]
        all_facts += [(of.id, of.model.source.name, of.facts) for of in self.others]
        for monitor, file, facts in all_facts:
            rests_on = {claim.id: claim.rests_on for claim in facts.claims}
            for of in facts.elements:
                id_ = of.id if of.id in rests_on else of.claim
                if of.element == "guarantee" and id_ in rests_on:
                    about = f"{monitor}.{id_}", rests_on[id_], Place(file, of.line, path=of.path)
                    for name in (f"{monitor}/{of.id}", f"{facts.id}/{of.id}"):
                        self.guarantees.setdefault(name, Guarantee(name, *about))
        self._below = supports(self.monitors)
        published = publishers_of(self.monitors)
        support: dict[str, ClaimSupport] = {}
        for wire, read in claims_read(self.monitors):
            known = self.verified.get(wire.package, Verification())
            absent = {
                source.id
                for source in wire.config.config.SimulatorOutputs
                if kind_of_message(source.type) is not None and source.peers is None
                if wire.topic(source.topic) not in published
            }
            for claim in wire.facts.claims:
                inputs = tuple(
                    InputSupport(
                        of.id,
                        f"EDDIInput.process_{of.attribute}",
                        tuple(dict.fromkeys(topic for topic, _ in wire.topics_read[of.id])),
                        tuple(dict.fromkeys(read[of.id])),
                        not absent.isdisjoint(of.requires),
                    )
                    for of in wire.facts.inputs
                    if of.id in claim.rests_on
                )
                name = wire.claim(claim.id)
                support[name] = ClaimSupport(name, wire.package, claim.gates, inputs, known)
        running = {name for monitor, _, facts in all_facts for name in (monitor, facts.id)}
        lifetimes, accepted = bounds(self.monitors), acceptances(self.monitors)
        for path, item in self.analysis.items.items():
            if item.kind == "measure":
                continue
            parts = self.analysis.parts(item)
            texts = [value.text for part in parts for value in part.mitigated_by]
            named = [self.guarantees[text] for text in texts if text in self.guarantees]
            linked = {guarantee.claim: guarantee for guarantee in named}
            observers = [pair for part in parts for pair in part.observers]
            own = [claim for claim in linked if claim in support]
            below = sorted(reached(self._below, own) - {*own})
            self.rows[path] = HazardRow(
                item,
                tuple(parts[1:]),
                tuple(linked.values()),
                tuple(f"{tag} {of}" for tag, of in observers if of.partition("/")[0] in running),
                tuple(support[claim] for claim in (*own, *below)),
                tuple(of for of in lifetimes if of.claim in linked),
                tuple(of for of in accepted if linked.keys() & {*of.claims}),
            )

    def check(self) -> Iterator[Problem]:
        """Report what is missing between hazards and guarantees: J001 to J007."""
        yield from self.analysis.problems
        similar = SimilarNames(self.guarantees, "the guarantees are")
        for value in (value for of in self.analysis.items.values() for value in of.mitigated_by):
            if value.text not in self.guarantees:
                hint = similar.hint(value.text) if self.guarantees else _GIVE
                yield problem("J005.unknown", value.place, hint=hint, name=value.text)
        for row in self.rows.values():
            yield from self._check_row(row)
        linked = {of.claim for row in self.rows.values() for of in row.guarantees}
        needed = linked | reached(self._below, linked & self._below.keys())
        for guarantee in {of.claim: of for of in self.guarantees.values()}.values():
            if guarantee.rests_on and guarantee.claim not in needed:
                yield problem("J007", guarantee.place, name=guarantee.name)

    def _check_row(self, row: HazardRow) -> Iterator[Problem]:
        item, place, what = row.item, row.item.place, row.item.title
        hazards = [self.rows[path] for path in item.refers_to["hazard"] if path in self.rows]
        # of a goal, what is wrong with its hazard is reported there
        is_wanted = item.kind == "hazard" or (item.is_goal and all(of.is_linked for of in hazards))
        if is_wanted and not row.guarantees:
            yield problem("J001.unlinked", place, what=what)
        elif is_wanted and not row.is_linked:
            names = ", ".join(of.name for of in row.guarantees)
            yield problem("J001.constant", place, what=what, names=names)
        elif is_wanted:
            for accepted in row.accepted:
                yield problem("J004", place, what=what, reason=accepted.as_text())
        if item.within_s is not None and row.is_linked and not row.is_in_time:
            hint, within = _GIVE if row.worst is None else None, f"{item.within_s:g}"
            yield problem("J003", place, hint=hint, what=what, within=within, reason=row.bound)
