"""The ROS 2 node of one monitor with a life cycle: others say when it monitors.

Configured, it has its publishers. Active, it listens and steps, as a monitor that knows nothing of
before; the last that it publishes is that nothing is known, so whoever comes later hears no more.
"""

import threading
from typing import Any, Callable, ClassVar, Dict, List, Optional, Type

from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile

from ...node.ending import Ending
from ...node.logs import LOG
from ...node.schedule import Waker
from ...plain_values import one_line
from .node import MonitorNode
from .parameters import declared
from .process import Process, Receive

__all__ = ["ManagedMonitorNode"]

_STEP_S = 5.0
"""A step that takes longer is left behind when the node is deactivated."""
Make = Callable[[], MonitorNode]


class _ManagedNode(LifecycleNode):  # type: ignore[misc]
    """A node of rclpy that hands its transitions over.

    Attributes:
        life: what they mean.
    """

    life: "LifeCycle"

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
        self._publishers: Dict[str, Any] = {}
        self._subscriptions: List[Any] = []

    def new_node(self, name: str) -> Any:
        """Return the node of rclpy."""
        return _ManagedNode(name)

    def new_publisher(self, topic: str, cls: Any, qos: QoSProfile) -> Any:
        """Return the publisher of a topic, the same one for each activation."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_lifecycle_publisher(cls, topic, qos)
        return self._publishers[topic]

    def subscription(self, topic: str, cls: Any, qos: QoSProfile, receive: Receive) -> Any:
        """Subscribe to a topic."""
        made = super().subscription(topic, cls, qos, receive)
        self._subscriptions.append(made)
        return made

    def stop_listening(self) -> None:
        """Subscribe to nothing more: then what a publisher keeps comes again with the next time."""
        while self._subscriptions:
            self.node.destroy_subscription(self._subscriptions.pop())

    def stop_publishing(self) -> None:
        """Advertise nothing more."""
        while self._publishers:
            self.node.destroy_lifecycle_publisher(self._publishers.popitem()[1])


class LifeCycle:
    """What the states of a managed node mean: which monitor there is, and whether it steps.

    Transitions are those of rclpy's thread; steps are in the one that calls ``run``.

    Args:
        process: of the managed node.
        make: returns a monitor that knows nothing.
    """

    def __init__(self, process: ManagedProcess, make: Make) -> None:
        self._process = process
        self._make = make
        self._next: Optional[MonitorNode] = None
        self._active: Optional[MonitorNode] = None
        self._waker = Waker()
        self._idle = threading.Event()
        self._idle.set()
        self.ending = Ending()

    def run(self, *, autostart: bool) -> int:
        """Follow the transitions until the process is to end; return the exit status.

        Args:
            autostart: be active at once.
        """
        node = self._process.node
        node.life = self
        with self._process.until(self.ending):
            self.ending.on_end(self._stop)
            if autostart and node.trigger_configure() == TransitionCallbackReturn.SUCCESS:
                node.trigger_activate()
            self._process.start()
            while not self.ending.begun:
                self._waker.wait(threading.TIMEOUT_MAX)
                self._step()
        return self.ending.status

    def _stop(self) -> None:
        active = self._active
        if active is not None:
            active.ending.begin()
        self._waker.wake()

    def _step(self) -> None:
        active = self._active
        if active is None:
            return
        if self.ending.begun:  # before it could be told
            active.ending.begin()
        active.run(lambda: None)
        active.withdraw()
        self._active = None
        self._idle.set()

    def configure(self) -> None:
        """Have a monitor, and publishers that do not send yet.

        Raises:
            Exception: whatever is wrong with it.
        """
        self._next = self._make()
        self._next.prepare()
        self._next.init_publisher()

    def prepare(self) -> None:
        """Have a monitor that knows nothing.

        Raises:
            Exception: whatever is wrong with it.
        """
        if not self._idle.is_set():
            raise RuntimeError("the last step has not ended yet")
        self._next = self._next or self._make()

    def activate(self) -> None:
        """Let it listen and step."""
        self._active, self._next = self._next, None
        self._idle.clear()
        self._waker.wake()

    def deactivate(self) -> None:
        """Have it end."""
        self._stop()
        if not self._idle.wait(_STEP_S):
            LOG.error("deactivate: a step has not ended within %g s, it is left behind", _STEP_S)
        self._process.stop_listening()

    def clean_up(self) -> None:
        """Have nothing."""
        self._next = None
        self._process.stop_publishing()


class ManagedMonitorNode(MonitorNode):
    """Base class of the generated RosNode where ``lifecycle: true`` is configured."""

    PROCESS: ClassVar[Type[Process]] = ManagedProcess

    @classmethod
    def serve(cls, process: Any, make: Make) -> int:
        """Run a managed node until its process is to end; return the exit status.

        Args:
            process: a ``PROCESS``.
            make: returns a node that knows nothing.
        """
        meaning = "configure and activate the node at its start, nobody else does"
        autostart = declared(process.node, "autostart", False, meaning)
        return LifeCycle(process, make).run(autostart=autostart)
