"""The ROS 1 node of one monitor: subscribe, one step per period, publish.

The names ``create_ros_msg``, ``init_publisher``, ``init_subscriber`` and ``ros_main`` are those
of SESAME D7.2 Fig 31; a person may override them in the generated RosNode.
"""

from __future__ import annotations

from io import BytesIO
from typing import Any, Callable, Mapping

import rospy

from ...compatibility import ModelError
from ...inputs import EDDIInputBase
from ...monitor import Steps
from ...node.node import Node
from ...node.outputs import MessageError, Output, Publish
from ...node.receipts import DEFAULT_BUFFER_BYTES, MAX_QUEUED, Input, Topic
from ...node.report import GraphFact
from ...node.start import Settings, StartError, end_at_signals, write_to_stderr
from .messages import Callback, converter, diagnostics_publisher, start_log
from .process import RosEnding, node_name, options_of
from .watchdog import LOST, TypeRefusals, Watchdog, standing, watch

_REGISTERED = "its publisher is registered, and silent"  # a master does not know if it lives


class MonitorNode(Node):
    """Base class of the generated RosNode."""

    def __init__(
        self, monitor: Steps, eddi_input: EDDIInputBase, options: Settings | None = None
    ) -> None:
        super().__init__(monitor, eddi_input, converter(self.MESSAGES), options)
        self._subscribers: dict[str, Any] = {}
        self._refusals = TypeRefusals()
        self._watchdog: Watchdog | None = None
        self.ending: RosEnding = RosEnding()

    def subscribe(self, source: Input) -> None:
        """Subscribe to an input topic; blocks while the ROS master does not answer."""
        large = source.buffer_bytes != DEFAULT_BUFFER_BYTES
        self._subscribers[source.id] = rospy.Subscriber(
            source.topic,
            source.type,
            Callback(source.id, self._receipts),
            queue_size=MAX_QUEUED if source.every_message else 1,
            tcp_nodelay=True,
            **({"buff_size": source.buffer_bytes} if large else {}),
        )

    def advertise(self, channel: Output) -> Publish:
        """Return a publisher: latched, with a queue, so that no subscriber can block."""
        size = self.options.queue_size
        made: Any = rospy.Publisher(channel.topic, channel.type, queue_size=size, latch=True)
        publish: Publish = made.publish
        return publish

    def check_serialises(self, message: object) -> None:
        """Raise what rospy would raise once somebody listens; for messages made by hand."""
        made: Any = message
        made.serialize(BytesIO())

    def simulated_ns(self) -> int | None:
        """Return the time of ``/clock`` where that counts."""
        return None if rospy.rostime.is_wallclock() else int(rospy.Time.now().to_nsec())

    def topics(self) -> Mapping[str, str]:
        """Return input id -> resolved topic of every subscription."""
        return {name: one.resolved_name for name, one in dict(self._subscribers).items()}

    def graph(self) -> GraphFact:
        """Return what the master knows: topics without a publisher, types that do not fit.

        It also lists a publisher that was killed.
        """
        watchdog = self._watchdog
        seen = {} if watchdog is None else dict(watchdog.wrong_types)
        expected = self.expected_types()
        refused = dict(self._refusals.heard)
        receipts = self._receipts.latest()
        shared = set() if watchdog is None else watchdog.shared
        wrong: dict[str, str] = {}
        mixed: list[str] = []
        for topic, (name, _) in expected.items():
            last = receipts[name].at if name in receipts else None
            text = standing(seen.get(topic), last) or standing(refused.get(topic), last)
            if text:
                wrong[topic] = text
            elif topic in shared and (topic in seen or topic in refused):
                _, text = seen.get(topic) or refused[topic]
                mixed.append(f"a publisher that is registered for {topic} does not fit: {text}")
        state = "not watched" if watchdog is None else watchdog.state
        lost = ("ROS master lost",) if state == LOST else ()
        warnings = (*lost, *mixed)
        known = None if watchdog is None or lost else watchdog.published
        ages = {source.id: age for source, age in self._silence.quiet(receipts)}
        silent = [
            Topic(topic, kind, (kind,) if topic in known else (), ages[name], _REGISTERED)
            for topic, (name, kind) in expected.items()
            if known is not None and name in ages
        ]
        found = self._silence.explained(silent, known or ())
        return found._replace(values=(("master", state),), warnings=warnings, wrong_types=wrong)

    def expected_types(self) -> dict[str, tuple[str, str]]:
        """Return resolved topic -> (input id, ROS type name) of every subscription."""
        subscribers = dict(self._subscribers)
        return {
            subscriber.resolved_name: (name, str(subscriber.type))
            for name, subscriber in subscribers.items()
        }

    def run(self) -> int:
        """Advertise, publish once, subscribe and loop; return the exit status.

        ``rospy.init_node`` has been called.
        """
        self.ending.install()
        start_log()
        self._refusals.install()
        self._watchdog = watch(self.options, self.ending, self.expected_types, self.report_now)
        begun = (lambda: None) if self._watchdog is None else self._watchdog.start
        self.run_on(rospy.get_name(), diagnostics_publisher, begun)
        self.ending.wait()
        return self.ending.status

    def share(self, ending: RosEnding, refusals: TypeRefusals, watchdog: Watchdog | None) -> None:
        """Be one of several monitors of a process, which has these once."""
        self.ending, self._refusals, self._watchdog = ending, refusals, watchdog

    @classmethod
    def main(
        cls, eddi_input_class: Callable[[], EDDIInputBase], eddi_monitor_class: Callable[[], Steps]
    ) -> int:
        """Run the node of a generated package and return its exit status.

        0 after a normal end, 1 when it must not start or lost its name, 3 when the ROS master was
        lost and did not come back.
        """
        end_at_signals()
        name = node_name(cls.NAME)
        try:
            # everything that can fail before anything is registered
            options = options_of(name, cls.FREQUENCY, cls.STARTUP_GRACE)
            node = cls(eddi_monitor_class(), eddi_input_class(), options)
            node.prepare()
            rospy.init_node(cls.NAME)
        except (StartError, ModelError, MessageError, rospy.ROSInitException) as error:
            if rospy.is_shutdown():
                return 0  # ended while it waited for the ROS master
            write_to_stderr(name, f"error: {error}")
            return 1
        return node.run()
