"""The ROS 1 node of one monitor: subscribe, one step per period, publish.

``create_ros_msg``, ``init_publisher``, ``init_subscriber`` and ``ros_main`` are names of SESAME
D7.2 Fig 31; a person may override them in the generated RosNode.
"""

from __future__ import annotations

import logging
import threading
import time
from io import BytesIO
from operator import attrgetter
from types import ModuleType
from typing import Any

import diagnostic_msgs.msg
import rospy
import rospy.impl.paramserver

from ...inputs import UNKNOWN_AGE, EDDIInputBase
from ...monitor import Steps
from ...node.health import diagnostics_tree
from ...node.node import REFUSALS, NewInput, NewMonitor, Node, Options, Statuses
from ...node.report import GraphFact, Reason, fault
from ...node.start import LOG, end_at_signals, write_to_stderr
from ...node.topics import DEFAULT_BUFFER_BYTES, Converter, Input, Output, Publish, Receipts, Topic
from .process import LOST, RosEnding, TypeRefusals, Watchdog, node_name, options_of

_ROSOUT_SWITCH = "/rosout_disable_topics_generation"
_MAX_PUBLISHERS = 32


def stamp() -> object:
    """Return the time for a header: ROS time, wall time while there is none (no /clock yet)."""
    if rospy.rostime.is_rostime_initialized():
        now = rospy.Time.now()
        if now.to_nsec():
            return now
    return rospy.Time.from_sec(time.time())


def ros_type(message: object) -> str:
    """Return ``package/Name`` of a ROS message or of its class."""
    known: Any = message
    return str(known._type)  # noqa: SLF001 - genpy's interface, in spite of its name


def converter(messages: ModuleType) -> Converter:
    """Return what makes messages of a package; rospy itself counts ``header.seq``."""
    fields = attrgetter("__slots__", "_slot_types")
    return Converter(messages, lambda cls: zip(*fields(cls)), ros_type, stamp)


class Callback:
    """Takes the messages of one input; rospy calls it in a thread of each publisher."""

    def __init__(self, source: str, receipts: Receipts) -> None:
        self._source, self._receipts = source, receipts
        self._greeted: dict[str, object] = {}
        self._lock = threading.Lock()

    def __call__(self, message: object) -> None:
        header = getattr(message, "_connection_header", None) or {}
        # rospy keeps one header object per connection: a new object means a first message.
        publisher = str(header.get("callerid", ""))
        latched = header.get("latching") == "1"
        with self._lock:
            first = self._greeted.get(publisher) is not header
            if len(self._greeted) >= _MAX_PUBLISHERS:
                self._greeted.clear()  # every rostopic pub has a name of its own
            self._greeted[publisher] = header
            age = _stamped_age(message) if latched and first else 0.0
            self._receipts.receive(self._source, message, age)


def _stamped_age(message: object) -> float:
    """Return how old a message is by its header; one from the future may be of any age, too."""
    made = getattr(getattr(message, "header", None), "stamp", None)
    if not made or not rospy.rostime.is_rostime_initialized():  # a stamp of zero is no time
        return UNKNOWN_AGE
    age = float((rospy.Time.now() - made).to_sec())
    return age if age >= 0.0 else UNKNOWN_AGE


def diagnostics_publisher() -> Statuses:
    """Return what publishes statuses on ``/diagnostics``."""
    messages: Any = diagnostic_msgs.msg
    publisher: Any = rospy.Publisher("/diagnostics", messages.DiagnosticArray, queue_size=5)
    made = converter(messages)
    return lambda statuses: publisher.publish(made.message(diagnostics_tree(statuses)))


def start_log() -> None:
    """Let rospy write the log of the process; ``rospy.init_node`` has been called."""
    # Every ``rospy.log*`` asks the master for a parameter (ros_comm 1.15.15) that is not cached.
    cache: Any = rospy.impl.paramserver.get_param_server_cache()
    cache.set(_ROSOUT_SWITCH, bool(rospy.get_param(_ROSOUT_SWITCH, default=False)))
    LOG.start({"info": rospy.loginfo, "warn": rospy.logwarn, "error": rospy.logerr})
    logging.getLogger("rospy.internal").addHandler(TypeRefusals())


