"""Random deployments: which monitors, who listens to whom, what sources say, what goes wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from random import Random
from typing import Any

from eddi_scaffold.recordings.node import Received
from tests.deployments.drafts import END, TICK, Draft, Instance, Value
from tests.deployments.pool.networks import FAR, USUAL
from tests.deployments.pool.stock import doubting, offering, rings, sound, unsound
from tests.deployments.pool.templates import NUMBERS, SOURCE_TYPES, TEXTS, Slot, Template
from tests.deployments.world import MS, History, Member, Observer

SIZES = (2, 2, 3, 3, 4, 4, 5, 6)
_STRANGE = {"flag": ("wrong",), "number": (float("nan"), float("inf"), 900.0, True), "text": (7,)}
"""Values that are none, or out of every range."""
KINDS = ("consert", "event", "bayesian_network", "reliability", "safeml", "state_machine")


def draft_of(rng: Random, with_it: Template | None = None) -> Draft:
    """Draw a deployment.

    Args:
        with_it: a template that it must have, with what that one needs.
    """
    wiring = Wiring(rng)
    if with_it is not None:
        wiring.require(with_it)
    elif rng.random() < 0.2:
        wiring.require(rng.choice(doubting()))
    for _ in range(len(wiring.instances), rng.choice(SIZES)):
        wiring.add(wiring.choose())
    return with_history(rng, wiring)


def with_history(rng: Random, wiring: Wiring) -> Draft:
    instances = wiring.instances
    if rng.random() < 0.3:  # not everybody steps behind those that it listens to
        rng.shuffle(instances)
    values = sorted(_values(rng, wiring), key=lambda one: one.t)
    history = _history(rng, [instance.name for instance in instances])
    values += _latched(rng, instances, wiring.offers, values, history)
    ordered = sorted(values, key=lambda one: one.t)
    return Draft(tuple(instances), wiring.offers, tuple(ordered), history)


class Wiring:
    """Monitors that are put together one after the other: no cycle comes about by itself.

    Attributes:
        instances: the monitors.
        offers: topic of a source -> what it offers.
        slots: topic of a source -> who was the first to read it.
    """

    def __init__(self, rng: Random) -> None:
        self.instances: list[Instance] = []
        self.offers: dict[str, str] = {}
        self.slots: dict[str, Slot] = {}
        self._rng = rng
        self._there: dict[str, list[str]] = {}

    def choose(self) -> Template:
        """Return a template all of whose messages can be had; one that listens to others rather."""
        pool = sound()
        fitting: Sequence[Template] = ()
        while not fitting:
            kind = self._rng.choice([one for one in KINDS if one in pool])
            fitting = [one for one in pool[kind] if self._fits(one)]
        listening = [one for one in fitting if any(self._offered(slot) for slot in one.slots)]
        return self._rng.choice(listening if listening and self._rng.random() < 0.65 else fitting)

    def require(self, template: Template, depth: int = 0) -> None:
        """Add a monitor behind others that offer what it reads."""
        for slot in template.slots:
            if not self._there_is(slot):
                makers = offering(slot.reading.offer)
                simple = [one for one in makers if not one.listens]
                self.require(self._rng.choice(simple if simple and depth else makers), depth + 1)
        self.add(template)

    def _fits(self, template: Template) -> bool:
        return all(self._there_is(slot) for slot in template.slots)

    def _there_is(self, slot: Slot) -> bool:
        return slot.reading.offer in SOURCE_TYPES or self._offered(slot)

    def _offered(self, slot: Slot) -> bool:
        return slot.reading.offer in self._there

    def add(self, template: Template, given: Mapping[str, str] | None = None) -> None:
        """Add a monitor; its topics are drawn among what is there, but for those given."""
        name = f"m{len(self.instances) + 1}"
        topics = dict(given or {})
        for slot in template.slots:
            topics[slot.source] = topics.get(slot.source) or self._topic(slot)
        delay = TICK if self._rng.random() < 0.07 else 0
        out = f"/{name}/out"
        self.instances.append(Instance(name, template, topics, out, delay))
        for offer, suffix in template.offers.items():
            self._there.setdefault(offer, []).append(out + suffix)

    def _topic(self, slot: Slot) -> str:
        offer = slot.reading.offer
        if offer not in SOURCE_TYPES:
            return self._rng.choice(self._there[offer])
        known = [topic for topic, what in self.offers.items() if what == offer]
        if known and self._rng.random() < 0.3:
            return self._rng.choice(known)
        topic = f"/{offer}{len(known) + 1}"
        self.offers[topic] = offer
        self.slots[topic] = slot
        return topic


def _values(rng: Random, wiring: Wiring) -> Iterator[Value]:
    """Draw what each source says: favourable as a rule, then silent, late, twice, or wrong."""
    for topic, offer in wiring.offers.items():
        good = wiring.slots[topic].good
        begin = rng.choice((0, 0, 0, TICK, 3 * TICK))
        death = rng.choice((None, rng.randrange(0, END, TICK)))
        back = END + 1 if death is None else death + rng.randrange(TICK, END, TICK)
        for k, t in enumerate(range(begin, END + 1, TICK)):
            if (death is not None and death <= t < back) or rng.random() < 0.06:
                continue
            value = _value(rng, offer, good, k)
            yield Value(t + (TICK if rng.random() < 0.04 else 0), topic, value)
            if rng.random() < 0.03:
                yield Value(t, topic, value)


def _value(rng: Random, offer: str, good: Any, k: int) -> Any:
    if offer == "array":
        return (
            rng.choice(([float("nan")], [], [FAR], [FAR])) if rng.random() < 0.1 else [USUAL[k % 5]]
        )
    if rng.random() < 0.78:
        return good
    others = {"flag": (not good,), "number": NUMBERS, "text": (*TEXTS, "cloudy")}[offer]
    return rng.choice((*others, *others, *others, *_STRANGE[offer]))


def _history(rng: Random, names: Sequence[str]) -> History:
    def moment() -> int:
        return rng.randrange(TICK, END, TICK)

    dead: list[tuple[str, int, int]] = []
    if rng.random() < 0.3:
        begin = moment()
        dead.append((rng.choice(names), begin, begin + moment()))
    restarts = [(moment(), rng.choice(names))] if rng.random() < 0.25 else []
    steps = [(moment(), rng.choice((-10_000, -700, 300, 60_000)))] if rng.random() < 0.15 else []
    latching = rng.random() < 0.5
    return History(END, (), tuple(dead), tuple(restarts), tuple(steps), latching=latching)


def _latched(
    rng: Random,
    instances: Sequence[Instance],
    offers: Mapping[str, str],
    values: Sequence[Value],
    history: History,
) -> Iterator[Value]:
    """Yield what latching sources give to a monitor that begins anew."""
    for instance in instances:
        for t in range(0, END + 1, TICK):
            if not history.latching or not history.begins(instance.name, t):
                continue
            for topic in sorted(set(instance.topics.values()) & offers.keys()):
                said = [one for one in values if one.topic == topic and one.t < t]
                if said and offers[topic] != "array" and rng.random() < 0.5:
                    yield Value(t, topic, said[-1].value, latched=True)


class Latched(Observer):
    """Lets latched messages count as new."""

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        return [replace(one, latched=False) for one in messages]


class Ageless(Observer):
    """Lets nothing get old: what came last comes again in every step."""

    def __init__(self) -> None:
        self._latest: dict[tuple[str, str], Received] = {}

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        self._latest.update(((member.name, one.source), one) for one in messages)
        new = {one.source for one in messages}
        again = [
            one
            for (name, source), one in self._latest.items()
            if name == member.name and source not in new
        ]
        return [*messages, *(replace(one, t=t * MS) for one in again)]

    def begun(self, member: Member) -> None:
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
