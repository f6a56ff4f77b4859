"""The ROS 1 node of one monitor: subscribe, one step per period, publish.

The names ``create_ros_msg``, ``init_publisher``, ``init_subscriber`` and ``ros_main`` are those
of SESAME D7.2 Fig 31; a person may override them in the generated RosNode.
"""

import sys
from typing import Any, Callable, Dict, Mapping, Optional, Tuple

import rospy

from ...compatibility import ModelError
from ...inputs import EDDIInputBase
from ...monitor import Steps
from ...node.conversion import MessageError
from ...node.health import Diagnostics
from ...node.logs import LOG
from ...node.node import UNWATCHED, Node
from ...node.outputs import Channel, Publish
from ...node.report import Report
from ...node.settings import Settings
from . import start
from .ending import Ending
from .messages import check_serialises, converter, diagnostics_publisher, start_log, status_of
from .subscriptions import subscribe
from .watchdog import TypeRefusals, Watchdog, watch


class MonitorNode(Node):
    """Base class of the generated RosNode.

    Args:
        monitor: the generated EDDIMonitor.
        eddi_input: the generated EDDIInput.
        options: private parameters.
    """

    def __init__(
        self, monitor: Steps, eddi_input: EDDIInputBase, options: Optional[Settings] = None
    ) -> None:
        super().__init__(monitor, eddi_input, converter(self.MESSAGES), options)
        self._subscribers: Dict[str, Any] = {}
        self._refusals = TypeRefusals()
        self._watchdog: Optional[Watchdog] = None
        self._level_changed: Callable[[], None] = _nobody_reports
        self._ending = Ending()
        self._ros_time: Any = None

    def init_subscriber(self) -> None:
        """Subscribe to every input topic; blocks while the ROS master does not answer."""
        for source in self.INPUTS:
            self._subscribers[source.id] = subscribe(source, self._receipts)

    def advertise(self, channel: Channel) -> Publish:
        """Return a publisher: latched, with a queue, so that no subscriber can block."""
        size = self.options.queue_size
        made: Any = rospy.Publisher(channel.topic, channel.type, queue_size=size, latch=True)
        publish: Publish = made.publish
        return publish

    def check_serialises(self, message: object) -> None:
        """Raise what rospy would raise once somebody listens; for messages made by hand."""
        check_serialises(message)

    def now_ns(self) -> int:
        """Return the time of a step; warn once when simulated time jumps back."""
        if rospy.rostime.is_wallclock():
            return super().now_ns()
        now = rospy.Time.now()
        if self._ros_time is not None and now < self._ros_time:
            LOG.warn("/clock jumped back by %.3f s", (self._ros_time - now).to_sec())
        self._ros_time = now
        return int(now.to_nsec())

    def topics(self) -> Mapping[str, str]:
        """Return input id -> resolved topic of every subscription."""
        return {name: one.resolved_name for name, one in dict(self._subscribers).items()}

    def report_now(self) -> None:
        """Publish the diagnostics at once, where they are."""
        self._level_changed()

    def _collect(self, periodic: bool) -> Report:
        watchdog = self._watchdog
        seen = {} if watchdog is None else dict(watchdog.wrong_types)
        expected = self.expected_types()
        wrong = {topic: text for topic, text in seen.items() if topic in expected}
        receipts = self._receipts.latest()
        for topic, (name, _) in expected.items():
            last = receipts[name].at if name in receipts else None
            reason = self._refusals.standing(topic, last)
            if reason is not None:
                wrong.setdefault(topic, f"{topic}: {reason}")
        return self.collect(
            periodic=periodic,
            master=UNWATCHED if watchdog is None else watchdog.state,
            wrong_types=list(wrong.values()),
        )

    def expected_types(self) -> Dict[str, Tuple[str, str]]:
        """Return resolved topic -> (input id, ROS type name) of every subscription."""
        subscribers = dict(self._subscribers)
        return {one.resolved_name: (name, str(one.type)) for name, one in subscribers.items()}

    def run(self) -> int:
        """Advertise, publish once, subscribe and loop; return the exit status.

        ``rospy.init_node`` has been called.
        """
        self._ending.install()
        start_log()
        self._refusals.install()
        self._watchdog = watch(self.options, self._ending, self.expected_types, self.report_now)
        diagnostics = Diagnostics(diagnostics_publisher()) if self.options.diagnostics else None
        self.begin(rospy.get_name(), diagnostics)
        if self._watchdog is not None:
            self._watchdog.start()
        if diagnostics is not None:
            self._ending.on_end(diagnostics.stop)
            diagnostics.start()
        self.ros_main()
        self._ending.wait()
        return self._ending.status

    def share(self, ending: Ending, refusals: TypeRefusals, watchdog: Optional[Watchdog]) -> None:
        """Be one of several monitors of a process, which has these once."""
        self._ending, self._refusals, self._watchdog = ending, refusals, watchdog

    def begin(self, name: str, diagnostics: Optional[Diagnostics]) -> None:
        """Advertise, publish once and subscribe.

        Args:
            name: of the node in the diagnostics.
            diagnostics: of the process, if it has some.
        """
        self._ending.on_end(self._stop)
        self.log_start()
        self.init_publisher()
        self.step()  # before any message can arrive: nothing is known, nothing is active
        self.init_subscriber()
        if diagnostics is not None and self.options.diagnostics:
            title = f"{name.lstrip('/')}: {self._core.model_id}"
            self._level_changed = diagnostics.add(
                lambda periodic: status_of(self._collect(periodic), title, name)
            )

    def _stop(self) -> None:
        self.ended = True
        self._waker.wake()

    @classmethod
    def main(
        cls,
        eddi_input_class: Callable[[], EDDIInputBase],
        eddi_monitor_class: Callable[[], Steps],
        *_: object,
    ) -> int:
        """Run the node of a generated package and return its exit status.

        Args:
            eddi_input_class: the generated EDDIInput.
            eddi_monitor_class: the generated EDDIMonitor.
            _: not used; the nodes of older packages give their own file.

        Returns:
            0 after a normal end, 1 when it must not start or lost its name, 3 when the ROS
            master was lost and did not come back.
        """
        name = start.node_name(cls.NAME)
        try:
            # everything that can fail before anything is registered
            options = start.options_of(name, cls.FREQUENCY, cls.STARTUP_GRACE)
            node = cls(eddi_monitor_class(), eddi_input_class(), options)
            node.prepare()
            rospy.init_node(cls.NAME)
        except (start.StartError, ModelError, MessageError) as error:
            sys.stderr.write(f"{name}: error: {error}\n")
            return 1
        except KeyboardInterrupt:
            return 0
        except rospy.ROSInitException as error:
            if rospy.is_shutdown():
                return 0  # ended while it waited for the ROS master
            sys.stderr.write(f"{name}: error: {error}\n")
            return 1
        return node.run()


def _nobody_reports() -> None:
    """Nothing to do where there are no diagnostics."""
