"""What a person sets: parameters (``ros2 param describe`` shows them), quality of service."""

from __future__ import annotations

import sys
from typing import Any, Iterable, Mapping

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.duration import Duration
from rclpy.exceptions import ParameterException
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from ...node.publications import reading_qos, writing_qos
from ...node.start import FREQUENCIES, Settings, StartError, settings

_MOST_QUEUED = 1_000_000


def declared_settings(node: Any, frequency: float, startup_grace: float) -> Settings:
    """Declare the parameters of a node of rclpy; return what a person set (StartError)."""
    given: dict[str, Any] = {}
    for name, value, text, ranges in _parameters(frequency, startup_grace):
        given[name] = declared(node, name, value, text, **ranges)
    options, wrong = settings(given, frequency, startup_grace)
    if wrong:
        raise StartError("; ".join(wrong))
    return options


def declared(node: Any, name: str, default: object, meaning: str, **ranges: Any) -> Any:
    """Declare a parameter; return what a person has set, or raise StartError."""
    # Read once, so nobody can set them later; 10 is as good a number as 10.0.
    descriptor = ParameterDescriptor(
        description=meaning, read_only=True, dynamic_typing=isinstance(default, float), **ranges
    )
    try:
        return node.declare_parameter(name, default, descriptor).value
    except ParameterException as error:
        raise StartError(f"parameter {name}: {error.args[0]}") from error


def _parameters(
    frequency: float, startup_grace: float
) -> list[tuple[str, object, str, dict[str, Any]]]:
    """Return name, default, meaning and range of each."""
    grace = "seconds in which an input may wait for its first message"
    queue = "messages that wait for a slow subscriber of the outputs"
    robot = "name of this robot among others, empty for the configured one"
    return [
        ("frequency", frequency, "steps per second", _between(*FREQUENCIES)),
        ("diagnostics", True, "publish a summary on /diagnostics", {}),
        ("startup_grace", startup_grace, grace, _between(0.0, sys.float_info.max)),
        ("robot", "", robot, {}),
        ("queue_size", 1, queue, {"integer_range": [_whole(1, _MOST_QUEUED)]}),
    ]


def _between(low: float, high: float) -> dict[str, Any]:
    made = FloatingPointRange(from_value=low, to_value=high, step=0.0)
    return {"floating_point_range": [made]}


def _whole(low: int, high: int) -> Any:
    return IntegerRange(from_value=low, to_value=high, step=1)


_RELIABILITIES = {
    "reliable": ReliabilityPolicy.RELIABLE,
    "best_effort": ReliabilityPolicy.BEST_EFFORT,
}
_DURABILITIES = {
    "transient_local": DurabilityPolicy.TRANSIENT_LOCAL,
    "volatile": DurabilityPolicy.VOLATILE,
}

_FOR_EVER_NS = 2**62
"""Whatever is longer: what counts as infinite depends on the middleware and the release."""


def reading(given: Mapping[str, Any], depth: int) -> QoSProfile:
    """Return how evidence is read: see :func:`reading_qos`."""
    return _profile(reading_qos(given, depth))


def writing(given: Mapping[str, Any], depth: int) -> QoSProfile:
    """Return how results are written: see :func:`writing_qos`."""
    return _profile(writing_qos(given, depth))


def _profile(wanted: Mapping[str, Any]) -> QoSProfile:
    times: dict[str, Any] = {
        name: Duration(seconds=wanted[name]) for name in ("deadline", "lifespan") if name in wanted
    }
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=wanted["depth"],
        reliability=_RELIABILITIES[wanted["reliability"]],
        durability=_DURABILITIES[wanted["durability"]],
        **times,
    )


def keeps(profile: QoSProfile) -> bool:
    """Return whether a reader gets messages of before it was there, which may be of any age."""
    return bool(profile.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def refused(reader: QoSProfile, writers: Iterable[QoSProfile]) -> str:
    """Return what of every writer is less than a reader asks for, empty when one fits."""
    reasons = [_lacking(reader, writer) for writer in writers]
    return reasons[0] if reasons and all(reasons) else ""


def _lacking(reader: QoSProfile, writer: QoSProfile) -> str:
    reliable = reader.reliability == ReliabilityPolicy.RELIABLE
    if reliable and writer.reliability == ReliabilityPolicy.BEST_EFFORT:
        return "the reliability"
    if keeps(reader) and writer.durability == DurabilityPolicy.VOLATILE:
        return "the durability"
    wanted, promised = _period(reader), _period(writer)
    if wanted is not None and (promised is None or promised > wanted):
        return "the deadline"
    return ""


def deadline(writers: Iterable[QoSProfile]) -> float | None:
    """Return the shortest time between two messages that a writer promises, in seconds."""
    return min((one for one in map(_period, writers) if one is not None), default=None)


def _period(profile: QoSProfile) -> float | None:
    """Return the deadline in seconds: ROS 2 writes none as zero, and as the longest there is."""
    given = profile.deadline.nanoseconds
    return given / 1e9 if 0 < given < _FOR_EVER_NS else None
