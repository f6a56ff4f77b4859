"""Which messages usually hold what: a table of words, dimensions and message types."""

from __future__ import annotations

from dataclasses import dataclass

from eddi_scaffold import units
from eddi_scaffold.connect.needs import Need
from eddi_scaffold.connect.topics import Leaf, RobotTopic

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


def prior(need: Need, topic: RobotTopic, leaf: Leaf) -> tuple[int, frozenset[str]]:
    """Return the points of the best row that applies, and its words."""
    found = [
        (row.points[topic.message], row.words)
        for row in _TABLE
        if topic.message in row.points
        and not row.words.isdisjoint(need.words)
        and _is_of(row.dimensions, need, leaf)
    ]
    return max(found, key=lambda one: one[0], default=(0, frozenset()))


def _is_of(dimensions: frozenset[str], need: Need, leaf: Leaf) -> bool:
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
