"""The ROS 1 node of one monitor: subscribe, one step per period, publish.

The names ``create_ros_msg``, ``init_publisher``, ``init_subscriber`` and ``ros_main`` are those
of SESAME D7.2 Fig 31; a person may override them in the generated RosNode.
"""

import sys
import time
import traceback
from pathlib import Path
from typing import Any, ClassVar, Dict, List, Mapping, Optional, Sequence

import rosgraph
import rospy

from .. import ModelError, __version__
from . import start
from .diagnostics import Diagnostics
from .ending import Ending
from .health import Changes, Health, one_line
from .logs import LOG
from .publications import (
    Converter,
    MessageError,
    Publications,
    check_outputs,
    check_serialises,
)
from .report import Report
from .schedule import Schedule, Waker
from .settings import Settings, settings
from .subscriptions import Receipt, Subscriptions
from .topics import Input, Output
from .watchdog import UNWATCHED, TypeRefusals, Watchdog


class _Nothing:
    """An input of which nothing is known: every evidence is UNKNOWN."""


class MonitorNode:
    """Base class of the generated RosNode.

    Class attributes, set by the generated class:
        NAME: node name.
        FREQUENCY: steps per second; the private parameter ``~frequency`` wins.
        MODE: ``rate``, or ``on_change``: a message starts a step at once, and the node still
            steps at the frequency, because otherwise nothing would ever become stale.
        INPUTS: what to subscribe to.
        OUTPUTS: what to publish.
        MESSAGES: module with the message classes that outputs are built from.

    Args:
        monitor: the generated EDDIMonitor.
        eddi_input: the generated EDDIInput.
        options: private parameters.

    Attributes:
        simulator_values: latest message of every input that has one, at the present step.
    """

    NAME: ClassVar[str] = "eddi_monitor"
    FREQUENCY: ClassVar[float] = 10.0
    MODE: ClassVar[str] = "rate"
    INPUTS: ClassVar[Sequence[Input]] = ()
    OUTPUTS: ClassVar[Sequence[Output]] = ()
    MESSAGES: ClassVar[Any] = None

    def __init__(self, monitor: Any, eddi_input: Any, options: Optional[Settings] = None) -> None:
        self.monitor = monitor
        self.eddi_input = eddi_input
        self.simulator_values: Dict[str, Any] = {}
        self.options = options or Settings(self.FREQUENCY)
        self._core = getattr(monitor, "monitor", monitor)
        self._converter = Converter(self.MESSAGES)
        self._made_by_hand = type(self).create_ros_msg is not MonitorNode.create_ros_msg
        self._publications: Optional[Publications] = None
        on_change = self.MODE == "on_change"
        self._waker = Waker()
        self._schedule = Schedule(1.0 / self.options.frequency, on_change)
        self._subscriptions = Subscriptions(self._waker.wake if on_change else _ignore)
        self._health = Health(self._core, eddi_input, self._schedule.period)
        self._changes = Changes()
        self._refusals = TypeRefusals()
        self._watchdog: Optional[Watchdog] = None
        self._diagnostics: Optional[Diagnostics] = None
        self._ending = Ending()
        self._ros_time: Any = None

    def create_ros_msg(self, eddi_output: Any) -> Any:
        """Return the ROS message of one output of ``EDDIMonitor.execute_step``."""
        return self._converter.message(self._core.message(eddi_output))

    def init_publisher(self) -> None:
        """Advertise every output topic."""
        self._publications = Publications(self.OUTPUTS, self.options.queue_size)

    def init_subscriber(self) -> None:
        """Subscribe to every input topic."""
        self._subscriptions.subscribe(self.INPUTS)

    def ros_main(self) -> None:
        """Run steps until ROS ends the node."""
        self._schedule.start(time.monotonic())
        while not self._ending.begun:
            self._waker.wait(self._schedule.wait_s(time.monotonic()))
            if self._ending.begun:
                return
            started = time.monotonic()
            self.step()
            self._schedule.stepped(started, time.monotonic())

    def step(self) -> None:
        """Evaluate the latest messages and publish the result; never raises.

        Whatever goes wrong, the result that is published is the one of knowing nothing, so an
        old guarantee never stays active.
        """
        started = time.monotonic()
        receipts = self._subscriptions.receipts()
        try:
            output = self._evaluate(receipts, started)
            error = self._publish(output)
            self._health.log_error("step", error)
        except Exception as caught:  # noqa: BLE001 - hand-written code may raise anything
            if self._ending.begun:
                return
            error = one_line(caught)
            self._health.log_error("step", error, traceback.format_exc())
            output = self._publish_nothing_known()
        try:
            self._changes.note(output)
            self._watch_clock()
            if self._health.after_step(receipts, error, time.monotonic() - started):
                self._report_now()
        except Exception as caught:  # noqa: BLE001 - a report must never end the monitor
            self._health.log_error("report", one_line(caught), traceback.format_exc())

    def _evaluate(self, receipts: Mapping[str, Receipt], now: float) -> Any:
        self.simulator_values = {name: receipt.message for name, receipt in receipts.items()}
        self.eddi_input.begin_step({name: now - receipt.at for name, receipt in receipts.items()})
        self.eddi_input.processing(self.simulator_values)
        return self.monitor.execute_step(self.eddi_input)

    def _publish(self, output: Any) -> str:
        """Publish an output; return what was wrong with it although it could be published."""
        if self._publications is None:
            return ""
        message = self.create_ros_msg(output)
        if self._made_by_hand:
            check_serialises(message)
        self._publications.publish(message)
        self._publish_status(self._publications)
        # Not every kind has it: rows that hand-written code spoilt and the monitor replaced.
        faults = getattr(self._core, "output_faults", None)
        return "; ".join(faults()) if faults is not None else ""

    def _publish_status(self, publications: Publications) -> None:
        if publications.with_status:
            tree = self._core.status_message()
            if tree is not None:
                publications.publish_status(self._converter.message(tree))

    def _publish_nothing_known(self) -> Any:
        """Publish what holds when nothing is known, by our own code only."""
        output = None
        try:
            output = self._core.execute_step(_Nothing())
            if self._publications is not None:
                self._publications.publish(MonitorNode.create_ros_msg(self, output))
                self._publish_status(self._publications)
            self._health.log_error("output", "")
        except Exception as caught:  # noqa: BLE001 - the loop must go on
            self._health.log_error("output", one_line(caught), traceback.format_exc())
        return output

    def _watch_clock(self) -> None:
        """Warn once when simulated time jumps back; ages and the loop do not depend on it."""
        if rospy.rostime.is_wallclock():
            return
        now = rospy.Time.now()
        if self._ros_time is not None and now < self._ros_time:
            LOG.warn("/clock jumped back by %.3f s", (self._ros_time - now).to_sec())
        self._ros_time = now

    def _report_now(self) -> None:
        if self._diagnostics is not None:
            self._diagnostics.level_changed()

    def _collect(self, periodic: bool) -> Report:
        receipts = self._subscriptions.receipts()
        return self._health.collect(
            identity={"model_digest": self._core.digest, "runtime_version": __version__},
            receipts=receipts,
            overruns=self._schedule.overruns,
            master=UNWATCHED if self._watchdog is None else self._watchdog.state,
            wrong_types=self._wrong_types(receipts),
            periodic=periodic,
        )

    def _wrong_types(self, receipts: Mapping[str, Receipt]) -> List[str]:
        wrong = {} if self._watchdog is None else dict(self._watchdog.wrong_types)
        for topic, (name, _) in self._subscriptions.expected_types().items():
            last = receipts[name].at if name in receipts else None
            reason = self._refusals.standing(topic, last)
            if reason is not None:
                wrong.setdefault(topic, f"{topic}: {reason}")
        return list(wrong.values())

    def _log_start(self) -> None:
        unlimited = [spec.id for spec in self._core.inputs if spec.max_age is None]
        LOG.info(
            "monitor of %s (%s), model digest %s, eddi_runtime %s from %s,"
            " inputs without max_age: %s",
            self._core.model_id,
            self._core.kind,
            self._core.digest,
            __version__,
            Path(__file__).resolve().parents[1],
            ", ".join(unlimited) or "none",
        )

    def run(self) -> int:
        """Advertise, publish once, subscribe and loop; return the exit status.

        ``rospy.init_node`` has been called.
        """
        self._ending.on_end(self._waker.wake)
        self._ending.install()
        LOG.start()
        self._refusals.install()
        self._log_start()
        self.init_publisher()
        self.step()  # before any message can arrive: nothing is known, nothing is active
        self.init_subscriber()
        self._start_helpers()
        self.ros_main()
        self._ending.wait()
        return self._ending.status

    def _start_helpers(self) -> None:
        if self.options.watchdog_period > 0.0:
            self._watchdog = Watchdog(
                rosgraph.get_master_uri(),
                self.options.watchdog_period,
                reregister=self.options.on_master_loss == "reregister",
                expected=self._subscriptions.expected_types,
                end=self._ending.end,
                changed=self._report_now,
            )
            self._ending.on_end(self._watchdog.stop)
            self._watchdog.start()
        if self.options.diagnostics:
            name = rospy.get_name()
            title = f"{name.lstrip('/')}: {self._core.model_id}"
            self._diagnostics = Diagnostics(title, name, self._collect)
            self._ending.on_end(self._diagnostics.stop)
            self._diagnostics.start()

    @classmethod
    def main(cls, eddi_input_class: Any, eddi_monitor_class: Any, script_file: str) -> int:
        """Run the node of a generated package and return its exit status.

        Args:
            eddi_input_class: the generated EDDIInput.
            eddi_monitor_class: the generated EDDIMonitor.
            script_file: ``__file__`` of RosNode.py, beside which the model is looked for.

        Returns:
            0 after a normal end, 1 when it must not start or lost its name, 3 when the ROS
            master was lost for good.
        """
        name = start.node_name(cls.NAME)
        try:
            node = cls._prepare(name, eddi_input_class, eddi_monitor_class, script_file)
        except start.StartError as error:
            sys.stderr.write(f"{name}: error: {error}\n")
            return 1
        except KeyboardInterrupt:
            return 0
        try:
            rospy.init_node(cls.NAME)
        except rospy.ROSInitException as error:
            if rospy.is_shutdown():
                return 0  # ended while it waited for the ROS master
            sys.stderr.write(f"{name}: error: {error}\n")
            return 1
        return node.run()

    @classmethod
    def _prepare(
        cls, name: str, eddi_input_class: Any, eddi_monitor_class: Any, script_file: str
    ) -> "MonitorNode":
        """Do everything that can fail before anything is registered."""
        master = start.wait_for_master(name)
        start.refuse_duplicate(master, name)
        options, wrong = settings(start.private_parameters(master, name, sys.argv), cls.FREQUENCY)
        if wrong:
            raise start.StartError("; ".join(wrong))
        path = start.model_file(options.model, script_file, cls.NAME)
        try:
            monitor = eddi_monitor_class(str(path))
        except ModelError as error:
            raise start.StartError(str(error)) from error
        eddi_input = eddi_input_class()
        node = cls(monitor, eddi_input, options)
        eddi_input.bind(node._core.inputs)
        node._check_messages()
        return node

    def _check_messages(self) -> None:
        """Refuse to start with messages that cannot carry the result."""
        result = self._core.message(self._core.execute_step(_Nothing()))
        try:
            check_outputs(self._converter, result, self._core.status_message(), self.OUTPUTS)
        except MessageError as error:
            raise start.StartError(f"the messages do not fit the model: {error}") from error
        self._core.reset()


def _ignore() -> None:
    """Nothing to do on a message in rate mode."""
