"""Parameters of a node, declared with their meaning and their range (``ros2 param describe``)."""

from __future__ import annotations

import sys
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException

from ...node.settings import FREQUENCIES, Settings, settings
from ...node.start import StartError

_MOST_QUEUED = 1_000_000


def declared_settings(node: Any, frequency: float, startup_grace: float) -> Settings:
    """Declare the parameters of a node, and return what a person has set.

    Args:
        node: of rclpy.
        frequency: steps per second of the generated node.
        startup_grace: of the generated node.

    Raises:
        StartError: a parameter has a wrong type or value.
    """
    given: dict[str, Any] = {}
    for name, value, text, ranges in _parameters(frequency, startup_grace):
        given[name] = declared(node, name, value, text, **ranges)
    options, wrong = settings(given, frequency, startup_grace)
    if wrong:
        raise StartError("; ".join(wrong))
    return options


def declared(node: Any, name: str, default: object, meaning: str, **ranges: Any) -> Any:
    """Declare a parameter of a node, and return what a person has set.

    Raises:
        StartError: it has a wrong type or value.
    """
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
