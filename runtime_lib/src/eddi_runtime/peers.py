"""Guarantees of other robots: whose word counts, and for how long.

Each node of a fleet tells its word after every step: its guarantees, a number, a lease, and the
last number it heard of each listener. By that echo a listener bounds the age of a word with its
own clock: it was made after the echoed one was told, whatever the clocks of the robots say. A
guarantee names the monitors on whose words it rests, and none of these relies on it: in a circle
they would keep each other's guarantees active long after the evidence is gone.
"""

from __future__ import annotations

import math
import os
from collections import deque
from typing import Any, Iterable, Mapping, NamedTuple, Sequence, Tuple

from .inputs import Word
from .monitor import Tree
from .node.topics import Input, Receipt

_WORDS = "~peers"  # id of the subscription to all words; none of a configuration is like it
LONGEST_LEASE = 60.0
"""Seconds: a node that was silent for longer is forgotten, and so is when a word was told."""
_MOST_TOLD = 10_000  # own words of which it is remembered when they were told
_MOST = 1_000
"""Nodes that are remembered, and that a word may rest on: no sender can fill memory or network."""

Name = Tuple[str, str, str]  # robot, model and session of a node; a restart begins a new session


class Source(NamedTuple):
    """A ``SimulatorOutputs`` entry that is the word of some other robot."""

    id: str  # of the entry
    # whose word counts, the first of equals first; empty: that of any other robot
    robots: tuple[str, ...]
    model: str  # id of the ConSert that must have given it
    digest: str  # SHA-256 of that ConSert's data
    guarantee: str  # id of the guarantee that is wanted, as it is published


class Fleet(NamedTuple):
    """The ``Fleet`` section of eddi_config.yml."""

    robot: str  # name of this robot; the parameter ``robot`` wins
    topic: str  # of all words
    type: Any  # message class ``RobotGuarantees`` of the transport
    lease: float  # seconds after which a word counts as unknown, those told and those heard
    sources: tuple[Source, ...] = ()  # what of the words of others is wanted

    def words(self) -> Input:
        """Return the subscription to all words; it does not wake, or two nodes would for ever."""
        return Input(_WORDS, self.topic, self.type, every_message=True, wakes=False)

    def joined(self, robot: str, model_id: str, digest: str) -> Peers:
        """Return the words of a node of this fleet, and those it hears."""
        name = (robot or self.robot, model_id, os.urandom(8).hex())
        return Peers(name, digest, self.lease, self.sources)


class Found(NamedTuple):
    """The word that counts for a source."""

    word: Word  # whose it is, and why it is not fresh
    # the message; received when it cannot have been made before; ``None``: none came
    receipt: Receipt | None = None


class _Speaker(NamedTuple):
    """What was heard of one node."""

    message: Any  # its last word
    made_after: float  # seconds of this node's clock, ``-inf`` while it echoes nothing
    heard_at: float  # seconds of this node's clock
    received: int  # words so far


