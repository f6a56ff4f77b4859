"""Monitors that a random deployment can be made of: files whose topics are still open."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

NUMBERS = (10.0, 30.0, 50.0, 90.0)
"""One of each region: no threshold of a model lies anywhere but at 20, 40 and 60."""
TEXTS = ("clear", "fog")
FLAGS = (True, False)
VERDICTS = (0, 2)
CHANCES = (0.0, 1.0)

SOURCE_TYPES = {"flag": "Bool", "number": "Float64", "text": "String", "array": "Float64MultiArray"}
"""What a source offers -> its message of std_msgs."""

Fits = Callable[[Any], bool]


def _is_flag(value: Any) -> bool:
    return type(value) is bool


def _is_number(value: Any) -> bool:
    return type(value) is float and math.isfinite(value)


def _is_no_nan(value: Any) -> bool:
    return type(value) is float and not math.isnan(value)


def _is_text(value: Any) -> bool:
    return type(value) is str


def _is_whole(value: Any) -> bool:
    return type(value) is int


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


def _source(offer: str, name: str, leaf: Leaf, kind: str) -> Reading:
    return Reading(offer, f"std_msgs/{name}", (leaf,), kind, field="data")


def flag(path: str) -> Leaf:
    return Leaf(path, FLAGS, _is_flag)


def _always(path: str, value: Any) -> Leaf:
    """Return a leaf that has one value where everything is known."""
    return Leaf(path, (value,), lambda found: type(found) is type(value))


def _field(offer: str, message: str, path: str, *beside: Leaf) -> Reading:
    return Reading(offer, f"eddi_messages/{message}", (flag(path), *beside), field=path)


def _expression(
    offer: str, message: str, text: str, *leaves: Leaf, hazard: bool = False
) -> Reading:
    message_type = message if "/" in message else f"eddi_messages/{message}"
    return Reading(offer, message_type, leaves, expression=text, hazard=hazard)


_NUMBER = Leaf("data", NUMBERS, _is_number)
_VERDICT = Leaf("verdict", VERDICTS, _is_whole)

SOURCES: Mapping[str, Reading] = {
    "flag": _source("flag", "Bool", flag("data"), "bool"),
    "number": _source("number", "Float64", _NUMBER, "float"),
    "text": _source("text", "String", Leaf("data", TEXTS, _is_text), "str"),
    "size": _source("number", "Float64", Leaf("data", NUMBERS, _is_no_nan), "float"),
}
"""Fields that no monitor publishes; a ConSert compares infinity, to others it tells nothing."""

GOOD: Mapping[str, Reading] = {
    "guarantee": _field("guarantee", "ConSertOutput", "guarantees[G].active"),
    "verdict of guarantee": _expression(
        "status", "ConSertStatus", "{s}.guarantees[0].verdict == 2",
        Leaf("guarantees[0].verdict", VERDICTS, _is_whole),
    ),
    "guarantee is false": _expression(
        "status", "ConSertStatus", "{s}.guarantees[0].verdict == 0",
        Leaf("guarantees[0].verdict", VERDICTS, _is_whole),
    ),
    "evidence": _field("evidence", "EventOutput", "active", _VERDICT),
    "verdict of evidence": _expression("evidence", "EventOutput", "{s}.verdict == 2", _VERDICT),
    "evidence is false": _expression("evidence", "EventOutput", "{s}.verdict == 0", _VERDICT),
    "no hazard": _expression("hazard", "EventOutput", "NOT {s}.active", flag("active"), _VERDICT),
    "hazard is false": _expression("hazard", "EventOutput", "{s}.verdict == 0", _VERDICT),
    "hazard is true": _expression("hazard", "EventOutput", "{s}.verdict == 2", _VERDICT),
    "fit": _field(
        "reliability", "ReliabilityOutput", "evidence[Fit].active", _always("reason", "")
    ),
    "number of fit": _expression(
        "reliability", "ReliabilityOutput", "{s}.valid AND {s}.p_fail < 0.15",
        _always("valid", True), Leaf("p_fail", CHANCES, _is_number),
    ),
    "scope": _field("scope", "SafeMLStatus", "in_scope", _always("omission", False)),
    "verdict of scope": _expression(
        "verdict", "SafeMLOutput", "NOT {s}.omission AND NOT {s}.odd_violation",
        _always("omission", False), flag("odd_violation"),
    ),
    "violation": _expression(
        "verdict", "SafeMLOutput", "NOT {s}.omission AND {s}.odd_violation",
        _always("omission", False), flag("odd_violation"),
    ),
    "threshold": _field(
        "threshold", "BayesianNetworkEvidence", "evidence[Low].active",
        _always("evidence[Low].reason", ""),
    ),
}  # fmt: skip
"""True only when something good is known."""

AGAINST: Mapping[str, Reading] = {
    "no guarantee": _expression(
        "guarantee", "ConSertOutput", "NOT {s}.guarantees[0].active", flag("guarantees[0].active")
    ),
    "no evidence": _expression(
        "evidence", "EventOutput", "NOT {s}.active", flag("active"), _VERDICT
    ),
    "hazard": _field("hazard", "EventOutput", "active", _VERDICT),
}
"""False only when something good is known."""

INVERTED: Mapping[str, Reading] = {
    "negated evidence": AGAINST["no evidence"],
    "hazard as evidence": AGAINST["hazard"],
}
"""Evidence of a ConSert that `check` refuses where it has the publisher; silence gives none."""

BAD: Mapping[str, Reading] = {
    "raw posterior": Reading(
        "posterior", "eddi_messages/BayesianNetworkOutput",
        (Leaf("output_nodes[0].outcomes[0].outcome_value", CHANCES, _is_number),),
        "float", field="output_nodes[0].outcomes[0].outcome_value", covers=0.3,
    ),
    "hazard of an expression": _expression(
        "number", "std_msgs/Float64", "{s}.data < 40", _NUMBER, hazard=True
    ),
    "violation alone": _expression(
        "verdict", "SafeMLOutput", "NOT {s}.odd_violation", flag("odd_violation")
    ),
    "bound alone": _expression(
        "reliability", "ReliabilityOutput", "{s}.p_fail_low < 0.15",
        Leaf("p_fail_low", CHANCES, _is_number),
    ),
    "value alone": _expression("alone", "std_msgs/Bool", "NOT {s}.data", flag("data")),
}  # fmt: skip
"""True also when nothing is known, taken as evidence of a ConSert."""


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
