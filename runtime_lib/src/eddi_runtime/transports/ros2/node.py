"""The ROS 2 node of one monitor, on rclpy: subscribe, one step per period, publish."""

from __future__ import annotations

import re
import time
from types import ModuleType
from typing import Any, Callable, ClassVar, Iterable

import diagnostic_msgs.msg
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.time import Time

from ...inputs import UNKNOWN_AGE, EDDIInputBase
from ...monitor import Steps
from ...node.health import diagnostics_tree
from ...node.node import REFUSALS, NewInput, NewMonitor, Node, Statuses
from ...node.report import GraphFact, fault
from ...node.start import Settings, end_at_signals, write_to_stderr
from ...node.topics import Converter, Input, Output, Publish, Topic, reading_qos, writing_qos
from .process import Process, deadline, declared_settings, keeps, profile, refused

_SPELT = {"boolean": "bool", "float": "float32", "double": "float64", "octet": "byte"}
_SEQUENCE = re.compile(r"sequence<(.*?)(?:, (\d+))?>")
_ARRAY = re.compile(r"(.*)(\[\d+\])")
_DEPTH = 5


def msg_type(of: str) -> str:
    """Return a type of a field: ``float64[]`` of ``sequence<double>``."""
    sequence = _SEQUENCE.fullmatch(of)
    if sequence is not None:
        item, most = sequence.groups()
        return f"{msg_type(item)}[{f'<={most}' if most else ''}]"
    array = _ARRAY.fullmatch(of)
    if array is not None:
        return msg_type(array.group(1)) + array.group(2)
    return _SPELT.get(of, of)


def ros_type(message: object) -> str:
    """Return ``package/Name`` of a message or of its class."""
    cls = message if isinstance(message, type) else type(message)
    return f"{cls.__module__.partition('.')[0]}/{cls.__name__}"


def converter(messages: ModuleType, stamp: Callable[[], object]) -> Converter:
    """Return what makes messages of a package (``eddi_messages.msg``)."""

    def fields(cls: Any) -> Iterable[tuple[str, str]]:
        return ((name, msg_type(of)) for name, of in cls.get_fields_and_field_types().items())

    return Converter(messages, fields, ros_type, stamp)


class MonitorNode(Node):
    """Base class of the generated RosNode."""

    PROCESS: ClassVar[type[Process]] = Process  # what it runs in

    def __init__(
        self, monitor: Steps, eddi_input: EDDIInputBase, options: Settings, process: Process
    ) -> None:
        super().__init__(monitor, eddi_input, converter(self.MESSAGES, process.stamp), options)
        self._process = process
        self._read: dict[str, tuple[str, QoSProfile]] = {}

    def simulated_ns(self) -> int | None:
        return self._process.simulated_ns()

    def resolved(self, topic: str) -> str:
        return str(self._process.node.resolve_topic_name(topic))

    def advertise(self, channel: Output) -> Publish:
        qos = profile(writing_qos(channel.qos, self.options.queue_size))
        return self._process.publisher(channel.topic, channel.type, qos)

    def subscribe(self, source: Input) -> None:
        qos = profile(reading_qos(source.qos, source.waiting(_DEPTH)))
        kept = keeps(qos)

        def receive(message: Any, sent: int | None) -> None:
            age = self._age(message, sent) if kept else 0.0
            self._receipts.receive(source.id, message, age)

        made = self._process.subscription(source.topic, source.type, qos, receive)
        self._read[source.id] = (made.topic_name, made.qos_profile)

    def _age(self, message: Any, sent: int | None) -> float:
        """Return how old a message is that may have been kept; the future may be any age."""
        made = getattr(getattr(message, "header", None), "stamp", None)
        if made is not None and (made.sec or made.nanosec):
            age = (Time.from_msg(self._process.stamp()) - Time.from_msg(made)).nanoseconds / 1e9
        elif sent is not None:
            age = (time.time_ns() - sent) / 1e9
        else:
            return UNKNOWN_AGE
        return age if age >= 0.0 else UNKNOWN_AGE

    def check_serialises(self, message: object) -> None:
        serialize_message(message)

    def graph(self) -> GraphFact:
        quiet = self._silence.quiet(self._receipts.latest())
        topics = [self._topic(source, age) for source, age in quiet if source.id in self._read]
        published = self._process.published() if topics else []
        several = f"another node has the name {self._process.name}, too"
        warnings = (several,) if self._process.namesakes() > 1 else ()
        return self._silence.explained(topics, published)._replace(warnings=warnings)

    def _topic(self, source: Input, age: float | None) -> Topic:
        name, own_qos = self._read[source.id]
        known = self._process.publications(source.topic)
        expected = ros_type(source.type)
        fitting = [qos for type_name, qos in known if type_name == expected]
        lacking = refused(own_qos, fitting)
        why = fault(
            expected,
            age,
            refused=lacking,
            connected=lacking is None,
            alive=self._process.alive(source.topic),
            deadline=deadline(fitting),
        )
        return Topic(name, expected, {type_name for type_name, _ in known}, age, why)

    def run(self, begun: Callable[[], None]) -> None:
        self.run_on(self._process.name, self.statuses, begun)

    def statuses(self) -> Statuses:
        messages: Any = diagnostic_msgs.msg
        made, qos = converter(messages, self._process.stamp), profile(writing_qos({}, 1))
        publish = self._process.publisher("/diagnostics", messages.DiagnosticArray, qos)
        return lambda rows: publish(made.message(diagnostics_tree(rows, lambda n: bytes([n]))))

    @classmethod
    def serve(cls, process: Any, make: Callable[[], MonitorNode]) -> int:
        node = make()
        node.prepare()
        with process.until(node.ending):
            node.run(process.start)
            node.withdraw()  # the last word
        return node.ending.status

    @classmethod
    def main(cls, eddi_input_class: NewInput, eddi_monitor_class: NewMonitor) -> int:
        """Run the node of a generated package; return its exit status, 1: it cannot start."""
        end_at_signals()
        process: Any = None
        try:
            process = cls.PROCESS(cls.NAME)
            options = declared_settings(process.node, cls.FREQUENCY, cls.STARTUP_GRACE)
            return cls.serve(
                process, lambda: cls(eddi_monitor_class(), eddi_input_class(), options, process)
            )
        except REFUSALS as error:
            write_to_stderr(cls.NAME, f"error: {error}")
            if process is not None:
                process.close()
            return 1