class Peers:
    """What one node tells the others, and what it has heard of them."""

    def __init__(self, name: Name, digest: str, lease: float, sources: Sequence[Source]) -> None:
        self.name = name
        self._digest = digest
        self._lease = lease
        self._sources = tuple(sources)
        self._number = 0
        self._told: deque[tuple[int, float]] = deque(maxlen=_MOST_TOLD)
        self._speakers: dict[Name, _Speaker] = {}
        self._behind: dict[str, frozenset[str]] = {}

    def take(
        self, receipts: dict[str, Receipt], new: dict[str, list[object]], now: float
    ) -> Mapping[str, Word]:
        """Put the words that count in place of all that came; return whose they are."""
        for message in new.pop(_WORDS, ()):
            self.hear(message, now)
        receipts.pop(_WORDS, None)
        entries = self.find(now).items()
        receipts.update((name, entry.receipt) for name, entry in entries if entry.receipt)
        return {name: entry.word for name, entry in entries}

    def told(self, message: object, monitor: Any, now: float) -> Tree:
        """Return the word about a message that was published, as ``word`` does."""
        rows = getattr(message, "guarantees", ())
        by = [monitor.robots(row.id) if row.active else () for row in rows]
        return self.word([(row.id, row.active, robots) for row, robots in zip(rows, by)], now)

    def word(self, guarantees: Iterable[tuple[str, bool, Iterable[str]]], now: float) -> Tree:
        """Return the next word: for each guarantee id, whether it is active, robots behind it."""
        self._number += 1
        self._told.append((self._number, now))
        while now - self._told[0][1] > LONGEST_LEASE:
            self._told.popleft()
        robot, model, session = self.name
        told: list[Tree] = []
        for id_, active, robots in guarantees:
            # the monitors behind the words of the robots
            behind = sorted({monitor for name in robots for monitor in self._behind.get(name, ())})
            told.append(("RobotGuarantee", {"id": id_, "active": active, "rests_on": behind}))
        speakers = self._speakers.items()
        heard = [
            ("Heard", dict(zip(_HEARD, (*name, speaker.message.sequence))))
            for name, speaker in speakers
            if speaker.message.listens and now - speaker.heard_at <= self._lease
        ]
        own = {"robot": robot, "model_id": model, "model_digest": self._digest, "session": session}
        more = {"sequence": self._number, "lease": self._lease, "listens": bool(self._sources)}
        return "RobotGuarantees", {**own, **more, "guarantees": told, "heard": heard}

    def hear(self, message: Any, now: float) -> None:
        """Take a word over, of whatever age and in whatever order it comes."""
        name = (str(message.robot), str(message.model_id), str(message.session))
        if name == self.name:
            return
        before = self._speakers.get(name)
        if before is not None and message.sequence <= before.message.sequence:
            return
        self._speakers.pop(name, None)  # the dictionary is in order of hearing
        made_after, received = self._echoed(message), 1
        if before is not None:  # a later word was made later
            made_after, received = max(made_after, before.made_after), before.received + 1
        self._speakers[name] = _Speaker(message, made_after, now, received)
        for oldest, speaker in [*self._speakers.items()]:
            if len(self._speakers) <= _MOST and speaker.heard_at >= now - LONGEST_LEASE:
                break
            del self._speakers[oldest]

    def _echoed(self, message: Any) -> float:
        """Return when the word that a message echoes was told, ``-inf`` for none of ours."""
        for echo in message.heard:
            if (echo.robot, echo.model_id, echo.session) == self.name:
                first = self._told[0][0] if self._told else self._number + 1
                place = echo.sequence - first
                return self._told[place][1] if 0 <= place < len(self._told) else -math.inf
        return -math.inf

    def find(self, now: float) -> Mapping[str, Found]:
        """Return the word that counts for each source: one that grants it, then the freshest."""
        self._behind = {}
        nodes: dict[tuple[str, str], list[_Speaker]] = {}
        for (robot, model, _), speaker in self._speakers.items():
            nodes.setdefault((robot, model), []).append(speaker)
        return {source.id: self._find(source, nodes, now) for source in self._sources}

    def _find(
        self, source: Source, nodes: Mapping[tuple[str, str], Sequence[_Speaker]], now: float
    ) -> Found:
        order = {robot: place for place, robot in enumerate(source.robots)}
        candidates: list[tuple[tuple[Any, ...], Found]] = []
        for (robot, model), sessions in nodes.items():
            if model != source.model or (robot not in order if order else robot == self.name[0]):
                continue
            for session in sessions:
                why = self._unfit(source, session, sessions, now)
                granted = not why and _of(session.message, source.guarantee)[0].active is True
                freshest = -session.made_after if why else 0.0  # of good ones always the same
                place = (order.get(robot, 0), freshest, robot, session.message.session)
                receipt = Receipt(session.message, max(session.made_after, 0.0), session.received)
                known = session.made_after > -math.inf
                age, limit = now - session.made_after, min(self._lease, session.message.lease)
                word = Word(robot, why, age, limit) if why and known else Word(robot, why)
                candidate = Found(word, receipt if known else None)
                candidates.append(((not granted, bool(why), *place), candidate))
        if not candidates:
            robot = source.robots[0] if len(source.robots) == 1 else ""
            return Found(Word(robot, f"no word of {source.model} on {_robots(source)} was heard"))
        _, candidate = min(candidates)
        if not candidate.word.unfit and candidate.receipt is not None:  # these stand behind it
            message: Any = candidate.receipt.message
            robot, rests_on = message.robot, _of(message, source.guarantee)[0].rests_on
            behind = {f"{robot}/{message.model_id}", *rests_on}
            self._behind[robot] = self._behind.get(robot, frozenset()) | behind
        return candidate

    def _unfit(
        self, source: Source, speaker: _Speaker, sessions: Sequence[_Speaker], now: float
    ) -> str:
        """Return why the word of a node does not count, empty when it does."""
        message, age = speaker.message, now - speaker.made_after
        robot, told = message.robot, _of(message, source.guarantee)
        limit = min(self._lease, message.lease)
        if message.model_digest != source.digest:
            digest = str(message.model_digest)[:12]
            expected = f"{source.digest[:12]} is expected"
            return f"{robot} has another {source.model}: its digest is {digest}, {expected}"
        if len(told) != 1:
            times = "twice" if told else "not"
            return f"{robot} has the guarantee {source.guarantee} {times} in its word"
        if "/".join(self.name[:2]) in told[0].rests_on:
            return f"the word of {robot} rests on this monitor itself"
        if len(told[0].rests_on) > _MOST:
            return f"the word of {robot} rests on more than {_MOST} monitors"
        if age == math.inf:
            return f"{robot} is heard, but has not answered this robot yet"
        if not (age <= self._lease and age <= message.lease):  # a lease may be no number
            return f"the word of {robot} may be {age:.3g} s old, its lease is {limit:g} s"
        if sum(now - other.made_after <= limit for other in sessions) > 1:
            return f"two nodes call themselves {robot}"
        return ""


_HEARD = ("robot", "model_id", "session", "sequence")


def _of(message: Any, guarantee: str) -> list[Any]:
    """Return a guarantee in a word, as often as it is there."""
    return [row for row in message.guarantees if row.id == guarantee]


def _robots(source: Source) -> str:
    return " or ".join(source.robots) or "any other robot"