def _connected(subscriber: Any) -> bool:
    """Return whether a publisher lives: a master lists one that was killed for ever."""
    connections = [*(getattr(subscriber.impl, "connections", None) or ())]
    # one that was refused has no other end
    ends = [
        (getattr(link, "socket", link), *getattr(link, "remote_endpoint", ()))
        for link in connections
    ]
    return any(None not in end for end in ends)


class MonitorNode(Node):
    """Base class of the generated RosNode."""

    def __init__(self, monitor: Steps, eddi_input: EDDIInputBase, options: Options = None) -> None:
        super().__init__(monitor, eddi_input, converter(self.MESSAGES), options)
        self._subscribers: dict[str, Any] = {}
        self.share(RosEnding(), None)

    def share(self, ending: RosEnding, watchdog: Watchdog | None) -> None:
        """Take what a process has once; several monitors of one process share it."""
        self.ending: RosEnding = ending
        self._watchdog = watchdog

    def subscribe(self, source: Input) -> None:  # blocks while the ROS master does not answer
        large = source.buffer_bytes != DEFAULT_BUFFER_BYTES
        self._subscribers[source.id] = rospy.Subscriber(
            source.topic,
            source.type,
            Callback(source.id, self._receipts),
            queue_size=source.waiting(1),
            tcp_nodelay=True,
            **({"buff_size": source.buffer_bytes} if large else {}),
        )

    def advertise(self, channel: Output) -> Publish:  # with a queue no subscriber can block
        size = self.options.queue_size
        made: Any = rospy.Publisher(channel.topic, channel.type, queue_size=size, latch=True)
        publish: Publish = made.publish
        return publish

    def check_serialises(self, message: Any) -> None:
        message.serialize(BytesIO())

    def simulated_ns(self) -> int | None:
        return None if rospy.rostime.is_wallclock() else int(rospy.Time.now().to_nsec())

    def resolved(self, topic: str) -> str:
        return str(rospy.resolve_name(topic))

    def expected_types(self) -> dict[str, tuple[str, str]]:
        """Return resolved topic -> (input id, ROS type name) of every subscription."""
        known = dict(self._subscribers).items()
        return {own.resolved_name: (name, str(own.type)) for name, own in known}

    def graph(self) -> GraphFact:
        watchdog, receipts, wrong = self._watchdog, self._receipts.latest(), {}
        if watchdog is None:
            return GraphFact((("master", "not watched"),))
        lost, expected = watchdog.state == LOST, self.expected_types()
        for topic, (since, text) in watchdog.wrong_types.items():
            last = receipts.get(expected[topic][0]) if topic in expected else None
            if topic in expected and (last is None or last.at <= since):  # else it may be gone
                wrong[topic] = Reason("type", text)
        published = {} if lost else watchdog.published
        ages = {source.id: age for source, age in self._silence.quiet(receipts)}
        silent = []
        for topic, (name, kind) in expected.items() if published else ():
            if name in ages:
                dead = ages[name] is not None and not _connected(self._subscribers[name])
                there = topic in published and not dead
                silent.append(
                    Topic(topic, kind, (kind,) if there else (), ages[name], fault(kind))
                )
        fact = self._silence.explained(silent, published)
        return fact._replace(
            values=(("master", watchdog.state),),
            warnings=("ROS master lost",) if lost else (),
            reasons={**fact.reasons, **wrong},
        )

    def run(self) -> int:
        self.ending.install()
        start_log()
        if self.options.watchdog_period:
            shared = self.options, self.ending, self.expected_types, self.report_now
            self._watchdog = Watchdog(*shared)
        begun = (lambda: None) if self._watchdog is None else self._watchdog.start
        self.run_on(rospy.get_name(), diagnostics_publisher, begun)
        self.ending.wait()
        return self.ending.status

    @classmethod
    def main(cls, eddi_input_class: NewInput, eddi_monitor_class: NewMonitor) -> int:
        """Run the node of a generated package; return its exit status, 1: it cannot start."""
        end_at_signals()
        name = node_name(cls.NAME)
        try:
            # everything that can fail before anything is registered
            options = options_of(name, cls.FREQUENCY, cls.STARTUP_GRACE)
            node = cls(eddi_monitor_class(), eddi_input_class(), options)
            node.prepare()
            rospy.init_node(cls.NAME)
        except (*REFUSALS, rospy.ROSInitException) as error:
            if rospy.is_shutdown():
                return 0  # ended while it waited for the ROS master
            write_to_stderr(name, f"error: {error}")
            return 1
        return node.run()
