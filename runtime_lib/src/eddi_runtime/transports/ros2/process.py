"""rclpy in this process: one node with its parameters and QoS, and a thread that hands over.

Signals are the monitor's own: rclpy would end its context while the last step still publishes.
"""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
import time
from functools import partial
from typing import Any, Callable, Iterable, Iterator, Mapping, Optional

import rclpy
import rclpy.subscription
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.duration import Duration
from rclpy.exceptions import ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time

from ...node.report import Reason, offer
from ...node.start import FREQUENCIES, LOG, Ending, Settings, StartError, settings
from ...plain_values import one_line

try:  # since Iron
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
except ImportError:
    from rclpy.qos_event import SubscriptionEventCallbacks, UnsupportedEventTypeError

_WAIT_S = 0.2
_END_S = 0.5
_MOST_QUEUED = 1_000_000
_TELLS_TIMES = hasattr(rclpy.subscription, "MessageInfo")
"""Since Iron a callback is told when a message was sent."""
Receive = Callable[[Any, Optional[int]], None]
"""Takes a message, and when it was sent (nanoseconds of wall time), if that is known."""


def declared_settings(node: Any, frequency: float, startup_grace: float) -> Settings:
    """Declare the parameters of a node of rclpy; return what a person set (StartError)."""
    grace = "seconds in which an input may wait for its first message"
    queue = "messages that wait for a slow subscriber of the outputs"
    robot = "name of this robot among others, empty for the configured one"
    whole = {"integer_range": [IntegerRange(from_value=1, to_value=_MOST_QUEUED, step=1)]}
    rows: list[tuple[str, object, str, dict[str, Any]]] = [
        ("frequency", frequency, "steps per second", _between(*FREQUENCIES)),
        ("diagnostics", True, "publish a summary on /diagnostics", {}),
        ("startup_grace", startup_grace, grace, _between(0.0, sys.float_info.max)),
        ("robot", "", robot, {}),
        ("queue_size", 1, queue, whole),
    ]
    values = {
        name: declared(node, name, default, text, **more) for name, default, text, more in rows
    }
    return settings(values, frequency, startup_grace)


def declared(node: Any, name: str, default: object, meaning: str, **ranges: Any) -> Any:
    """Declare a parameter; return what a person has set, or raise StartError."""
    # Read once, so nobody can set them later; 10 is as good a number as 10.0.
    descriptor = ParameterDescriptor(
        description=meaning, read_only=True, dynamic_typing=isinstance(default, float), **ranges
    )
    try:
        return node.declare_parameter(name, default, descriptor).value
    except ParameterException as error:
        raise StartError(f"parameter {name}: {error.args[0]}") from error


def _between(low: float, high: float) -> dict[str, Any]:
    made = FloatingPointRange(from_value=low, to_value=high, step=0.0)
    return {"floating_point_range": [made]}


_FOR_EVER_NS = 2**62
"""Whatever is longer: what counts as infinite depends on the middleware and the release."""


def profile(qos: Mapping[str, Any]) -> QoSProfile:
    """Return a quality of service as rclpy has it."""
    times = {k: Duration(seconds=qos[k]) for k in ("deadline", "lifespan") if k in qos}
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=qos["depth"],
        reliability=getattr(ReliabilityPolicy, qos["reliability"].upper()),
        durability=getattr(DurabilityPolicy, qos["durability"].upper()),
        **times,
    )


