"""The monitors of the pool, joined by the product once, compiled as often as they are needed."""

import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from eddi_runtime import Monitor as RunningMonitor

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from tests.data_files import write_files
from tests.deployments.pool.conserts import conserts, ring, unsound_conserts
from tests.deployments.pool.events import events, unsound_events
from tests.deployments.pool.machines import machines
from tests.deployments.pool.networks import bare_network, networks, scopes
from tests.deployments.pool.reliabilities import reliabilities
from tests.deployments.pool.templates import GOOD, SOURCE_TYPES, Template


@cache
def sound() -> Mapping[str, Sequence[Template]]:
    """Return the templates that `check` accepts, by kind."""
    made = [*conserts(60), *events(), *reliabilities(24), *scopes(), *networks(30)]
    made += machines(24)
    there = {*SOURCE_TYPES, *(offer for one in made for offer in one.offers)}
    found = [one for one in made if all(slot.reading.offer in there for slot in one.slots)]
    names = dict.fromkeys(template.kind for template in found)
    return {name: tuple(one for one in found if one.kind == name) for name in names}


@cache
def doubting() -> Sequence[Template]:
    """Return the sound templates that rest on what is known to be false, or to be a hazard."""
    doubted = [GOOD[one] for one in ("guarantee is false", "evidence is false", "hazard is true")]
    pool = (one for group in sound().values() for one in group)
    return [one for one in pool if any(slot.reading in doubted for slot in one.slots)]


@cache
def unsound() -> Mapping[str, Template]:
    """Return, by fault, a template that claims something because nothing is known."""
    return {one.fault: one for one in (*unsound_conserts(), *unsound_events())}


@cache
def rings() -> Sequence[Template]:
    return tuple(ring())


@cache
def offering(offer: str) -> Sequence[Template]:
    pool = [*(one for group in sound().values() for one in group), bare_network()]
    return [one for one in pool if offer in one.offers]


@cache
def bound(template: Template) -> BoundMonitor:
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder), template.files)
        (monitor,), _ = monitors_of(None, [Path(folder) / f"{template.name}_config.yml"])
    return monitor


@cache
def compiled_once(template: Template, number: int) -> RunningMonitor:
    """Return the running monitor for the n-th of a template's monitors in a deployment."""
    return compiled(bound(template))
