"""What must hold of every deployment, whatever happens to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from random import Random

from tests.deployments.completions import Completion, ImpossibleError, Silence, draws
from tests.deployments.drafts import END, TICK, Draft, deployment_of, running_of
from tests.deployments.world import Claims, Deployment, Member, Observer, World

COMPLETIONS = 5
"""Completions that are played of one deployment."""
_WINDOW = 2000
"""Milliseconds: longer than any window of an event."""


@dataclass(frozen=True)
class Violation:
    """A claim that should not be there."""

    rule: str
    t: int
    output: str

    def __str__(self) -> str:
        return f"{self.output} at {self.t / 1000} s: {self.rule}"


Steps = Mapping[int, Claims]


@dataclass
class Check:
    """The looks at one deployment."""

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
        """Return the first claim that is wrong, if there is one."""
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
