"""Monitors that a random deployment can be made of: files whose topics are still open."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

from tests.deployments.pool.readings import SOURCE_TYPES, Reading

OUT = "out"
"""What the topic is called on which a monitor of the pool publishes."""

Rank = Callable[[Any], int]


@dataclass(frozen=True)
class Slot:
    """One message that a monitor reads."""

    source: str  # id of the simulator output; its topic is called so, too
    reading: Reading
    limit: float | None  # seconds after which its leaves are unknown, `None`: never, on purpose
    accepts_default: bool = False  # what is not there yet has a default, on purpose
    accepts_unknown: bool = False  # a key of the model accepts that nothing is known
    # how far gone a value is, where nothing that is further gone comes back; `None` where it may
    rank: Rank | None = None
    good: Any = None  # value of a source with which something is claimed, as a rule

    @property
    def accepts(self) -> bool:
        """Whether a key of its own accepts less than the property."""
        return self.limit is None or self.accepts_default or self.accepts_unknown


@dataclass(frozen=True, eq=False)
class Template:
    """One model with its configuration."""

    name: str
    kind: str
    files: Mapping[str, str]  # name -> text; `<name>_config.yml` is the configuration
    slots: tuple[Slot, ...]
    offers: Mapping[str, str]  # what it publishes -> what stands behind the name of its topic
    every: int = 500  # its period in milliseconds
    fault: str = ""  # which sort of unsound reading is in it, empty for none

    @property
    def accepts(self) -> bool:
        """Whether the configuration accepts less than the property, by a key of its own."""
        return any(slot.accepts for slot in self.slots)

    @property
    def listens(self) -> bool:
        """Whether it reads what another monitor publishes."""
        return any(slot.reading.offer not in SOURCE_TYPES for slot in self.slots)


@dataclass
class Config:
    """Collects what a configuration says."""

    name: str
    type: str
    parameter: tuple[str, str]
    every: int = 500
    model: dict[str, Any] = field(default_factory=dict)
    inputs: list[dict[str, Any]] = field(default_factory=list)
    sources: list[dict[str, Any]] = field(default_factory=list)
    alone: list[dict[str, Any]] = field(default_factory=list)

    def source(self, slot: Slot) -> None:
        """Declare the message of a slot."""
        message = slot.reading.message_type.replace("/", ".")
        self.sources.append({"id": slot.source, "type": message, "topic": slot.source})

    def input(self, name: str, slot: Slot, **more: Any) -> None:
        """Declare an input that reads a slot as a whole."""
        reading = slot.reading
        row: dict[str, Any] = {"id": name, "type": reading.type}
        if reading.expression is not None:
            row["expression"] = reading.expression.format(s=slot.source)
        else:
            row.update(requires=[slot.source], field=reading.field)
        if reading.hazard:
            row["polarity"] = "HAZARD"
        row["max_age"] = "none" if slot.limit is None else slot.limit
        self.inputs.append({**row, **more})
        self.source(slot)

    def text(self) -> str:
        """Return the configuration as YAML."""
        key, file = self.parameter
        head = {"id": self.name, "type": self.type, "frequency": 1000 / self.every}
        document = {
            "Model": {**head, "parameters": [{key: file}], **self.model},
            "SimulatorOutputs": self.sources,
            "EDDIInputs": self.inputs,
            "EDDIOutputs": [{"id": f"{self.name}_out", "topic": OUT}, *self.alone],
        }
        return dump(document)


class _Dumper(yaml.CSafeDumper):
    """Writes texts of several lines as they are."""


def _text(dumper: yaml.CSafeDumper, text: str) -> yaml.Node:
    style = "|" if "\n" in text else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _text)


def dump(document: Mapping[str, Any]) -> str:
    """Return plain data as YAML, in the order in which it was made."""
    return yaml.dump(document, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


def with_topics(template: Template, topics: Mapping[str, str]) -> Mapping[str, str]:
    """Return the files of a template with the real topics of a deployment."""
    config = yaml.load(template.files[f"{template.name}_config.yml"], yaml.CSafeLoader)
    rows: Sequence[dict[str, Any]] = [*config["SimulatorOutputs"], *config["EDDIOutputs"]]
    for row in rows:
        first, _, rest = row["topic"].partition("/")
        row["topic"] = f"{topics[first]}/{rest}".rstrip("/")
    return {**template.files, f"{template.name}_config.yml": dump(config)}
