"""Faults in a recording: when guarantees are gone, compared with the computed bounds.

Monitors may begin at any time, and of those that step at one instant any may be the first: each
fault is played in several phases. In the first one every monitor steps just before the trouble
reaches it, so that the loss is as late as the bound, as far as the recording allows it.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise, product, takewhile
from typing import Any, NamedTuple

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.deployments.lifetimes import Effect, Times, times_of_claims
from eddi_scaffold.deployments.support import wired
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.recordings.csv_recording import Recording
from eddi_scaffold.recordings.faults import Fault, Injection, is_number, read_fault
from eddi_scaffold.recordings.members import Member, published
from eddi_scaffold.recordings.node import SECOND
from eddi_scaffold.recordings.playing import play, played

_EFFECTS: Mapping[str, Effect] = {
    "drop": "silence", "nan": "unknown", "delay": "value", "duplicate": "value"
}  # fmt: skip
"""Fault -> what bounds it; the others have no bound."""
_LONGEST_S = 5.0  # that a loss without any bound is waited for
_MOST_VALUES = 16  # of a topic in the recording that are tried, until a bad one
_ROUNDING = 1000  # nanoseconds
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29)


@dataclass(frozen=True)
class Row:
    """One guarantee and one fault of one topic."""

    monitor: str
    guarantee: str
    hazard: str | None  # that the guarantee keeps away, as the configuration has it
    fault: str  # with its value, as `delay 0.15 s`
    topic: str
    ftti_s: float
    reaction_s: float | None
    within_s: float  # seconds that are left of the ftti
    bound_s: float | None  # seconds after which the guarantee is gone; `None`: nothing bounds them
    phases: int  # in which the guarantee was active and the fault made a difference
    measured_s: float | None  # the longest time until it was gone; `None`: it was not in all
    accept: str | None  # why it may have no bound, or not be exercised

    @property
    def verdict(self) -> str:
        """``met``, ``missed``, ``no bound`` or ``not exercised``: the bound decides."""
        if self.bound_s is None:
            return "no bound"
        if self.bound_s > self.within_s:
            return "missed"
        return "met" if self.phases else "not exercised"

    @property
    def is_accepted(self) -> bool:
        """Whether a person has a reason for what is not met."""
        return self.accept is not None and self.verdict in ("no bound", "not exercised")

    def as_json(self) -> dict[str, JsonValue]:
        """Return a row of ``inject --json``."""
        return {**asdict(self), "verdict": self.verdict, "accepted": self.is_accepted}

    def cells(self) -> Sequence[str]:
        """Return what is printed of it."""
        measured = "never" if self.phases else "-"
        measured = measured if self.measured_s is None else f"{self.measured_s:.3f} s"
        bound = "none" if self.bound_s is None else f"{self.bound_s:.3f} s"
        verdict = "missed: no bound" if self.verdict == "no bound" else self.verdict
        verdict = f"{self.verdict}, accepted: {self.accept}" if self.is_accepted else verdict
        times = measured, bound, f"{self.within_s:.3f} s"
        return (self.guarantee, self.fault, self.topic, *times, verdict)


class _Target(NamedTuple):
    """A claim that is looked at."""

    monitor: str  # as it is played
    output: str
    claim: str  # its name among all


class _Trial(NamedTuple):
    """One run with a fault."""

    target: _Target
    injection: Injection
    offsets: Sequence[int]  # nanoseconds after which each monitor begins
    is_reversed: bool  # of those that step at one instant, listeners are before publishers
    patience: int  # nanoseconds for which a loss is waited for
    end: int  # when the claim is lost without a fault


class Injector:
    """Plays a recording of the topics of configured members, in some phases for each fault."""

    def __init__(self, members: Sequence[Member], recording: Recording, phases: int) -> None:
        self._members, self._recording, self._phases = members, recording, phases
        self._names = [member.name if len(members) > 1 else "" for member in members]
        self._wired = [wired(member.monitor, member.namespace) for member in members]
        self._times: dict[Effect, Mapping[str, Times]] = {
            effect: times_of_claims(self._wired, effect) for effect in _EFFECTS.values()
        }
        self._published = published(members)
        self._columns: dict[str, list[str]] = {}
        for member in members:
            for binding in member.monitor.inputs:
                for topic in member.topics(binding) if binding.model.id in member.columns else ():
                    column = member.columns[binding.model.id]
                    self._columns.setdefault(topic, []).append(column)
        self._periods = [round(SECOND / of.frequency) for of in self._wired]
        self._bad_values: dict[tuple[str, str], Mapping[str, Any]] = {}  # by claim and topic
        self._active: dict[str, list[tuple[int, bool]]] = {}  # claim -> as `run` shows it

    def rows(self, only: Container[str]) -> Iterator[Row]:
        """Yield the rows of all ``Reactions``, of these faults.

        Raises:
            RuntimeError: a bound is wrong.
            EddiError: a guarantee does not rest on a topic (K003).
        """
        for name, monitor in zip(self._names, self._wired, strict=True):
            for index, reaction in enumerate(monitor.config.config.Reactions):
                target = _Target(name, reaction.guarantee, monitor.claim(reaction.guarantee))
                nothing = _Trial(target, Injection(Fault("none"), [], 0, {}, 0), [], False, 0, 0)
                self._active[target.claim] = [*self._steps(nothing)]
                known = sorted(self._times["silence"][target.claim])
                for topic in (of for of in reaction.topics if of not in known):
                    names = {"guarantee": reaction.guarantee, "known": ", ".join(known)}
                    place = monitor.config.place("Reactions", index, "topics")
                    raise EddiError(problem("K003.no_topic", place, topic=topic, **names))
                head = monitor.name, reaction.guarantee, reaction.hazard
                times = reaction.ftti, reaction.reaction, round(reaction.within, 9)
                faults = [fault for fault in map(read_fault, reaction.faults) if fault.name in only]
                for fault, topic in product(faults, reaction.topics or known):
                    if self._applies(fault, topic):
                        bound_s, losses = self._measured(target, fault, topic)
                        bound, longest_s = round(bound_s, 9), max(losses, default=math.inf) / SECOND
                        yield Row(
                            *head, fault.text, topic, *times,
                            bound if math.isfinite(bound) else None, len(losses),
                            round(longest_s, 9) if math.isfinite(longest_s) else None,
                            reaction.accept,
                        )  # fmt: skip

    def _samples(self, topic: str) -> Mapping[str, Sequence[tuple[int, Any]]]:
        """Return time and message of what was recorded of a topic, by column."""
        names = self._columns.get(topic, [topic])
        samples = self._recording.samples
        return {name: [(s.t, s.message) for s in samples if s.topic == name] for name in names}

    def _applies(self, fault: Fault, topic: str) -> bool:
        if topic in self._published:  # a monitor publishes what it has to say, or nothing
            return fault.name == "drop"
        messages = [message for own in self._samples(topic).values() for _, message in own[:1]]
        return fault.name not in ("bias", "scale") or any(map(is_number, messages))

    def _stretch(self, target: _Target, needed: int) -> tuple[int, int]:
        """Return begin and end of the first time that a claim is active for long enough, or any."""
        stretches: list[tuple[int, int]] = []
        begin: int | None = None
        for t, active in [*self._active[target.claim], (self._recording.end, False)]:
            if active and begin is None:
                begin = t + sum(self._periods)  # in other phases it may be later, or end earlier
            elif not active and begin is not None:
                stretches.append((begin, t - sum(self._periods)))
                begin = None
        longest = max(stretches, key=lambda of: of[1] - of[0], default=(0, 0))
        return next((of for of in stretches if of[1] - of[0] >= needed), longest)

    def _measured(self, target: _Target, fault: Fault, topic: str) -> tuple[float, list[float]]:
        """Return the bound in seconds, and nanoseconds until the loss in the phases that count."""
        effect, samples = _EFFECTS.get(fault.name, "value"), self._samples(topic)
        times = sorted({t for own in samples.values() for t, _ in own})
        more_s = fault.value if fault.name == "delay" else 0.0
        if fault.name == "duplicate":
            more_s = max((b - a for a, b in pairwise(times)), default=0) / 2 / SECOND
        bound_s = self._times[effect][target.claim][topic][0] + more_s
        bound_s = bound_s if fault.name in _EFFECTS else math.inf
        silence_s = self._times["silence"][target.claim][topic][0]
        expected_s = next((s for s in (bound_s, silence_s) if math.isfinite(s)), _LONGEST_S)
        patience, longest = round(2 * expected_s * SECOND), max(self._periods)
        begin, end = stretch = self._stretch(target, patience + longest)
        bad: Mapping[str, Any] = {}
        if effect == "value" and not (bad := self._bad(target, topic, stretch, patience)):
            return bound_s, []
        losses: list[float] = []
        for phase in range(self._phases):
            # of van der Corput: they fill a period evenly, however many there are
            share = int(f"{phase:b}"[::-1], 2) / (1 << phase.bit_length())
            at = begin + round(share * longest)
            if topic not in self._published:
                at = next(iter(times[bisect_left(times, at) :]), end)
            onset = at if phase % 2 else self._recording.start
            injection = Injection(fault, [*samples], at, bad, onset)
            offsets = self._offsets(phase, effect, topic, at, more_s)
            trial = _Trial(target, injection, offsets, phase % 2 == 0, patience, end)
            loss = self._loss(trial)
            if loss is None:
                continue
            if loss > bound_s * SECOND + _ROUNDING:
                if self._holds_without(trial):
                    continue
                raise RuntimeError(
                    f"{target.claim} outlives {fault.text} of {topic} at {at / SECOND:g} s by "
                    f"{loss / SECOND:g} s, its bound is {bound_s:g} s; phase {phase} of {offsets}"
                )
            losses.append(loss)
        return bound_s, losses

    def _bad(
        self, target: _Target, topic: str, stretch: tuple[int, int], patience: int
    ) -> Mapping[str, Any]:
        """Return the messages of a topic before the claim was lost that alone end it."""
        key = target.claim, topic
        if key in self._bad_values:
            return self._bad_values[key]
        (at, end_of_stretch), tried = stretch, set[str]()
        samples, result = self._samples(topic), dict[str, Any]()
        times = sorted({t for own in samples.values() for t, _ in own}, reverse=True)
        ends = [b for (_, was), (b, now) in pairwise(self._active[target.claim]) if was and not now]
        for t in (t for end in ends for t in times if end - patience <= t <= end):
            bad = {of: message for of, own in samples.items() for u, message in own if u <= t}
            if repr(bad) in tried or len(tried) == _MOST_VALUES:
                continue
            tried.add(repr(bad))
            injection = Injection(Fault("value"), [*samples], at, bad, at)
            loss = self._loss(_Trial(target, injection, [], False, patience, end_of_stretch))
            if loss is not None and math.isfinite(loss):
                result = bad
                break
        self._bad_values[key] = result
        return result

    def _offsets(self, phase: int, effect: Effect, topic: str, at: int, more_s: float) -> list[int]:
        offsets = []
        for number, (monitor, period) in enumerate(zip(self._wired, self._periods, strict=True)):
            claims = (self._times[effect][monitor.claim(id_)] for id_ in monitor.claims)
            bounds = [of[topic][0] for of in claims if topic in of and math.isfinite(of[topic][0])]
            offset = round(phase * math.sqrt(_PRIMES[number % len(_PRIMES)]) % 1 * period)
            if phase == 0:  # where the bound has it lose; what is bad comes right behind a step
                lost = at + round((max(bounds, default=0.0) + more_s) * SECOND)
                offset = lost - (effect != "silence") - self._recording.start
            offsets.append(offset % period)
        return offsets

    def _steps(self, trial: _Trial) -> Iterator[tuple[int, bool]]:
        """Yield time of each step of a claim's monitor, and whether the claim is active."""
        offsets = dict(zip(self._names, trial.offsets, strict=False))
        monitors = [replace(of, offset=offsets.get(of.name, 0)) for of in played(self._members)]
        if trial.is_reversed:
            monitors.reverse()
        injection = trial.injection
        silent = dict.fromkeys(
            injection.topics if injection.fault.name == "drop" else (), injection.since
        )
        for monitor, step in play(monitors, injection.into(self._recording), silent):
            if monitor.name == trial.target.monitor:
                running, claim = monitor.running, trial.target.output
                # of a hazard, it is known to be absent
                holds = running.decided(step.output)[claim] is (claim not in running.hazards)
                yield round(step.t * SECOND), holds

    def _loss(self, trial: _Trial) -> float | None:
        """Return nanoseconds until a claim is lost; ``None`` where it was not active before.

        Nothing is known of what is lost, or not yet, when it is lost without a fault.
        """
        at, was_active = trial.injection.since, False
        for t, active in self._steps(trial):
            if t >= trial.end or (t >= at and not was_active):
                break
            if t - at > trial.patience:
                return math.inf
            if t >= at and not active:
                return t - at
            was_active = active
        return None

    def _holds_without(self, trial: _Trial) -> bool:
        """Return whether a claim is active although the topic never was as it should be."""
        begin, end = trial.injection.since, trial.injection.since + trial.patience
        always = trial._replace(injection=replace(trial.injection, since=-1, onset=-1))
        steps = takewhile(lambda step: step[0] <= end, self._steps(always))
        return any(active for t, active in steps if t >= begin)
