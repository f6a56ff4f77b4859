"""Monitors made ready to be played: the same model text and the same runtime as in a package."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding, by_value
from eddi_scaffold.recordings.csv_recording import Tape
from eddi_scaffold.recordings.messages import Publications
from eddi_scaffold.recordings.node import SECOND, GivenInput, ReplayedNode
from eddi_scaffold.recordings.playing import ROWS, PlayedMonitor, StepRule, rhythm_of

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor

    from eddi_scaffold.kinds import InputType


def compiled(monitor: BoundMonitor) -> RuntimeMonitor[Any]:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    made: RuntimeMonitor[Any] = monitor.compiled.monitor(monitor.model.name)
    return made


def rhythm(monitor: BoundMonitor) -> StepRule:
    """Return how the node of a monitor steps; without a configuration, for each row."""
    if monitor.config is None:
        return ROWS
    section = monitor.config.config.Model
    return rhythm_of(section.frequency, section.mode)


def published(monitors: Sequence[BoundMonitor]) -> frozenset[str]:
    """Return the topics that monitors publish which are played together; of one alone, none."""
    if len(monitors) < 2:
        return frozenset()
    return frozenset(
        topic for monitor in monitors for topic in Publications(monitor, monitor.topic).topics
    )


Made = tuple["RuntimeMonitor[Any]", ReplayedNode]
"""A monitor that runs, and a node of it."""


def columns(monitors: Sequence[BoundMonitor]) -> dict[str, InputType]:
    """Return input -> type of those whose values a recording has: what no other monitor publishes.

    Raises:
        EddiError: inputs of one name are not the same in two monitors (G000).
    """
    shared = published(monitors)
    owners: dict[str, tuple[str, object]] = {}
    found: dict[str, InputType] = {}
    for monitor in monitors:
        for input_ in monitor.inputs:
            if _is_received(input_, monitor, shared):
                continue
            id_ = input_.model.id
            topics = [monitor.topic(source.topic) for source in input_.requires]
            meaning = (
                input_.model.type,
                input_.unit,
                input_.expression,
                input_.computed_text,
                topics,
            )
            first, same = owners.setdefault(id_, (monitor.id, meaning))
            if same != meaning:
                raise EddiError(problem("G000.one_column", id=id_, first=first, monitor=monitor.id))
            found[id_] = input_.model.type
    return found


_WHOLE = {"fraction": 1.0, "percent": 100.0, "pct": 100.0}
"""Unit -> what all of something is in it; a ratio without a name may be more."""


def beyond_whole(monitors: Sequence[BoundMonitor], tape: Tape, file: str) -> Iterator[Problem]:
    """Warn of inputs that are more than all of what they are a part of (I006)."""
    units = {input_.model.id: input_.unit for monitor in monitors for input_ in monitor.inputs}
    told = set()
    for sample in tape.samples:
        unit = units.get(sample.topic)
        most = _WHOLE.get(unit or "", math.inf)
        if sample.topic in told or not isinstance(sample.message, int | float):
            continue
        if sample.message > most:
            told.add(sample.topic)
            message = f"{sample.topic!r} is {sample.message:g} {unit} at {sample.t / SECOND:.3f} s"
            yield problem("I006.more_than_all", Place(file), message=message, most=most, unit=unit)


def _is_received(binding: InputBinding, monitor: BoundMonitor, shared: Collection[str]) -> bool:
    topics = [monitor.topic(source.topic) for source in binding.requires]
    return bool(topics) and binding.is_given and all(topic in shared for topic in topics)


def of_values(
    monitors: Sequence[BoundMonitor], rhythms: Sequence[StepRule], made: Made | None = None
) -> list[PlayedMonitor]:
    """Return monitors that are given their ``columns``, and listen to each other.

    Args:
        monitors: what to run; several have configurations.
        rhythms: how each steps.
        made: by the package of the only one; without, what the package would be without
            hand-written lines.
    """
    shared = published(monitors)
    inputs = [
        [
            input_ if _is_received(input_, monitor, shared) else by_value(input_)
            for input_ in monitor.inputs
        ]
        for monitor in monitors
    ]
    return _joined(monitors, inputs, rhythms, made)


def of_messages(
    monitors: Sequence[BoundMonitor], rhythms: Sequence[StepRule], made: Made | None = None
) -> list[PlayedMonitor]:
    """Return monitors that listen to topics, also to those of each other, in the order of steps.

    Args:
        monitors: what to run; they have configurations.
        rhythms: how each steps.
        made: by the package of the only one.
    """
    return _joined(monitors, [monitor.inputs for monitor in monitors], rhythms, made)


def _joined(
    monitors: Sequence[BoundMonitor],
    inputs: Sequence[Sequence[InputBinding]],
    rhythms: Sequence[StepRule],
    made: Made | None,
) -> list[PlayedMonitor]:
    several = len(monitors) > 1
    parts = []
    for monitor, bindings, rhythm in zip(monitors, inputs, rhythms, strict=True):
        topics: dict[str, list[str]] = {}
        for source in {source.id: source for b in bindings for source in b.requires}.values():
            # a column has no message
            name = monitor.topic(source.topic) if source.type else source.id
            topics.setdefault(name, []).append(source.id)
        name = monitor.config.config.Model.id if several and monitor.config is not None else ""
        publisher = Publications(monitor, monitor.topic) if several else None
        running = made or _made(monitor, bindings)
        parts.append(_part(name, bindings, rhythm, topics, running, publisher))
    return _in_order(parts)


def _made(monitor: BoundMonitor, bindings: Sequence[InputBinding]) -> Made:
    running = compiled(monitor)
    return running, ReplayedNode(GivenInput(bindings), running)


def _part(
    name: str,
    bindings: Sequence[InputBinding],
    rhythm: StepRule,
    topics: Mapping[str, Sequence[str]],
    made: Made,
    publisher: Publications | None = None,
) -> PlayedMonitor:
    limits: dict[str, set[int]] = {}
    for binding in bindings:
        if isinstance(binding.max_age, int | float):
            for source in binding.requires:
                limits.setdefault(source.id, set()).add(round(binding.max_age * SECOND))
    return PlayedMonitor(name, *made, rhythm, topics, limits, publisher)


def _in_order(parts: Sequence[PlayedMonitor]) -> list[PlayedMonitor]:
    """Return publishers before those who listen to them, as far as no two listen to each other."""
    ordered: list[PlayedMonitor] = []
    begun: set[str] = set()

    def visit(part: PlayedMonitor) -> None:
        if part.name in begun:
            return
        begun.add(part.name)
        for other in parts:
            if other.publisher is not None and other.publisher.topics & part.sources.keys():
                visit(other)
        ordered.append(part)

    for part in parts:
        visit(part)
    return ordered