def keeps(profile: QoSProfile) -> bool:
    """Return whether a reader gets messages of before it was there, which may be of any age."""
    return bool(profile.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def refused(reader: QoSProfile, writers: Iterable[QoSProfile]) -> Reason | None:
    """Return what of every writer is less than a reader asks for, None when one fits."""
    first: Reason | None = None
    reliable = reader.reliability == ReliabilityPolicy.RELIABLE
    asked = deadline([reader])
    for writer in writers:
        promised = deadline([writer])
        if reliable and writer.reliability == ReliabilityPolicy.BEST_EFFORT:
            first = first or offer("best_effort", "reliable")
        elif keeps(reader) and writer.durability == DurabilityPolicy.VOLATILE:
            first = first or offer("volatile", "transient_local")
        elif asked and (promised is None or promised > asked):
            offered = "no deadline" if promised is None else f"a deadline of {promised:g} s"
            first = first or offer(offered, f"{asked:g} s")
        else:
            return None
    return first


def deadline(writers: Iterable[QoSProfile]) -> float | None:
    """Return the shortest deadline in seconds; ROS 2 writes none as zero, and as the longest."""
    times = [writer.deadline.nanoseconds for writer in writers]
    return min((ns / 1e9 for ns in times if 0 < ns < _FOR_EVER_NS), default=None)


class Process:
    """A node of rclpy; StartError where an argument is wrong, or there is no middleware."""

    def __init__(self, name: str) -> None:
        try:
            rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
            self.node: Any = self.new_node(name)  # of rclpy
        except Exception as error:  # rclpy has no base of what it raises for arguments and names
            rclpy.try_shutdown()
            raise StartError(one_line(error)) from error
        self.name = str(self.node.get_fully_qualified_name())  # full name of the node
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._run, name="rclpy", daemon=True)
        self._signs: dict[str, Any] = {}
        self._closed = False
        self._open = threading.RLock()

    def new_node(self, name: str) -> Any:
        return rclpy.create_node(name)

    def new_publisher(self, topic: str, cls: Any, qos: QoSProfile) -> Any:
        return self.node.create_publisher(cls, topic, qos)

    def publisher(self, topic: str, cls: Any, qos: QoSProfile) -> Callable[[Any], None]:
        """Return what publishes to a topic; after the end it does nothing."""
        publisher = self.new_publisher(topic, cls, qos)

        def publish(message: Any) -> None:
            with self._open:
                if not self._closed:
                    publisher.publish(message)

        return publish

    def subscription(self, topic: str, cls: Any, qos: QoSProfile, receive: Receive) -> Any:
        """Subscribe to a topic; a person may override its QoS by parameters."""

        def with_time(message: Any, info: Any) -> None:
            receive(message, info["source_timestamp"])

        def without(message: Any) -> None:
            receive(message, None)

        def changed(signs: Any) -> None:
            self._signs[topic] = signs

        more: Any = {"qos_overriding_options": QoSOverridingOptions.with_default_policies()}
        taken = with_time if _TELLS_TIMES else without
        make = partial(self.node.create_subscription, cls, topic, taken, qos, **more)
        try:
            return make(event_callbacks=SubscriptionEventCallbacks(liveliness=changed))
        except UnsupportedEventTypeError:  # of this middleware: nothing is told of signs of life
            return make()

    def alive(self, topic: str) -> bool | None:
        """Return whether a publisher of a topic gives signs of life, ``None`` if untold."""
        signs = self._signs.get(topic)
        return None if signs is None else signs.alive_count > 0 or not signs.not_alive_count

    @contextlib.contextmanager
    def until(self, ending: Ending) -> Iterator[None]:
        """Be in a process that signals end, and leave the graph at last."""
        ending.install()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: ending.begin())
        log = self.node.get_logger()
        # one line each: rclpy remembers the level of every place that it is called from
        writers: dict[str, Callable[..., None]] = {
            "info": lambda text, *values: log.info(_filled(text, values)),
            "warn": lambda text, *values: log.warning(_filled(text, values)),
            "error": lambda text, *values: log.error(_filled(text, values)),
        }
        LOG.start(writers)
        try:
            yield
        finally:
            ending.begin()
            ending.wait()  # before the log of rclpy goes
            self.close()

    def start(self) -> None:
        self._thread.start()

    def _run(self) -> None:
        """Hand over what arrives; never raises: who waits no more receives nothing more."""
        while not self._closed and rclpy.ok():
            try:
                self._executor.spin_once(timeout_sec=_WAIT_S)
            except Exception as error:  # noqa: BLE001, PERF203 - whatever the middleware raises
                if rclpy.ok():
                    LOG.error("rclpy: %s", one_line(error))
                    time.sleep(_WAIT_S)

    def simulated_ns(self) -> int | None:
        """Return the time of ``/clock``, None where the node has wall time."""
        clock = self.node.get_clock()
        return int(clock.now().nanoseconds) if clock.ros_time_is_active else None

    def stamp(self) -> object:
        """Return the time for a header: ROS time, wall time while there is none (no /clock)."""
        now = self.node.get_clock().now()
        return (now if now.nanoseconds else Time(nanoseconds=time.time_ns())).to_msg()

    def publications(self, topic: str) -> list[tuple[str, QoSProfile]]:
        """Return type and QoS of every publisher of a topic, anywhere on the graph."""
        with self._open:
            infos = [] if self._closed else self.node.get_publishers_info_by_topic(topic)
        return [(info.topic_type.replace("/msg/", "/"), info.qos_profile) for info in infos]

    def published(self) -> list[str]:
        with self._open:
            known = [] if self._closed else self.node.get_topic_names_and_types()
            return [name for name, _ in known if self.node.count_publishers(name)]

    def namesakes(self) -> int:
        with self._open:
            known = [] if self._closed else self.node.get_node_names_and_namespaces()
        return sum(f"{space.rstrip('/')}/{name}" == self.name for name, space in known)

    def close(self) -> None:
        """Leave the graph, once nobody receives, publishes or asks any more."""
        with self._open:
            self._closed = True
        self._executor.wake()
        if self._thread.is_alive():
            self._thread.join()
        self._executor.shutdown(timeout_sec=_END_S)
        self.node.destroy_node()
        rclpy.try_shutdown()


def _filled(text: str, values: Any) -> str:
    return text % values if values else text
