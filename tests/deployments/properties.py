"""What must hold of every deployment, whatever happens to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from random import Random
from typing import Any

from eddi_scaffold.config.field_paths import Attribute, ByKey, FieldPath, Index, Step, parse_field
from eddi_scaffold.config.field_types import element
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.recordings.node import Message, Received, blank
from tests.deployments.drafts import END, TICK, Draft, Instance, deployment_of, running_of
from tests.deployments.pool.templates import SOURCE_TYPES, Leaf, Rank, Slot
from tests.deployments.world import MS, Claims, Deployment, Member, Observer, World


@cache
def path_of(text: str) -> FieldPath:
    return parse_field(text)


def read(message: Any, path: FieldPath) -> Any:
    """Return the value at the end of a path, None where it leads nowhere."""
    try:
        for step in path:
            message = _element(message, step)
    except (AttributeError, LookupError):
        return None
    return message


def _element(value: Any, step: Step) -> Any:
    if isinstance(step, Attribute):
        return getattr(value, step.name)
    if isinstance(step, Index):
        return value[step.position]
    assert isinstance(step, ByKey)
    key = step.field or "id"
    return [one for one in value if getattr(one, key) == step.key][0]  # noqa: RUF015 - a LookupError


def written(message: Message, path: FieldPath, value: Any) -> Message:
    """Return a copy of a message with another value at the end of a path.

    Elements that a list on the way does not have are made.
    """
    return _replaced(message, message.message_type, path, value)


def _replaced(here: Any, kind: str, path: FieldPath, value: Any) -> Any:
    if not path:
        return value
    step, *rest = path
    if isinstance(step, Attribute):
        inner = known_messages()[kind][step.name]
        changed = _replaced(getattr(here, step.name), inner, tuple(rest), value)
        return Message(**{**vars(here), step.name: changed})
    one = element(kind)
    assert one is not None, "a list is expected"
    items = list(here)
    number = _number(items, one, step)
    items[number] = _replaced(items[number], one, tuple(rest), value)
    return items


def _number(items: list[Any], kind: str, step: Step) -> int:
    """Return which element a step means; what the list lacks is appended."""
    if isinstance(step, Index):
        items.extend(blank(kind) for _ in range(len(items), step.position + 1))
        return step.position
    assert isinstance(step, ByKey)
    key = step.field or "id"
    found = [number for number, one in enumerate(items) if getattr(one, key) == step.key]
    if not found:
        items.append(Message(**{**vars(blank(kind)), key: step.key}))
    return found[0] if found else len(items) - 1


UNKNOWN = 1
"""The verdict of an event that is not known."""

Draw = Callable[[str, str, int, Sequence[Any]], Any]
"""Topic, path, time, domain -> a value."""


class ImpossibleError(Exception):
    """What was drawn contradicts what is known later: no such history."""


def draws(rng: Random, number: int) -> Draw:
    """Return the n-th way to draw: all first values, all last ones, steady ones, any."""
    seen: dict[tuple[str, str, int], Any] = {}
    steady = number % 4 == 2

    def draw(topic: str, path: str, t: int, domain: Sequence[Any]) -> Any:
        key = (topic, path, 0 if steady else t)
        if key not in seen:
            value = rng.choice(domain)
            seen[key] = domain[-(number % 4)] if number % 4 < 2 else value
        return seen[key]

    return draw


def is_known(slot: Slot, leaf: Leaf, got: Received | None, t: int) -> bool:
    """Tell whether a leaf has a value in a step: received, young enough, and a value at all."""
    if slot.accepts_unknown:
        return True
    if got is None:
        return slot.accepts_default
    if slot.limit is not None and (got.latched or t * MS - got.t > slot.limit * 1e9):
        return False
    return leaf.fits(read(got.message, path_of(leaf.path)))


class Completion(Observer):
    """Fills in what is not known.

    Attributes:
        drawn: how many leaves had no value of their own so far.
    """

    def __init__(self, draft: Draft, draw: Draw) -> None:
        self.drawn = 0
        self._draw = draw
        self._instances: Mapping[str, Instance] = {one.name: one for one in draft.instances}
        self._latest: dict[str, dict[str, Received]] = {}
        self._gone: dict[tuple[str, str], int] = {}
        self._said: dict[str, list[tuple[int, Any]]] = {}
        for one in draft.values:
            self._said.setdefault(one.topic, []).append((one.t, one.value))

    def begun(self, member: Member) -> None:
        self._latest[member.name] = {}
        self._gone = {key: rank for key, rank in self._gone.items() if key[0] != member.name}

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        latest = self._latest[member.name]
        latest.update((one.source, one) for one in messages)
        instance = self._instances[member.name]
        filled = [
            self._filled(instance, slot, latest.get(slot.source), t)
            for slot in instance.template.slots
        ]
        return [*messages, *(one for one in filled if one is not None)]

    def _filled(
        self, instance: Instance, slot: Slot, got: Received | None, t: int
    ) -> Received | None:
        unknown = [leaf for leaf in slot.reading.leaves if not is_known(slot, leaf, got, t)]
        if not unknown:
            self._look_back(instance, slot, got)
            return None
        message = blank(slot.reading.message_type) if got is None else got.message
        for leaf in unknown:
            value = self._draw(instance.topics[slot.source], leaf.path, t, leaf.domain)
            if slot.rank is not None and leaf is slot.reading.leaves[0]:
                value = self._possible(instance, slot, slot.rank, t, value)
            message = written(message, path_of(leaf.path), value)
            self.drawn += 1
        return Received(t * MS, slot.source, message)

    def _possible(self, instance: Instance, slot: Slot, rank: Rank, t: int, value: Any) -> Any:
        """Return what was drawn, or a value that can become what the source says later."""
        leaf = slot.reading.leaves[0]
        said = self._said.get(instance.topics[slot.source], ())
        later = min((rank(v) for at, v in said if at > t and leaf.fits(v)), default=rank(value))
        if rank(value) > later:
            value = next(one for one in leaf.domain if rank(one) <= later)
        key = (instance.name, slot.source)
        self._gone[key] = max(self._gone.get(key, 0), rank(value))
        return value

    def _look_back(self, instance: Instance, slot: Slot, got: Received | None) -> None:
        """Drop the history in which something is as good as it cannot have become again.

        What a monitor tells is known here, and may not be in what really happened.
        """
        if slot.rank is None or got is None or getattr(got.message, "verdict", 0) == UNKNOWN:
            return
        key = (instance.name, slot.source)
        rank = slot.rank(read(got.message, path_of(slot.reading.leaves[0].path)))
        if rank < self._gone.get(key, 0):
            raise ImpossibleError
        if slot.reading.offer not in SOURCE_TYPES:
            self._gone[key] = rank

    def published(
        self, member: Member, t: int, messages: Sequence[tuple[str, Message]]
    ) -> Sequence[tuple[str, Message]]:
        if member.monitor.kind.name != "safeml":
            return messages
        omitted = any(getattr(message, "omission", False) for _, message in messages)
        if not omitted:
            return messages
        self.drawn += 1
        odd = self._draw(member.name, "verdict", t, (True, False))
        return [(topic, _judged(message, odd)) for topic, message in messages]


def _judged(message: Message, odd: bool) -> Message:
    changed = Message(**vars(message))
    changed.omission, changed.odd_violation = False, odd
    if hasattr(message, "in_scope"):
        changed.in_scope = not odd
    return changed


class Silence(Observer):
    """Nothing is known of some topics from a time on, and what was received counts as old."""

    def __init__(self, topics: frozenset[str], since: int) -> None:
        self._topics = topics
        self._since = since
        self._latest: dict[tuple[str, str], Received] = {}

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        if t < self._since:
            self._latest.update(((member.name, one.source), one) for one in messages)
            return messages
        silent = {source for source, topic in member.topics.items() if topic in self._topics}
        left = [one for one in messages if one.source not in silent]
        return [
            *left,
            *(self._old(member, source) for source in silent if self._has(member, source)),
        ]

    def _has(self, member: Member, source: str) -> bool:
        return (member.name, source) in self._latest

    def _old(self, member: Member, source: str) -> Received:
        last = self._latest[member.name, source]
        message = last.message
        if message.message_type == "std_msgs/Float64MultiArray":
            message = Message(**{**vars(message), "data": [float("nan")]})
        return replace(last, t=-(10**15), message=message)

    def begun(self, member: Member) -> None:
        self._latest = {key: one for key, one in self._latest.items() if key[0] != member.name}


COMPLETIONS = 5
"""Completions that are played of one deployment."""
_WINDOW = 2000
"""Milliseconds: longer than any window of an event."""


@dataclass(frozen=True)
class Violation:
    rule: str
    t: int
    output: str

    def __str__(self) -> str:
        return f"{self.output} at {self.t / 1000} s: {self.rule}"


Steps = Mapping[int, Claims]


@dataclass
class Check:
    draft: Draft
    rng: Random
    # makes the observer of the real world, for a fault that lies in no wiring
    faulty: Callable[[], Observer] = Observer
    worlds: int = COMPLETIONS  # how many completions to play
    compared: int = 0  # claims that hold although something is not known

    def __post_init__(self) -> None:
        self._deployment = deployment_of(self.draft)
        self._running = running_of(self.draft)

    def violation(self) -> Violation | None:
        real = dict(self._run(self._deployment, self.faulty()))
        checks = [self._sound]
        if not self.draft.accepts:
            checks += [self._monotone, self._gone] if self.rng.random() < 0.1 else [self._monotone]
        return next((one for check in checks for one in check(real)), None)

    def _run(self, deployment: Deployment, observer: Observer) -> Iterator[tuple[int, Claims]]:
        return World(deployment, observer, self._running).run()

    def _sound(self, real: Steps) -> Iterator[Violation]:
        """A claim holds in every history that what was received may be completed to."""
        relevant = _relevant(self._deployment, real)
        if relevant is None:
            return
        for number in range(self.worlds):
            completion = Completion(self.draft, draws(self.rng, number))
            try:
                for t, claims in self._run(relevant, completion):
                    yield from self._unsound(real[t], claims, t, number, completion.drawn)
            except ImpossibleError:
                continue
            if not completion.drawn:
                return  # everything was known

    def _unsound(
        self, real: Claims, claims: Claims, t: int, number: int, drawn: int
    ) -> Iterator[Violation]:
        for output, active in real.items():
            if active and output in claims:
                self.compared += drawn > 0
                if not claims[output]:
                    yield Violation(f"not so in completion {number}", t, output)

    def _monotone(self, real: Steps) -> Iterator[Violation]:
        """Nothing is claimed because less is known."""
        topics = sorted(self._deployment.subscribers)
        everything = self.rng.random() < 0.2
        silent = frozenset(topics if everything else [self.rng.choice(topics)])
        since = self.rng.choice((0, self.rng.randrange(0, END, TICK)))
        for t, claims in self._run(self._deployment, Silence(silent, since)):
            for output, active in claims.items():
                if active and not real[t][output]:
                    what = "everything" if everything else ", ".join(sorted(silent))
                    yield Violation(f"because {what} is silent from {since / 1000} s on", t, output)

    def _gone(self, real: Steps) -> Iterator[Violation]:
        """Nothing outlives its sources but what needs none."""
        history = self._deployment.history
        until = history.until + 2 * TICK + _longest_way(self._deployment.members)
        longer = replace(self._deployment, history=replace(history, until=until))
        after = dict(self._run(longer, self.faulty()))
        nothing = Silence(self._deployment.sources, 0)
        ever = dict(self._run(longer, nothing))
        for t in sorted(after)[-2:]:
            for output, active in after[t].items():
                if active and not ever[t][output]:
                    yield Violation("long after all sources fell silent", t, output)


def _relevant(deployment: Deployment, real: Steps) -> Deployment | None:
    """Return what a claim rests on, up to the last one; None when there is none at all."""
    last = max((t for t, claims in real.items() if any(claims.values())), default=None)
    if last is None:
        return None
    names = {output.partition(".")[0] for c in real.values() for output, on in c.items() if on}
    while True:
        topics = {
            topic for m in deployment.members if m.name in names for topic in m.topics.values()
        }
        more = {m.name for m in deployment.members if m.publisher.topics & topics}
        if more <= names:
            break
        names |= more
    members = tuple(member for member in deployment.members if member.name in names)
    return replace(deployment, members=members, history=replace(deployment.history, until=last))


def _longest_way(members: tuple[Member, ...]) -> int:
    """Return how long a change may travel, on the longest way that passes each monitor once."""

    def behind(member: Member, passed: frozenset[str]) -> int:
        own = _lasts(member)
        ways = [
            behind(other, passed | {member.name})
            for other in members
            if other.name not in passed and member.publisher.topics & set(other.topics.values())
        ]
        return own + max(ways, default=0)

    return max(behind(member, frozenset({member.name})) for member in members)


def _lasts(member: Member) -> int:
    ages = [one.max_age for one in member.monitor.inputs if isinstance(one.max_age, float)]
    return round(1000 * max(ages, default=2.0)) + 2 * member.every + member.delay + _WINDOW
