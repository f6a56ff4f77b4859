"""The ROS 2 node of one monitor with a life cycle: a managed node of rclpy."""

from __future__ import annotations

from typing import Any, Callable, ClassVar

from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile

from ...node.life_cycle import LifeCycle
from ...node.start import LOG
from ...plain_values import one_line
from .node import MonitorNode
from .process import Process, Receive, declared


class _ManagedNode(LifecycleNode):  # type: ignore[misc]
    """A node of rclpy that hands its transitions over."""

    life: LifeCycle  # what they mean

    def on_configure(self, _: LifecycleState) -> TransitionCallbackReturn:
        return _done("configure", self.life.configure)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        done = _done("activate", self.life.prepare)
        if done == TransitionCallbackReturn.SUCCESS:
            super().on_activate(state)  # its publishers send from now on
            self.life.activate()
        return done

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.life.deactivate()
        return super().on_deactivate(state)

    def on_cleanup(self, _: LifecycleState) -> TransitionCallbackReturn:
        self.life.clean_up()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.on_deactivate(state)
        return self.on_cleanup(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.on_shutdown(state)


def _done(what: str, act: Callable[[], None]) -> TransitionCallbackReturn:
    """Return whether a transition succeeds; rclpy would not say why not."""
    try:
        act()
    except Exception as error:  # noqa: BLE001 - hand-written code may raise anything
        LOG.error("%s: %s", what, one_line(error))
        return TransitionCallbackReturn.FAILURE
    return TransitionCallbackReturn.SUCCESS


class ManagedProcess(Process):
    """A node of rclpy whose publishers send while it is active."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._publishers: dict[str, Any] = {}
        self._subscriptions: list[Any] = []

    def new_node(self, name: str) -> Any:
        return _ManagedNode(name)

    def new_publisher(self, topic: str, cls: Any, qos: QoSProfile) -> Any:
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_lifecycle_publisher(cls, topic, qos)
        return self._publishers[topic]

    def subscription(self, topic: str, cls: Any, qos: QoSProfile, receive: Receive) -> Any:
        made = super().subscription(topic, cls, qos, receive)
        self._subscriptions.append(made)
        return made

    def stop_listening(self) -> None:
        """Subscribe to nothing more: what a publisher keeps comes again with the next time."""
        while self._subscriptions:
            self.node.destroy_subscription(self._subscriptions.pop())
        self._signs.clear()

    def stop_publishing(self) -> None:
        while self._publishers:
            self.node.destroy_lifecycle_publisher(self._publishers.popitem()[1])


class ManagedMonitorNode(MonitorNode):
    """Base class of the generated RosNode where ``lifecycle: true`` is configured."""

    PROCESS: ClassVar[type[Process]] = ManagedProcess

    def init_publisher(self) -> None:
        super().init_publisher()
        if self.options.diagnostics:
            self.statuses()

    @classmethod
    def serve(cls, process: Any, make: Callable[[], MonitorNode]) -> int:
        meaning = "configure and activate the node at its start, nobody else does"
        node = process.node
        autostart = declared(node, "autostart", False, meaning)
        node.life = LifeCycle(process, make)

        def begin() -> None:
            if autostart and node.trigger_configure() == TransitionCallbackReturn.SUCCESS:
                node.trigger_activate()

        return int(node.life.run(begin))
