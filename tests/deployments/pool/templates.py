"""Monitors that a random deployment can be made of: files whose topics are still open."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

NUMBERS = (10.0, 30.0, 50.0, 90.0)
"""One of each region: no threshold of a model lies anywhere but at 20, 40 and 60."""
TEXTS = ("clear", "fog")
SOURCE_TYPES = {"flag": "Bool", "number": "Float64", "text": "String", "array": "Float64MultiArray"}
"""What a source offers -> its message of std_msgs."""

Fits = Callable[[Any], bool]


@dataclass(frozen=True)
class Leaf:
    path: str  # to the field
    # values that it may have while it is unknown; the unfavourable ones may come first or last
    domain: tuple[Any, ...]
    fits: Fits  # whether a value counts as known


@dataclass(frozen=True)
class Reading:
    """What an input takes from one message."""

    offer: str  # what the publisher must offer: `guarantee`, `hazard`, or a source's `flag`
    message_type: str  # of the topic
    # the fields that it depends on, with those that say that these are known
    leaves: tuple[Leaf, ...]
    type: str = "bool"  # of the input
    field: str | None = None  # path, where one field is taken as it is
    expression: str | None = None  # else, with `{s}` for the id of the message
    hazard: bool = False  # the expression has `polarity: HAZARD`
    covers: float = 40.0  # the greatest number that is evidence of a ConSert


_LEAVES: Mapping[str, tuple[tuple[Any, ...], Fits]] = {
    "flag": ((True, False), lambda value: type(value) is bool),
    "verdict": ((0, 2), lambda value: type(value) is int),
    "chance": ((0.0, 1.0), lambda value: type(value) is float and math.isfinite(value)),
    "number": (NUMBERS, lambda value: type(value) is float and math.isfinite(value)),
    "size": (NUMBERS, lambda value: type(value) is float and not math.isnan(value)),
    "text": (TEXTS, lambda value: type(value) is str),
}
"""Kind of a leaf -> the values that it may have while it is unknown, and which count as known."""


def _leaf(path: str, kind: str | Mapping[str, Any]) -> Leaf:
    if isinstance(kind, str):
        return Leaf(path, *_LEAVES[kind])
    value = kind["always"]  # where everything is known
    return Leaf(path, (value,), lambda found: type(found) is type(value))


def _readings(group: str) -> Mapping[str, Reading]:
    rows = yaml.load(Path(__file__).with_name("readings.yml").read_text("utf-8"), yaml.CSafeLoader)
    return {
        name: Reading(**{**row, "leaves": tuple(_leaf(*leaf) for leaf in row["leaves"].items())})
        for name, row in rows[group].items()
    }


SOURCES, GOOD, AGAINST = _readings("sources"), _readings("good"), _readings("against")
INVERTED: Mapping[str, Reading] = {
    "negated evidence": AGAINST["no evidence"],
    "hazard as evidence": AGAINST["hazard"],
}
"""Evidence of a ConSert that `check` refuses where it has the publisher; silence gives none."""
BAD = _readings("bad")


OUT = "out"
"""What the topic is called on which a monitor of the pool publishes."""

Rank = Callable[[Any], int]


@dataclass(frozen=True)
class Slot:
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
        return self.limit is None or self.accepts_default or self.accepts_unknown


@dataclass(frozen=True, eq=False)
class Template:
    name: str
    kind: str
    files: Mapping[str, str]  # name -> text; `<name>_config.yml` is the configuration
    slots: tuple[Slot, ...]
    offers: Mapping[str, str]  # what it publishes -> what stands behind the name of its topic
    every: int = 500  # its period in milliseconds
    fault: str = ""  # which sort of unsound reading is in it, empty for none

    @property
    def accepts(self) -> bool:
        return any(slot.accepts for slot in self.slots)

    @property
    def listens(self) -> bool:
        return any(slot.reading.offer not in SOURCE_TYPES for slot in self.slots)


@dataclass
class Config:
    name: str
    type: str
    parameter: tuple[str, str]
    every: int = 500
    model: dict[str, Any] = field(default_factory=dict)
    inputs: list[dict[str, Any]] = field(default_factory=list)
    sources: list[dict[str, Any]] = field(default_factory=list)
    alone: list[dict[str, Any]] = field(default_factory=list)

    def source(self, slot: Slot) -> None:
        message = slot.reading.message_type.replace("/", ".")
        self.sources.append({"id": slot.source, "type": message, "topic": slot.source})

    def input(self, name: str, slot: Slot, **more: Any) -> None:
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
    return yaml.dump(document, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


def with_topics(template: Template, topics: Mapping[str, str]) -> Mapping[str, str]:
    """Return the files of a template with the real topics of a deployment."""
    config = yaml.load(template.files[f"{template.name}_config.yml"], yaml.CSafeLoader)
    rows: Sequence[dict[str, Any]] = [*config["SimulatorOutputs"], *config["EDDIOutputs"]]
    for row in rows:
        first, _, rest = row["topic"].partition("/")
        row["topic"] = f"{topics[first]}/{rest}".rstrip("/")
    return {**template.files, f"{template.name}_config.yml": dump(config)}
