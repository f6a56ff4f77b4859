"""Deployments of monitors of the pool, in a form that can be drawn, told, and made smaller."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

from eddi_runtime import Monitor as RunningMonitor

from tests.deployments.cases import data_message
from tests.deployments.pool.stock import bound, compiled_once
from tests.deployments.pool.templates import OUT, SOURCE_TYPES, Template
from tests.deployments.world import Deployment, History, Member, Publisher, Sample

TICK = 500
END = 4500


@dataclass(frozen=True)
class Instance:
    name: str
    template: Template
    topics: Mapping[str, str]  # id of each simulator output -> topic
    out: str  # where it publishes
    delay: int = 0


class Value(NamedTuple):
    t: int
    topic: str
    value: Any
    latched: bool = False


@dataclass(frozen=True)
class Draft:
    instances: tuple[Instance, ...]  # in the order in which they step
    offers: Mapping[str, str]  # topic of a source -> what it offers
    values: tuple[Value, ...]
    history: History

    @property
    def accepts(self) -> bool:
        return any(instance.template.accepts for instance in self.instances)


def deployment_of(draft: Draft) -> Deployment:
    members = tuple(member_of(instance) for instance in draft.instances)
    samples = tuple(
        Sample(one.t, one.topic, _message(draft.offers[one.topic], one.value), one.latched)
        for one in draft.values
    )
    return Deployment(members, replace(draft.history, samples=samples), TICK)


def running_of(draft: Draft) -> Mapping[str, RunningMonitor]:
    """Return a compiled monitor for each instance, the same for every run of a deployment."""
    seen: Counter[Template] = Counter()
    found = {}
    for instance in draft.instances:
        found[instance.name] = compiled_once(instance.template, seen[instance.template])
        seen[instance.template] += 1
    return found


@cache
def _publisher(template: Template, topic: str) -> Publisher:
    return Publisher(bound(template), {OUT: topic})


def member_of(instance: Instance) -> Member:
    monitor = bound(instance.template)
    publisher = _publisher(instance.template, instance.out)
    every = instance.template.every
    return Member(instance.name, monitor, instance.topics, publisher, every, instance.delay)


def _message(offer: str, value: Any) -> Any:
    return data_message(f"std_msgs/{SOURCE_TYPES[offer]}", value)
