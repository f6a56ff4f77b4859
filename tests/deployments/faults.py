"""Deployments with a fault that the checks of properties must find: they test the tests."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from random import Random

from eddi_scaffold.recordings.node import Received
from tests.deployments.drafts import END, Draft
from tests.deployments.drawing import Wiring, draft_of, with_history
from tests.deployments.pool.stock import rings, sound, unsound
from tests.deployments.pool.templates import Template
from tests.deployments.world import MS, History, Member, Observer


class Latched(Observer):
    """Lets latched messages count as new."""

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        """Return the messages without the mark."""
        return [replace(one, latched=False) for one in messages]


class Ageless(Observer):
    """Lets nothing get old: what came last comes again in every step."""

    def __init__(self) -> None:
        self._latest: dict[tuple[str, str], Received] = {}

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        """Return the messages, and the last ones of the sources that are silent."""
        self._latest.update(((member.name, one.source), one) for one in messages)
        new = {one.source for one in messages}
        again = [
            one
            for (name, source), one in self._latest.items()
            if name == member.name and source not in new
        ]
        return [*messages, *(replace(one, t=t * MS) for one in again)]

    def begun(self, member: Member) -> None:
        """Forget what the process had received."""
        self._latest = {key: one for key, one in self._latest.items() if key[0] != member.name}


def fleet(rng: Random, *, shared: bool) -> Draft:
    """Draw two robots of the same monitors, whose sources live and die on their own.

    Args:
        shared: one topic of a monitor is the same for both.
    """
    wiring = Wiring(rng)
    wiring.require(next(one for one in sound()["consert"] if "guarantee" in _heard(one)))
    one = with_history(rng, wiring)
    other = with_history(rng, wiring)
    names = {f"/{instance.name}/out" for instance in one.instances if shared}
    robots = [_robot("r1", one, names), _robot("r2", other, names)]
    pairs = zip(*(robot.instances for robot in robots), strict=True)
    return replace(
        robots[0],
        instances=tuple(instance for pair in pairs for instance in pair),
        offers={**robots[0].offers, **robots[1].offers},
        values=tuple(sorted((v for r in robots for v in r.values), key=lambda v: v.t)),
        history=History(END),
    )


def robot_of(draft: Draft, name: str) -> Draft:
    """Return one robot of a fleet, alone."""
    own = tuple(one for one in draft.instances if one.name.startswith(f"{name}_"))
    return replace(draft, instances=own)


def _heard(template: Template) -> set[str]:
    return {slot.reading.offer for slot in template.slots}


def _robot(name: str, draft: Draft, shared: set[str]) -> Draft:
    def topic(text: str) -> str:
        return text if any(text.startswith(one) for one in shared) else f"/{name}{text}"

    instances = tuple(
        replace(
            one,
            name=f"{name}_{one.name}",
            out=topic(one.out),
            topics={source: topic(text) for source, text in one.topics.items()},
        )
        for one in sorted(draft.instances, key=lambda one: one.name)
    )
    offers = {topic(text): offer for text, offer in draft.offers.items()}
    values = tuple(one._replace(topic=topic(one.topic)) for one in draft.values)
    return replace(draft, instances=instances, offers=offers, values=values)


RUNTIME: Mapping[str, Callable[[], Observer]] = {"latched": Latched, "ageless": Ageless}
"""Faults that lie in no wiring: observers of what really happens."""


def faulty(fault: str, rng: Random) -> Draft:
    """Draw a deployment that has a fault, beside other monitors."""
    if fault == "latched":
        return next(draft for draft in iter(lambda: draft_of(rng), None) if _latches(draft))
    if fault in RUNTIME:
        return draft_of(rng)
    return _ring(rng) if fault == "cycle" else draft_of(rng, unsound()[fault])


def _latches(draft: Draft) -> bool:
    """Whether a monitor begins anew and hears what a source said to others before."""
    return any(value.latched for value in draft.values)


def _ring(rng: Random) -> Draft:
    wiring = Wiring(rng)
    left, right = rings()
    wiring.add(left, {"s1": "/m2/out"})
    wiring.add(right, {"s1": "/m1/out"})
    return with_history(rng, wiring)
