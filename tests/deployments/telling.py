"""A draft as a file in the form of the oracle: to be read by a person, and to be played again."""

from collections.abc import Mapping
from typing import Any

from tests.deployments.drafts import Draft, Instance
from tests.deployments.pool.templates import OUT, dump, with_topics


def text_of(draft: Draft, name: str, about: str) -> str:
    """Return a draft with all its files, as a case of the oracle without its wants."""
    history = draft.history
    read = {topic for instance in draft.instances for topic in instance.topics.values()}
    files: dict[str, str] = {}
    for instance in draft.instances:
        files.update(_files(instance))
    document: dict[str, Any] = {
        "id": name,
        "about": about,
        "files": files,
        "monitors": [_row(instance) for instance in draft.instances],
        "until": history.until / 1000,
        "latching": history.latching,
        "dead": [[who, begin / 1000, end / 1000] for who, begin, end in history.dead],
        "restarts": [[t / 1000, who] for t, who in history.restarts],
        "clock": [[t / 1000, by / 1000] for t, by in history.clock],
        "samples": [
            [one.t / 1000, one.topic, one.value, *(["latched"] if one.latched else [])]
            for one in draft.values
            if one.topic in read
        ],
    }
    return dump(document)


def _files(instance: Instance) -> Mapping[str, str]:
    template = instance.template
    files = dict(with_topics(template, {**instance.topics, OUT: instance.out}))
    config = files.pop(f"{template.name}_config.yml")
    return {**files, f"{instance.name}_config.yml": config}


def _row(instance: Instance) -> dict[str, Any]:
    every, delay = instance.template.every / 1000, instance.delay / 1000
    row = {"name": instance.name, "config": f"{instance.name}_config.yml", "every": every}
    return {**row, "delay": delay} if delay else row
