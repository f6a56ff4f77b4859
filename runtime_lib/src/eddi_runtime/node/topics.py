"""What a node subscribes to and what it publishes, as plain data of the generated node."""

from typing import Any, NamedTuple, Optional, Tuple

from ..access import Step

DEFAULT_BUFFER_BYTES = 65536  # rospy's own value: enough for everything but images and clouds


class Input(NamedTuple):
    """One subscription: a ``SimulatorOutputs`` entry of eddi_config.yml.

    Attributes:
        id: name under which ``EDDIInput.processing`` finds the message.
        topic: absolute or relative ROS name; remapping and namespaces apply.
        type: ROS message class.
        buffer_bytes: receive buffer. rospy hands out old messages when a message is larger
            than the buffer, so it must be raised for images and point clouds.
        every_message: no message is skipped: those between two steps are queued.
    """

    id: str
    topic: str
    type: Any
    buffer_bytes: int = DEFAULT_BUFFER_BYTES
    every_message: bool = False


class Output(NamedTuple):
    """One publication: an ``EDDIOutputs`` entry of eddi_config.yml.

    Attributes:
        id: name of the output, for people.
        topic: ROS name of the message.
        type: ROS message class of the message.
        status_topic: ROS name of the facts behind the result, ``None`` for none.
        status_type: its message class (with a header), ``None`` for none.
        field: place of the value that is published alone, as ``data`` of a message of
            std_msgs: names of fields, positions and ``("id", id)``; empty: the whole message.
        only: id of the one message, of several in a step, that goes here; ``None``: all.
        of: which message of the monitor: empty for the result, else the name of one beside it
            (``evidence``), which the monitor's ``evidence_message()`` gives.
    """

    id: str
    topic: str
    type: Any
    status_topic: Optional[str] = None
    status_type: Any = None
    field: Tuple[Step, ...] = ()
    only: Optional[str] = None
    of: str = ""
