"""The messages of ROS 2 that a configuration may name."""

from __future__ import annotations

from eddi_scaffold.config.message_types import MessageFields, fields_of, known_messages
from eddi_scaffold.config.message_types.ros2 import ros2_fields, ros2_messages
from eddi_scaffold.monitors.binding import BoundMonitor, known_types
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE


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
