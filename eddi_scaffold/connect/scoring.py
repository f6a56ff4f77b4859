"""How well a value of a topic fits an input, in points with their reasons."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common import units
from eddi_scaffold.connect.name_words import MEANS_THE_SAME, words
from eddi_scaffold.connect.needs import InputNeed
from eddi_scaffold.connect.topics import FieldUse, RobotTopic, TopicField, access, units_of

TELLING = 14
"""From so many points on, the message alone explains the words of its row."""


@dataclass(frozen=True)
class Prior:
    """One row.

    Attributes:
        words: an input that has one of them.
        dimensions: what it measures; ``bool`` for one that is true or false.
        points: message -> points.
    """

    words: frozenset[str]
    dimensions: frozenset[str]
    points: dict[str, int]


def _row(words: str, dimensions: str, points: str) -> Prior:
    pairs = (one.rpartition(" ") for one in points.split(", "))
    return Prior(
        frozenset(words.split()),
        frozenset(dimensions.split(", ")),
        {name: int(number) for name, _, number in pairs},
    )


_CELSIUS = "temperature in Celsius, temperature in Kelvin"
_TABLE = (
    _row(
        "obstacle distance clearance range proximity scan nearest closest",
        "length",
        "LaserScan 20, Range 20, MultiEchoLaserScan 15",
    ),
    _row(
        "speed velocity drive",
        "speed",
        "Odometry 20, TwistWithCovarianceStamped 18, TwistStamped 14, VFR_HUD 14, Twist 6",
    ),
    _row("yaw rate turn angular", "angular rate", "Odometry 20, Imu 20, TwistStamped 12, Twist 6"),
    _row("acceleration tilt shock", "acceleration", "Imu 20"),
    _row("gps altitude latitude longitude height", "length, angle", "NavSatFix 20"),
    _row("battery charge soc capacity level", "ratio, charge, voltage, current", "BatteryState 20"),
    _row("temperature temp", _CELSIUS, "Temperature 20, BatteryState 6"),
    _row("humidity", "ratio", "RelativeHumidity 20"),
    _row("pressure", "pressure", "FluidPressure 20"),
    _row(
        "uncertainty covariance deviation localization accuracy",
        "length, angle",
        "PoseWithCovarianceStamped 20, Odometry 12",
    ),
    _row(
        "joint torque effort",
        "angle, torque, force, angular rate",
        "JointState 20, JointTrajectoryControllerState 10",
    ),
    _row("health healthy ok diagnostics", "bool", "DiagnosticArray 20, DiagnosticStatus 20"),
    _row("detected detection person pedestrian", "bool", "Detection2DArray 20"),
)


def prior(need: InputNeed, topic: RobotTopic, leaf: TopicField) -> tuple[int, frozenset[str]]:
    """Return the points of the best row that applies, and its words."""
    found = [
        (row.points[topic.message], row.words)
        for row in _TABLE
        if topic.message in row.points
        and not row.words.isdisjoint(need.words)
        and _is_of(row.dimensions, need, leaf)
    ]
    return max(found, key=lambda one: one[0], default=(0, frozenset()))


def _is_of(dimensions: frozenset[str], need: InputNeed, leaf: TopicField) -> bool:
    """Return whether input and value, as far as their units are known, measure what a row does."""
    if need.type == "bool" or "bool" in dimensions:
        return need.type == "bool" and "bool" in dimensions
    if leaf.is_variance:
        return True
    wanted = (need.unit,) if need.unit else ()
    return all(
        any(units.find(one) is None or units.dimension(one) in dimensions for one in some)
        for some in (wanted, leaf.units or ())
        if some
    )


_NAME = 50
_COMMANDS = frozenset(("cmd", "command", "setpoint", "goal", "target", "desired", "reference"))
_COMMANDED = frozenset([
    "Twist", "TwistStamped", "PoseStamped", "Float32", "Float64", "Float64MultiArray",
    "AckermannDriveStamped",
])  # fmt: skip
_SIDES = tuple(
    frozenset(group.split())
    for group in ("front rear left right", "base torso head arm", "up down")
)
_BAD_WHEN_TRUE = frozenset([
    "lost", "fault", "error", "fail", "failed", "failure", "loss", "missing", "invalid",
    "standby", "stop",
])  # fmt: skip
_AXES: Mapping[str, Sequence[tuple[str, frozenset[str]]]] = {
    "linear": (
        ("z", frozenset(("climb", "vertical", "descent", "sink"))),
        ("y", frozenset(("lateral", "sideways"))),
    ),
    "angular": (("x", frozenset(("roll",))), ("y", frozenset(("pitch",)))),
}
ALARM = "true may be bad"
"""Part of a candidate that may be true where the input is false; it is never taken."""
_USUAL_AXIS = {"linear": "x", "angular": "z"}


@dataclass(frozen=True)
class Candidate:
    """A value of a topic that might fill an input.

    Attributes:
        parts: what the score is made of: name, unit, prior, type, and what counts against it.
        reasons: the same in words, for a comment.
    """

    topic: RobotTopic
    leaf: TopicField
    access: FieldUse
    parts: Mapping[str, int]
    reasons: Sequence[str] = field(default=())

    @property
    def score(self) -> int:
        """All points together."""
        return sum(self.parts.values())


def unsaid(need: InputNeed, topic: RobotTopic, leaf: TopicField) -> list[str]:
    """Return the words of an input without which a value may be something else.

    Of a number, those that no name of it has: a temperature need not be that of the
    motor. Of a flag among other fields, all, where the field has none of them: any flag of a
    battery would say that there is power.
    """
    inside = words(leaf.text)
    if leaf.type == "bool":
        is_said = leaf.is_only or any(need.fit(word, inside) for word in need.words)
        return [] if is_said else list(need.words)
    near = (*topic.words, *inside, *words(topic.message))
    usual, explained = prior(need, topic, leaf)
    known = {*(explained if usual >= TELLING else ()), *_axis_words(leaf)}
    return [word for word in need.words if word not in known and not need.fit(word, near)]


def _doubt(leaf: TopicField, missing: Sequence[str]) -> str:
    if leaf.type == "bool" and missing:
        return f"{leaf.text} may be another flag"
    return f"nothing says {' or '.join(missing)}" if missing else ""


def weights(need: InputNeed, topics: Collection[RobotTopic]) -> Callable[[str], float]:
    """Return how much a word of an input tells among some topics: less, where many match it."""
    count = len(topics)

    def weight(word: str) -> float:
        if count <= 1:
            return 1.0
        matching = sum(1 for topic in topics if need.fit(word, topic.words) >= MEANS_THE_SAME)
        return 0.3 + math.log((count + 1) / (matching + 1)) / math.log(count + 1)

    found = {word: weight(word) for word in (*need.words, *need.described, *need.told)}
    return found.__getitem__


def scored(
    need: InputNeed, topic: RobotTopic, leaf: TopicField, weight: Callable[[str], float]
) -> Candidate:
    """Return a value of a topic as a candidate."""
    usual, explained = prior(need, topic, leaf)
    name, matched = _name(need, topic, leaf, explained if usual >= TELLING else (), weight)
    taken = access(need, topic, leaf)
    unit, in_unit = _unit(need, leaf)
    form, of_type = _type(need, leaf, taken)
    against = _against(need, topic, leaf)
    parts = {"name": round(name), "unit": unit, "prior": usual, "type": form, **against}
    reasons = [
        *([f"{' and '.join(matched)} in the name"] if matched else []),
        *([f"usual for {topic.message}"] if usual >= TELLING else []),
        in_unit,
        of_type,
        *(word for word in against if word != "rest"),
        _doubt(leaf, unsaid(need, topic, leaf)),
    ]
    return Candidate(topic, leaf, taken, parts, [reason for reason in reasons if reason])


def _name(
    need: InputNeed,
    topic: RobotTopic,
    leaf: TopicField,
    explained: Collection[str],
    weight: Callable[[str], float],
) -> tuple[float, list[str]]:
    """Return the points of the names, and the words that match."""
    near, inside, message = topic.words, words(leaf.text), words(topic.message)

    def fit(word: str) -> float:
        return max(
            need.fit(word, near),
            0.9 * need.fit(word, inside),
            0.7 * need.fit(word, message),
            0.6 if word in explained else 0.0,
        )

    def mean(some: Sequence[str]) -> float:
        whole = sum(weight(word) for word in some)
        return sum(weight(word) * fit(word) for word in some) / whole if whole else 0.0

    own = mean(need.words)
    both = max(own, 0.6 * own + 0.4 * mean(need.described)) if need.described else own
    both = max(both, mean(need.told))
    return _NAME * both, [word for word in need.words if need.fit(word, near) > 0]


def _unit(need: InputNeed, leaf: TopicField) -> tuple[int, str]:
    given = units_of(leaf)
    if need.type not in ("float", "int") or not need.unit or not given:
        return 8, ""
    if len(given) > 1:
        return 14, f"{' or '.join(given)}, {need.unit} in the model"
    if units.factor(given[0], need.unit) == 1:
        return 20, f"{need.unit} as in the model"
    return 18, f"{given[0]}, converted to {need.unit}"


def _type(need: InputNeed, leaf: TopicField, taken: FieldUse) -> tuple[int, str]:
    if not leaf.path:
        return 0, "the fields of the message are not known"
    if need.type == "bool" and leaf.type != "bool":
        return 3, "a number, to be compared"
    if leaf.lists and not need.type.endswith("[]"):
        return (
            6,
            "the least of its list, a tenth of which may be missing"
            if taken.is_complete
            else "an element of a list",
        )
    if leaf.is_only:
        return 10, "the only field of its message"
    return (10, "") if leaf.type == "bool" else (8, "")


def _against(need: InputNeed, topic: RobotTopic, leaf: TopicField) -> dict[str, int]:
    """Return what counts against a candidate, by its name."""
    told = set(topic.words)
    asked = {*need.words, *need.described}
    found: dict[str, int] = {}
    if topic.message in _COMMANDED and told & _COMMANDS and not need.every_word & _COMMANDS:
        found["a command"] = -25
    if not _is_axis(need, leaf):
        found["another axis"] = -12
    sides = sum(1 for group in _SIDES if _apart(asked & group, told & group))
    if sides:
        found["another side"] = -30 * sides
    if _numbers_differ(need, topic.words):
        found["another number"] = -30
    if need.type == "bool" and told & _BAD_WHEN_TRUE and not need.every_word & _BAD_WHEN_TRUE:
        found[ALARM] = -15
    if "raw" in told and not need.says("raw"):
        found["raw"] = -2
    if {"desired", "error"} & set(leaf.path[:-1]):
        found["planned"] = -12
    if topic.message.startswith("Joint") and not need.says("joint", "joints", "torque", "effort"):
        found["of joints"] = -20
    unexplained = [
        word
        for word in dict.fromkeys(words(topic.topic))
        if all(not need.fit(w, (word,)) for w in asked)
    ]
    if unexplained:
        found["rest"] = -min(5, len(unexplained))
    return found


def _apart(first: set[str], second: set[str]) -> bool:
    return bool(first and second and not first & second)


def _is_axis(need: InputNeed, leaf: TopicField) -> bool:
    """Return whether a component of a velocity is the one that is meant."""
    vector, axis = (leaf.path[-2], leaf.path[-1]) if len(leaf.path) > 1 else ("", "")
    if vector not in _AXES:
        return True
    wanted = next(
        (one for one, some in _AXES[vector] if need.every_word & some), _USUAL_AXIS[vector]
    )
    return axis == wanted


def _axis_words(leaf: TopicField) -> frozenset[str]:
    """Return the words that the component of a velocity stands for."""
    vector, axis = (leaf.path[-2], leaf.path[-1]) if len(leaf.path) > 1 else ("", "")
    if vector not in _AXES:
        return frozenset()
    usual = ("speed", "velocity", *(("front",) if (vector, axis) == ("linear", "x") else ()))
    return frozenset(usual).union(*(some for one, some in _AXES[vector] if one == axis))


def _numbers_differ(need: InputNeed, given: Sequence[str]) -> bool:
    """Return whether both have words with digits, and none begins with another one."""
    asked = [word for word in need.words if any(map(str.isdigit, word))]
    told = [word for word in given if any(map(str.isdigit, word))]
    alike = any(a.startswith(b) or b.startswith(a) for a in asked for b in told)
    return bool(asked and told and not alike)
