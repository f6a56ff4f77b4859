"""Quality of service: what a configuration gives, and what is usual where it gives nothing."""

from __future__ import annotations

from typing import Any, Iterable, Mapping

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

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
    """Return how evidence is read: as sensor data, so that every publisher fits.

    What is kept for who comes later is sent again only to who reads reliably (Fast DDS).

    Args:
        given: what a person wants otherwise.
        depth: messages that wait.
    """
    kept = given.get("durability") == "transient_local"
    reliability = "reliable" if kept else "best_effort"
    usual = {"reliability": reliability, "durability": "volatile", "depth": depth}
    return _profile({**usual, **given})


def writing(given: Mapping[str, Any], depth: int) -> QoSProfile:
    """Return how results are written: nothing is lost, and who comes late gets the last one.

    Args:
        given: what a person wants otherwise.
        depth: messages that wait.
    """
    usual = {"reliability": "reliable", "durability": "transient_local", "depth": depth}
    return _profile({**usual, **given})


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
