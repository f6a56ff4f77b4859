"""All monitors of a workspace in one process: one node of ROS, a thread for each monitor.

Topics, parameters and names are those of separate nodes; a monitor that fails stops no other one.
"""

from __future__ import annotations

import sys
import threading
import traceback
from contextlib import contextmanager
from functools import partial
from typing import Any, Iterator

import rosgraph.names
import rospy
import rospy.names

from ...node.health import Diagnostics, Told
from ...node.node import REFUSALS, NewInput, NewMonitor
from ...node.report import ERROR, Report
from ...node.start import LOG, StartError, Waker, end_at_signals
from ...plain_values import one_line
from .node import MonitorNode, diagnostics_publisher, start_log
from .process import RosEnding, Watchdog, node_name, options_of


class Host:
    """The process; the generated program of the launcher fills it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._nodes: dict[str, MonitorNode] = {}
        self._failed: dict[str, str] = {}
        self._ending = RosEnding()

    @contextmanager
    def starting(self, package: str) -> Iterator[None]:
        """Go on without the monitor of a package if that cannot be started."""
        try:
            yield
        except REFUSALS as error:
            self._fail(package, str(error))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - hand-written code may raise anything
            traceback.print_exc()
            self._fail(package, one_line(error))

    def _fail(self, package: str, reason: str) -> None:
        name = _full_name(package)
        self._failed[name] = reason
        sys.stderr.write(f"{name}: error: {reason}\n")

    def add(
        self,
        node_class: type[MonitorNode],
        eddi_input_class: NewInput,
        eddi_monitor_class: NewMonitor,
    ) -> None:
        """Make the node of a monitor, without ROS; StartError where it must not start."""
        name = _full_name(node_class.NAME)
        options = options_of(name, node_class.FREQUENCY, node_class.STARTUP_GRACE)
        node = node_class(eddi_monitor_class(), eddi_input_class(), options)
        node.prepare()
        self._nodes[name] = node

    def run(self) -> int:
        end_at_signals()
        name = node_name(self._name)
        if not self._nodes:
            return 1
        try:
            options = options_of(name, MonitorNode.FREQUENCY, MonitorNode.STARTUP_GRACE)
            rospy.init_node(self._name)
        except (StartError, rospy.ROSInitException) as error:
            sys.stderr.write(f"{name}: error: {error}\n")
            return 0 if rospy.is_shutdown() else 1
        ended = Waker()
        self._ending.on_end(ended.wake)
        self._ending.install()
        start_log()
        LOG.named = True

        def report_now() -> None:
            for node in self._nodes.values():
                node.report_now()

        watchdog = None
        if options.watchdog_period:
            watchdog = Watchdog(options, self._ending, self._expected_types, report_now)
        diagnostics = Diagnostics(diagnostics_publisher())
        self._ending.on_end(diagnostics.stop)
        diagnostics.start()
        nodes: list[Any] = [*self._nodes.values()]
        # the messages of a topic are queued for all monitors if one takes each
        queued = {source.topic for node in nodes for source in node.INPUTS if source.every_message}
        for node in nodes:
            pairs = [(source, source.topic in queued) for source in node.INPUTS]
            node.INPUTS = [source._replace(every_message=every) for source, every in pairs]
        for own_name, node in self._nodes.items():
            threading.current_thread().name = own_name  # in the log
            with self.starting(own_name):
                node.share(self._ending, watchdog)
                node.begin(own_name, diagnostics)
                threading.Thread(target=node.ros_main, name=own_name, daemon=True).start()
        for failed, reason in self._failed.items():
            report = Report(ERROR, f"not started: {reason}", (), failed.lstrip("/"), failed)
            diagnostics.add(partial(lambda known, _: Told(known), report))
        if watchdog is not None:
            watchdog.start()
        while not self._ending.begun:
            ended.wait(threading.TIMEOUT_MAX)
        self._ending.wait()
        return self._ending.status

    def _expected_types(self) -> dict[str, tuple[str, str]]:
        nodes = self._nodes.values()
        return {topic: of for node in nodes for topic, of in node.expected_types().items()}


def _full_name(name: str) -> str:
    """Return the name of the node that a monitor would be by itself."""
    return str(rosgraph.names.resolve_name(name, rospy.names.get_caller_id()))
