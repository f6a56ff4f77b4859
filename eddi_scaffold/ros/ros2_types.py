"""The messages of ROS 2 that a configuration may name, and a monitor that is bound to them."""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.config.message_types import MessageFields, fields_of, known_messages
from eddi_scaffold.config.message_types.ros2 import ros2_fields, ros2_messages
from eddi_scaffold.monitors.binding import BoundMonitor, bind_inputs, known_types
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.problems import Problem


def bound_to(monitor: BoundMonitor, known: MessageFields) -> tuple[BoundMonitor, list[Problem]]:
    """Return a monitor with the fields of ROS 2: one that ROS 1 has may be another one, or none.

    Args:
        monitor: as it was read.
        known: type -> its fields.
    """
    inputs, problems = bind_inputs(monitor.model, monitor.kind, monitor.config, known)
    errors = [one for one in problems if one.level == "error"]  # the rest was told before
    return replace(monitor, inputs=tuple(inputs)), errors


def types_of(monitor: BoundMonitor) -> MessageFields:
    """Return the message types of ROS 2 that a configuration may name, as the monitor has them."""
    assert monitor.config is not None, "a node needs a configuration"
    options = monitor.config.config.Model.model_extra or {}
    respelt = {
        f"{MESSAGE_PACKAGE}/{name}": fields_of(text, MESSAGE_PACKAGE)
        for name, text in monitor.kind.respelt(options).items()
    }
    known = known_types(monitor.config, ros2_messages({**known_messages(), **respelt}))
    return {name: ros2_fields(fields) for name, fields in known.items()}
