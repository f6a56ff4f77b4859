"""Deployments as files: models, configurations, and what happens, in the form of the oracle."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.node import Message, blank
from tests.data_files import write_files
from tests.deployments.world import Deployment, History, Member, Publisher, Sample, resolved


@dataclass(frozen=True)
class Case:
    # what the file says, beside the models and configurations that were written out
    content: Mapping[str, Any]
    folder: Path  # where these are

    @property
    def files(self) -> list[Path]:
        """Everything that ``check`` can be given."""
        return [self.folder / name for name in self.content["files"] if not name.endswith(".csv")]


def read_case(text: str, folder: Path) -> Case:
    content = yaml.load(text, yaml.CSafeLoader)
    return Case(content, write_files(folder, content["files"]))


def deployment_of(case: Case) -> Deployment:
    """Return the deployment of a case, its monitors joined by the product."""
    rows = case.content["monitors"]
    bound = {row["config"]: _bound(case.folder / row["config"]) for row in rows}
    members = tuple(_member(row, bound[row["config"]]) for row in rows)
    types = {
        member.topics[source.id]: source.type
        for member in members
        for binding in member.monitor.inputs
        for source in binding.requires
    }
    return Deployment(members, _history(case.content, types), min(m.every for m in members))


def _bound(config: Path) -> BoundMonitor:
    (monitor,), _ = monitors_of(None, [config])
    return monitor


def _member(row: Mapping[str, Any], monitor: BoundMonitor) -> Member:
    space = row.get("namespace", "")
    sources = {one.id: one for binding in monitor.inputs for one in binding.requires}
    topics = {name: resolved(one.topic, space) for name, one in sources.items()}
    publisher = Publisher(monitor, {}, space)
    delay = _ms(row.get("delay", 0))
    return Member(row["name"], monitor, topics, publisher, _ms(row["every"]), delay)


def _history(content: Mapping[str, Any], types: Mapping[str, str]) -> History:
    samples = [_sample(row, types) for row in content["samples"]]
    return History(
        _ms(content["until"]),
        tuple(samples),
        tuple((who, _ms(begin), _ms(end)) for who, begin, end in content.get("dead", ())),
        tuple((_ms(t), who) for t, who in content.get("restarts", ())),
        tuple((_ms(t), _ms(by)) for t, by in content.get("clock", ())),
        latching=content.get("latching", False),
    )


def _sample(row: Sequence[Any], types: Mapping[str, str]) -> Sample:
    t, topic, value, *flags = row
    return Sample(_ms(t), topic, data_message(types[topic], value), "latched" in flags)


def data_message(message_type: str, value: Any) -> Message:
    message = blank(message_type)
    message.data = value
    return message


def _ms(seconds: float) -> int:
    assert math.isfinite(seconds)
    return round(seconds * 1000)
