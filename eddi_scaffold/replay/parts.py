"""Monitors made ready to be played: the same model text and the same runtime as in a package."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.compiling.document import parse_model
from eddi_scaffold.compiling.execution import build
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding, by_value
from eddi_scaffold.replay.node import SECOND, GivenInput, ReplayedNode
from eddi_scaffold.replay.playing import Part
from eddi_scaffold.replay.publishing import Publications
from eddi_scaffold.replay.steps import ROWS, Rhythm, rhythm_of

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


def compiled(monitor: BoundMonitor) -> RuntimeMonitor[Any]:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    files = monitor.kind.functions.data_files(monitor.model)
    made: RuntimeMonitor[Any] = build(parse_model(monitor.model_json, monitor.model.name, files))
    return made


def rhythm(monitor: BoundMonitor) -> Rhythm:
    """Return how the node of a monitor steps; without a configuration, for each row."""
    if monitor.config is None:
        return ROWS
    section = monitor.config.config.Model
    return rhythm_of(section.frequency, section.mode)


def published(monitors: Sequence[BoundMonitor]) -> frozenset[str]:
    """Return the topics that monitors publish which are played together; of one alone, none."""
    if len(monitors) < 2:
        return frozenset()
    return frozenset(topic for one in monitors for topic in Publications(one, one.topic).topics)


Made = tuple["RuntimeMonitor[Any]", ReplayedNode]
"""A monitor that runs, and a node of it."""


def of_values(monitor: BoundMonitor, rhythm: Rhythm, made: Made | None = None) -> Part:
    """Return a monitor whose inputs are given their values themselves.

    Args:
        monitor: what to run.
        rhythm: how it steps.
        made: by its package; without, what the package would be without hand-written lines.
    """
    bindings = [by_value(one) for one in monitor.inputs]
    topics = {one.model.id: [one.model.id] for one in bindings}
    return _part("", bindings, rhythm, topics, made or _made(monitor, bindings))


def of_messages(
    monitors: Sequence[BoundMonitor], rhythms: Sequence[Rhythm], made: Made | None = None
) -> list[Part]:
    """Return monitors that listen to topics, also to those of each other, in the order of steps.

    Args:
        monitors: what to run; they have configurations.
        rhythms: how each steps.
        made: by the package of the only one.
    """
    several = len(monitors) > 1
    parts = {}
    for monitor, one in zip(monitors, rhythms, strict=True):
        assert monitor.config is not None
        name = monitor.config.config.Model.id
        sources = {source.id: source for b in monitor.inputs for source in b.requires}
        topics: dict[str, list[str]] = {}
        for source in sources.values():
            topics.setdefault(monitor.topic(source.topic), []).append(source.id)
        publisher = Publications(monitor, monitor.topic) if several else None
        parts[name] = _part(
            name if several else "",
            monitor.inputs,
            one,
            topics,
            made or _made(monitor, monitor.inputs),
            publisher,
        )
    return _in_order(list(parts.values()))


def _made(monitor: BoundMonitor, bindings: Sequence[InputBinding]) -> Made:
    running = compiled(monitor)
    return running, ReplayedNode(GivenInput(bindings), running)


def _part(
    name: str,
    bindings: Sequence[InputBinding],
    rhythm: Rhythm,
    topics: Mapping[str, Sequence[str]],
    made: Made,
    publisher: Publications | None = None,
) -> Part:
    limits: dict[str, set[int]] = {}
    for binding in bindings:
        if isinstance(binding.max_age, int | float):
            for source in binding.requires:
                limits.setdefault(source.id, set()).add(round(binding.max_age * SECOND))
    return Part(name, *made, rhythm, topics, limits, publisher)


def _in_order(parts: Sequence[Part]) -> list[Part]:
    """Return publishers before those who listen to them, as far as no two listen to each other."""
    ordered: list[Part] = []
    begun: set[str] = set()

    def visit(part: Part) -> None:
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
