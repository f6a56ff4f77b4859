"""The process of a node of rospy: its start, its end, and a look at the master every few seconds.

What cannot work ends before the node registers. XML-RPC has a time limit here, which rospy's own
proxies have not. A rospy node registers once: after a restart of roscore it stays unknown.
"""

from __future__ import annotations

import http.client
import logging
import sys
import threading
import time
import xmlrpc.client
from contextlib import suppress
from typing import Any, Callable, Dict, Tuple, Union

import rosgraph
import rosgraph.names
import rospy
import rospy.client
import rospy.core
import rospy.impl.registration
import rospy.names

from ...node.start import LOG, Ending, Settings, StartError, settings, write_to_stderr
from ...node.topics import other_type

Address = Union[str, Tuple[str, Dict[str, str]]]
TIMEOUT_S = 2.0
_NO_ANSWER = (OSError, http.client.HTTPException, xmlrpc.client.Error, ValueError, TypeError)


class _Transport(xmlrpc.client.Transport):
    def __init__(self, timeout: float) -> None:
        super().__init__()
        self._timeout = timeout

    def make_connection(self, host: Address) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = self._timeout
        return connection


class Unreachable(Exception):  # noqa: N818 - a state of the network, not a fault
    """The other side did not answer in time, or answered nonsense."""


class Refused(Exception):  # noqa: N818 - the answer "no"
    """The other side answered that the call failed; the text is its reason."""


class Peer:
    """One XML-RPC server: the master or the slave API of a node. Not for use by two threads."""

    def __init__(self, uri: str, caller: str, timeout: float = TIMEOUT_S) -> None:
        self.uri, self._caller, self._timeout = uri, caller, timeout

    def call(self, method: str, *arguments: object) -> object:
        """Return the value of a method of the master or slave API; Unreachable, Refused."""
        try:
            # A new connection per call: the master may have been restarted in between.
            with xmlrpc.client.ServerProxy(self.uri, transport=_Transport(self._timeout)) as proxy:
                status, text, value = getattr(proxy, method)(self._caller, *arguments)
        except _NO_ANSWER as error:
            raise Unreachable(f"{self.uri}: {type(error).__name__}: {error}") from error
        if status != 1:
            raise Refused(str(text))
        return value

    def uri_of(self, node: str) -> str | None:
        try:
            return str(self.call("lookupNode", node))
        except Refused:
            return None


def answers_as(uri: str, node: str, caller: str) -> bool:
    """Return whether a living node of this name answers at an address."""
    # Another node may have the port of a dead one by now; but only rospy has ``getName``.
    peer = Peer(uri, caller)
    try:
        peer.call("getPid")
    except (Unreachable, Refused):
        return False
    try:
        return bool(peer.call("getName") == node)
    except (Unreachable, Refused):
        return True


ON_MASTER_LOSS = {"on_master_loss": ("reregister", "exit")}
"""Parameter of a node for a new master that does not know it."""
TAKEN_OVER, MASTER_LOST = 1, 3
_REASON_OF_MASTER = "new node registered with same name"
_POLL_S = 0.2


def node_name(name: str) -> str:
    """Return the full node name after ``__name``, ``__ns`` and ROS_NAMESPACE."""
    remapped = rospy.names.get_mappings().get("__name", name)
    # The same call as in rospy.init_node, which has not run yet.
    return str(rosgraph.names.resolve_name(remapped, rospy.names.get_caller_id()))


def wait_for_master(node: str) -> Peer:
    """Return the master as soon as it answers; one line on stderr when that takes long."""
    uri = rosgraph.get_master_uri()
    if not str(uri).startswith(("http://", "https://")):
        raise StartError(f"ROS_MASTER_URI is no http address: {uri}")
    master = Peer(uri, node)
    reported = False
    while True:
        try:
            with suppress(Refused):
                master.call("getPid")
            break
        except Unreachable as error:
            if not reported:
                reported = True
                write_to_stderr(node, f"the ROS master does not answer, waiting for it ({error})")
            time.sleep(_POLL_S)
    if reported:
        write_to_stderr(node, "the ROS master answers")
    return master


def options_of(node: str, frequency: float, startup_grace: float) -> Settings:
    """Return what a person has set, as soon as the master answers; StartError forbids a start."""
    master = wait_for_master(node)
    with suppress(Unreachable):
        # The master would shut the other one down, with respawn on both sides for ever in turns.
        uri = master.uri_of(node)
        if uri is not None and answers_as(uri, node, node):
            reason = f"a node with the name {node} is running at {uri}; nothing was started"
            raise StartError(reason)
    try:
        held = master.call("getParam", node)
    except (Refused, Unreachable):
        held = {}
    parameters: dict[str, object] = dict(held) if isinstance(held, dict) else {}
    try:
        parameters.update(rospy.client.load_command_line_node_params(list(sys.argv)))
    except rospy.ROSInitException as error:
        raise StartError(str(error)) from error
    return settings(parameters, frequency, startup_grace, ON_MASTER_LOSS)


class RosEnding(Ending):
    """The end of a process with a node of rospy: status 0, ``TAKEN_OVER`` or ``MASTER_LOST``."""

    def install(self) -> None:
        rospy.on_shutdown(self.begin)
        rospy.core.add_preshutdown_hook(self._explain)
        super().install()

    def end(self, status: int, reason: str) -> None:
        LOG.error("ending with status %d: %s", status, reason)
        self.status = status
        rospy.signal_shutdown(reason)

    def wait(self) -> None:
        while self.begun and not rospy.is_shutdown():
            time.sleep(0.01)
        super().wait()

    def _explain(self, reason: str) -> None:
        if _REASON_OF_MASTER in reason:
            self.status = TAKEN_OVER
            LOG.error("the ROS master ended this node: another one has its name (%s)", reason)


