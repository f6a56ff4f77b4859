"""Who mends what the sentence names first brings the claim nearer: random robots and recordings."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from eddi_runtime.why import TRUE, ClaimWhy
from hypothesis import given, note
from hypothesis import strategies as st

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.node import SECOND, blank
from eddi_scaffold.recordings.playing import play, played
from tests.checkouts import HERE

PERIOD, END = SECOND // 10, 3 * SECOND
EXAMPLE = HERE / "examples" / "warehouse-robot"
MODELS = {
    document["Model"]["id"]: document["Model"]
    for document in yaml.safe_load_all((EXAMPLE / "robot.yml").read_text("utf-8"))
    if "Model" in document
}
THRESHOLDS = [
    ("localisation", "PoseIsGood", {"matched": "match", "slip": "slip"}),
    ("power", "LastsTheShift", {"battery_level": "level", "drives_available": "drives"}),
]


@dataclass(frozen=True)
class Kind:
    """What a topic carries."""

    type: str
    good: Any
    bad: Sequence[Any]  # known, but not good; or no value


KINDS = {
    "yes": Kind("std_msgs/Bool", True, [False]),
    "no": Kind("std_msgs/Bool", False, [True]),
    "far": Kind("std_msgs/Float32", 5.0, [1.0, math.nan, 99.0]),
    "sky": Kind("std_msgs/String", "clear", ["fog", "?"]),
    "match": Kind("std_msgs/Float32", 0.9, [0.1]),
    "slip": Kind("std_msgs/Float32", 0.01, [0.5]),
    "level": Kind("std_msgs/Float32", 90.0, [1.0, 150.0]),
    "drives": Kind("std_msgs/Int32", 4, [1]),
}
EVIDENCE: dict[str, Any] = {"far": "at least 2 m", "sky": ["clear", "cloudy"]}
NUMBER = ["{} > 2 m", "NOT ({} <= 2 m)", "AVERAGE({}, 0.5s) > 2 m", "HYSTERESIS({}, 1.5 m, 2 m)"]
TRUTH = ["{}", "TIME({}, 0.5s)", "NOT ONCE(NOT {}, 0.5s)", "ONCE({}, 0.5s)"]
GOOD = "good"
# Until which second a topic has good values, or from when on, and whether bad ones come otherwise.
PATTERNS: dict[str, tuple[float, float, bool]] = {
    GOOD: (0, math.inf, False),
    "never": (0, 0, False),
    "dies": (0, 1, False),
    "bad": (0, 0, True),
    "turns": (0, 2, True),
    "late": (2.8, math.inf, False),
}


@dataclass
class Robot:
    """Monitors that read topics and each other, as files; more good values never harm."""

    draw: Callable[..., Any]
    joints: Sequence[str]  # of formulas
    topics: dict[str, Kind] = field(default_factory=dict)
    claims: dict[str, str] = field(default_factory=dict)  # as `from:` reads it -> its monitor
    documents: list[dict[str, Any]] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)
    below: dict[str, set[str]] = field(default_factory=dict)  # monitor -> topics, through others

    def topic(self, name: str, kind: str) -> str:
        """Return the id of a topic of some kind, which may be read by others as well."""
        there = [id_ for id_ in self.topics if id_.startswith(kind)]
        id_ = self.draw(st.sampled_from([*there, f"{kind}{len(self.topics)}"]))
        self.topics[id_] = KINDS[kind]
        self.below[name].add(id_)
        return str(id_)

    def truth(self, name: str) -> str:
        """Return where a truth value comes from: a claim, a topic, or a condition."""
        if self.claims and self.draw(st.integers(0, 3)):
            claim = self.draw(st.sampled_from([*self.claims]))
            self.below[name] |= self.below[self.claims[claim]]
            return str(claim)
        kind = self.draw(st.sampled_from(["yes", "no", "far"]))
        id_ = self.topic(name, kind)
        if kind == "far":
            conditions = [f"{id_}.data > 2", f"NOT ONCE({id_}.data <= 2, 0.5 s)"]
            return str(self.draw(st.sampled_from(conditions)))
        return f"NOT {id_}.data" if kind == "no" else id_

    def formulas(self, atoms: Sequence[str]) -> list[str]:
        """Return one with all of these, and perhaps one with some."""
        some = self.draw(st.lists(st.sampled_from(atoms), unique=True))
        return [self.formula(names) for names in (atoms, some) if names]

    def formula(self, atoms: Sequence[str]) -> str:
        parts = [*self.draw(st.permutations(atoms))]
        while len(parts) > 1:
            size = self.draw(st.integers(2, len(parts)))
            joined = self.draw(st.sampled_from(self.joints)).join(parts[:size])
            parts = [*parts[size:], f"({joined})"]
        return parts[0]

    def add(self, name: str, model: dict[str, Any], inputs: dict[str, str]) -> None:
        entries = []
        for id_, of in inputs.items():
            entry: dict[str, Any] = {"id": id_, "from": of}
            entry |= {} if of in self.claims else {"max_age": 0.5}
            entries.append(entry | ({"unit": "m"} if of in self.topics and of[:3] == "far" else {}))
        frequency = self.draw(st.sampled_from([10, 5]))
        document = {"Model": {**model, "id": name, "frequency": frequency}, "EDDIInputs": entries}
        self.documents.append(document)

    def consert(self, name: str) -> None:
        evidence, inputs = {}, {}
        for k in range(self.draw(st.integers(1, 4))):
            kind = self.draw(st.sampled_from(["bool", "bool", "bool", *EVIDENCE]))
            evidence[f"E{k}"] = EVIDENCE.get(kind, kind)
            inputs[f"E{k}"] = self.topic(name, kind) if kind in EVIDENCE else self.truth(name)
        guarantees = {f"G{k}": text for k, text in enumerate(self.formulas([*evidence]))}
        self.files[f"{name}.yml"] = yaml.safe_dump({"evidence": evidence, "guarantees": guarantees})
        self.add(name, {"type": "ConSert", "model": f"{name}.yml"}, inputs)
        self.claims |= {f"{name}.{id_}": name for id_ in guarantees}

    def event(self, name: str) -> None:
        lines, atoms, inputs = [], [], {}
        for k in range(self.draw(st.integers(1, 3))):
            is_number = self.draw(st.booleans())
            type_ = "NUMBER UNIT m RANGE 0 .. 40" if is_number else "BOOL"
            lines.append(f"VAR v{k} : {type_}")
            inputs[f"v{k}"] = self.topic(name, "far") if is_number else self.truth(name)
            forms = NUMBER if is_number else TRUTH
            atoms.append(self.draw(st.sampled_from(forms)).format(f"v{k}"))
        for k, formula in enumerate(self.formulas(atoms)):
            hazard = self.draw(st.booleans())
            text = f"(HAZARD) := NOT {formula}" if hazard else f"(EVIDENCE) := {formula}"
            lines.append(f"EVENT e{k} {text}")
            self.claims[f"NOT {name}.e{k}" if hazard else f"{name}.e{k}"] = name
        self.files[f"{name}.events"] = "\n".join([*lines, ""])
        self.add(name, {"type": "Event", "model": f"{name}.events"}, inputs)

    def threshold(self, name: str) -> None:
        """Add a monitor of the example."""
        id_, claim, kinds = self.draw(st.sampled_from(THRESHOLDS))
        model = MODELS[id_]
        self.files[model["model"]] = (EXAMPLE / model["model"]).read_text("utf-8")
        self.add(name, model, {of: self.topic(name, kind) for of, kind in kinds.items()})
        self.claims[f"{name}.{claim}"] = name

    def members(self) -> list[Member]:
        topics = [
            {"id": id_, "type": of.type, "topic": f"/{id_}"} for id_, of in self.topics.items()
        ]
        robot = yaml.safe_dump_all([{"SimulatorOutputs": topics}, *self.documents])
        texts = {**self.files, "robot.yml": robot}
        with tempfile.TemporaryDirectory() as place:
            for name, text in texts.items():
                Path(place, name).write_text(text)
                note(f"--- {name}\n{text}")
            monitors, _ = monitors_of(None, [Path(place, "robot.yml")])
        return [Member(monitor) for monitor in monitors]


@st.composite
def robots(draw: Callable[..., Any]) -> Robot:
    robot = Robot(draw, draw(st.sampled_from([[" AND "], [" AND ", " OR "]])))
    for k in range(draw(st.integers(2, 6))):
        add = draw(st.sampled_from([robot.consert, robot.event, robot.threshold]))
        robot.below[f"m{k}"] = set()
        add(f"m{k}")
    return robot


def tape(topics: dict[str, Kind], patterns: dict[str, tuple[str, Any]]) -> Recording:
    samples = []
    times = range(0, END + 1, PERIOD)
    for t in times:
        for id_, (pattern, bad) in patterns.items():
            begin, end, comes = PATTERNS[pattern]
            is_good = begin * SECOND <= t < end * SECOND
            if is_good or comes:
                message = blank(topics[id_].type)
                message.data = topics[id_].good if is_good else bad
                samples.append(Sample(t, f"/{id_}", message))
    return Recording(0, END, tuple(samples), tuple(times))


@given(robots(), st.data())
def test_mending_the_first_reason_brings_the_claim_nearer(
    robot: Robot, data: st.DataObject
) -> None:
    members = robot.members()
    draw = lambda values: data.draw(st.sampled_from(values))  # noqa: E731
    patterns = {id_: (draw([*PATTERNS]), draw(of.bad)) for id_, of in robot.topics.items()}
    claim, name = draw([*robot.claims.items()][-3:])

    def told() -> ClaimWhy:
        for monitor, _ in play(played(members), tape(robot.topics, patterns)):
            if monitor.name in ("", name):
                why = monitor.running.why()[claim.rpartition(".")[2]]
        note(f"{patterns}: {why.sentence or 'holds'}")
        return why

    why, mended = told(), dict[str, tuple[str, Any]]()
    while why.verdict != TRUE:
        first = why.causes[0]
        named = {first.topic.lstrip("/")} if first.topic else robot.below[first.monitors[-1]]
        assert any(patterns[id_][0] != GOOD for id_ in named)
        mended |= {id_: patterns[id_] for id_ in named if first.topic}
        patterns |= dict.fromkeys(named, (GOOD, None))
        before, why = why, told()
        assert why.verdict >= before.verdict
        assert not named & {cause.topic.lstrip("/") for cause in why.causes}
    for id_ in mended if robot.joints == [" AND "] else ():  # each of them was needed
        patterns[id_] = mended[id_]
        assert told().verdict != TRUE
        patterns[id_] = GOOD, None
