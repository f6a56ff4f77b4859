"""rclpy in this process: one node, and a thread that hands over what arrives.

Signals are the monitor's own: rclpy would end its context while the last step still publishes.
"""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
import time
from typing import Any, Callable, Iterator, NamedTuple, Optional

import rclpy
import rclpy.subscription
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time

from ...node.loop import LOG, Ending
from ...node.start import StartError
from ...plain_values import one_line

try:  # since Iron
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
except ImportError:
    from rclpy.qos_event import SubscriptionEventCallbacks, UnsupportedEventTypeError

_WAIT_S = 0.2
_END_S = 0.5
_TELLS_TIMES = hasattr(rclpy.subscription, "MessageInfo")
"""Since Iron a callback is told when a message was sent."""
Receive = Callable[[Any, Optional[int]], None]
"""Takes a message, and when it was sent (nanoseconds of wall time), if that is known."""


class Publication(NamedTuple):
    """One publisher of a topic, anywhere on the graph."""

    type: str
    qos: QoSProfile


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
        """Return the node of rclpy."""
        return rclpy.create_node(name)

    def new_publisher(self, topic: str, cls: Any, qos: QoSProfile) -> Any:
        """Return a publisher of rclpy."""
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

        def made(**more: Any) -> Any:
            overriding = QoSOverridingOptions.with_default_policies()
            taken = with_time if _TELLS_TIMES else without
            return self.node.create_subscription(
                cls, topic, taken, qos, qos_overriding_options=overriding, **more
            )

        try:
            return made(event_callbacks=SubscriptionEventCallbacks(liveliness=changed))
        except UnsupportedEventTypeError:  # of this middleware: nothing is told of signs of life
            return made()

    def alive(self, topic: str) -> bool | None:
        """Return whether a publisher of a topic gives signs of life, ``None`` if untold."""
        signs = self._signs.get(topic)
        return None if signs is None else signs.alive_count > 0 or not signs.not_alive_count

    def forget_signs(self) -> None:
        """Forget who gave signs of life."""
        self._signs.clear()

    @contextlib.contextmanager
    def until(self, ending: Ending) -> Iterator[None]:
        """Be in a process that signals end, and leave the graph at last."""
        ending.install()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: ending.begin())
        LOG.start(self.writers())
        try:
            yield
        finally:
            ending.begin()
            ending.wait()  # before the log of rclpy goes
            self.close()

    def start(self) -> None:
        """Begin to receive."""
        self._thread.start()

    def _run(self) -> None:
        while not self._closed and rclpy.ok():
            self._spin()

    def _spin(self) -> None:
        """Hand over what arrives; never raises: who waits no more receives nothing more."""
        try:
            self._executor.spin_once(timeout_sec=_WAIT_S)
        except Exception as error:  # noqa: BLE001 - whatever the middleware raises
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
        if now.nanoseconds == 0:
            now = Time(nanoseconds=time.time_ns())
        return now.to_msg()

    def publications(self, topic: str) -> list[Publication]:
        """Return every publisher of a topic, by the name that the node uses for it."""
        with self._open:
            found = [] if self._closed else self.node.get_publishers_info_by_topic(topic)
        return [
            Publication(one.topic_type.replace("/msg/", "/"), one.qos_profile) for one in found
        ]

    def published(self) -> list[str]:
        """Return the full names of all topics that somebody publishes."""
        with self._open:
            known = [] if self._closed else self.node.get_topic_names_and_types()
            return [name for name, _ in known if self.node.count_publishers(name)]

    def namesakes(self) -> int:
        """Return how many nodes have the name of this one, with it."""
        with self._open:
            known = [] if self._closed else self.node.get_node_names_and_namespaces()
        return sum(f"{space.rstrip('/')}/{name}" == self.name for name, space in known)

    def writers(self) -> dict[str, Callable[..., None]]:
        """Return what writes the lines of the log."""
        log = self.node.get_logger()
        # one line each: rclpy remembers the level of every place that it is called from
        return {
            "info": lambda text, *values: log.info(_filled(text, values)),
            "warn": lambda text, *values: log.warning(_filled(text, values)),
            "error": lambda text, *values: log.error(_filled(text, values)),
        }

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