OK, LOST, REREGISTERED = "ok", "lost", "re-registered"
_REFUSALS = ("md5sum", "types do not match")
Wrong = Dict[str, Tuple[float, str]]
"""Topic -> since when (monotonic seconds) its publisher does not fit, and why."""
Expected = Callable[[], Dict[str, Tuple[str, str]]]
"""Returns resolved topic -> (input id, ROS type name) of all subscriptions."""


class TypeRefusals(logging.Handler):
    """Tells that a publisher refuses our message type: rospy writes it into its log file only."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self._known: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        text, topic = record.getMessage(), str(record.threadName)  # which connects to it
        if text.startswith("unable to create subscriber") and any(x in text for x in _REFUSALS):
            if topic not in self._known:  # rospy tries again for ever
                LOG.error("the publisher of %s refuses this node: %s", topic, text)
            self._known.add(topic)


class Watchdog:
    """Compares what the master knows with this node; ``changed`` is called when that changed."""

    def __init__(
        self, options: Settings, ending: RosEnding, expected: Expected, changed: Callable[[], None]
    ) -> None:
        self.state = OK  # of the master
        self.wrong_types: Wrong = {}
        # topics with a publisher -> type, when the master was asked last
        self.published: dict[str, str | None] = {}
        self._node = str(rospy.get_name())
        self._own_uri = str(rospy.get_node_uri())
        self._master = Peer(rosgraph.get_master_uri(), self._node)
        self._period = options.watchdog_period
        self._reregister = options.words.get("on_master_loss") != "exit"
        self._expected, self._end, self._changed = expected, ending.end, changed
        # The event is only ever waited for in our own thread, so a signal handler cannot deadlock.
        self._stop = threading.Event()
        ending.on_end(self._stop.set)

    def start(self) -> None:
        threading.Thread(target=self._run, name="master watchdog", daemon=True).start()

    def _run(self) -> None:
        while not self._stop.wait(self._period):
            before = (self.state, self.wrong_types)
            try:
                self.look()
            except Exception as error:  # noqa: BLE001 - a watchdog that dies watches nothing
                LOG.error("master watchdog: %s: %s", type(error).__name__, error)
            if before != (self.state, self.wrong_types):
                self._changed()

    def look(self) -> None:
        """Look once: is the master there, does it know this node, do the types fit?"""
        try:
            uri = self._master.uri_of(self._node)
        except Unreachable as error:
            if self.state != LOST:
                LOG.warn("the ROS master does not answer, going on without it: %s", error)
            self.state = LOST
            return
        if uri is not None and uri != self._own_uri:
            if answers_as(uri, self._node, self._node):
                self._end(TAKEN_OVER, f"another node has taken the name {self._node}: {uri}")
                return
            uri = None  # a dead registration of our name
        topics: Any = rospy.impl.registration.get_topic_manager()
        publishing = [topic for topic, _ in topics.get_publications()]
        try:
            state: Any = self._master.call("getSystemState")
            nodes = dict(state[0])
            kinds: Any = self._master.call("getTopicTypes")
            types = dict(kinds)
        except (Unreachable, Refused):
            return
        # Any single call may have made a new master know the node, but not all of its topics.
        if uri is None or not all(self._node in nodes.get(topic, ()) for topic in publishing):
            self._return()
        elif self.state == LOST:
            LOG.info("the ROS master answers again and still knows this node")
            self.state = OK
        # Only topics with a publisher: the master keeps the types of all others, too.
        self.published = {topic: types.get(topic) for topic, names in nodes.items() if names}
        wrong: Wrong = {}
        for topic, (_, expected) in self._expected().items():
            sent = self.published.get(topic)
            if sent not in (None, "*", expected):
                text = other_type(str(sent), expected).text
                known = self.wrong_types.get(topic)
                if known is None or known[1] != text:
                    LOG.error("wrong message type on %s: %s", topic, text)
                    known = time.monotonic(), text
                wrong[topic] = known
        self.wrong_types = wrong

    def _return(self) -> None:
        """Make a master that does not know this node know it, or end."""
        if not self._reregister:
            self._end(MASTER_LOST, "the ROS master does not know this node any more (restarted?)")
            return
        try:
            reregister(self._master, self._node, self._own_uri)
        except (Unreachable, Refused) as error:
            LOG.error("cannot register again, trying it with the next look: %s", error)
            self.state = LOST
            return
        self.state = REREGISTERED
        LOG.warn("the ROS master did not know this node any more: registered again")


def reregister(master: Peer, node: str, own_uri: str) -> None:
    """Register at a new master all that rospy itself registered at the former one."""
    # Both managers are inner parts of rospy (ros_comm 1.15.15): a test guards this per version.
    topics: Any = rospy.impl.registration.get_topic_manager()
    services: Any = rospy.impl.registration.get_service_manager()
    own = Peer(own_uri, node)
    for topic, kind in topics.get_publications():
        master.call("registerPublisher", topic, kind, own_uri)
    for topic, kind in topics.get_subscriptions():
        publishers = master.call("registerSubscriber", topic, kind, own_uri)
        own.call("publisherUpdate", topic, publishers)
    for service, uri in services.get_services():
        master.call("registerService", service, uri, own_uri)
