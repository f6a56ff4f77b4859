"""Check the ROS master every few seconds, in a thread of its own.

A rospy node registers once: when roscore is restarted it stays unknown without any report. The
watchdog registers it again, or ends the process so that ``respawn`` brings it back. It also finds
a second node of the same name and publishers whose message type does not fit.
"""

from __future__ import annotations

import logging
import threading
import time
from typing import Any, Callable, Dict, Tuple

import rosgraph
import rospy
import rospy.impl.registration

from ...node.loop import LOG
from ...node.start import Settings
from .process import MASTER_LOST, TAKEN_OVER, Peer, Refused, RosEnding, Unreachable, answers_as

OK, LOST, REREGISTERED = "ok", "lost", "re-registered"
_ATTEMPTS = 3
_REFUSALS = ("md5sum", "types do not match")
Wrong = Dict[str, Tuple[float, str]]
"""Topic -> since when (monotonic seconds) its publisher does not fit, and why."""
Expected = Callable[[], Dict[str, Tuple[str, str]]]
"""Returns resolved topic -> (input id, ROS type name) of all subscriptions."""


class TypeRefusals(logging.Handler):
    """Hears when a publisher refuses our subscription because of its message type.

    rospy writes that into its log file only. The connecting thread has the name of the topic.
    """

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.heard: Wrong = {}

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the reason of a refused connection."""
        text = record.getMessage()
        if text.startswith("unable to create subscriber") and any(x in text for x in _REFUSALS):
            reason = text.partition("remote error reported: ")[2] or text
            topic = str(record.threadName)
            known = self.heard.get(topic)
            self.heard[topic] = (time.monotonic(), reason)
            if known is None or known[1] != reason:  # rospy tries again for ever
                LOG.error("the publisher of %s refuses this node: %s", topic, reason)

    def install(self) -> None:
        """Begin to listen."""
        logging.getLogger("rospy.internal").addHandler(self)


def standing(known: tuple[float, str] | None, last_receipt: float | None) -> str:
    """Return what is wrong with a publisher, empty once a message came since: it may be gone."""
    if known is None or (last_receipt is not None and last_receipt > known[0]):
        return ""
    return known[1]


class Watchdog:
    """Compares what the master knows with what this node is.

    ``changed`` is called whenever ``state`` or ``wrong_types`` changed.
    """

    def __init__(
        self, options: Settings, ending: RosEnding, expected: Expected, changed: Callable[[], None]
    ) -> None:
        self.state = OK  # of the master
        self.wrong_types: Wrong = {}
        # topics with a publisher -> type, when the master was asked last
        self.published: dict[str, str | None] | None = None
        self.shared: set[str] = set()  # topics with more than one publisher, then
        self._node = str(rospy.get_name())
        self._own_uri = str(rospy.get_node_uri())
        self._master = Peer(rosgraph.get_master_uri(), self._node)
        self._period = options.watchdog_period
        self._reregister = options.words.get("on_master_loss") != "exit"
        self._expected, self._end, self._changed = expected, ending.end, changed
        self._failures = 0
        # The event is only ever waited for in our own thread, so a signal handler cannot deadlock.
        self._stop = threading.Event()
        ending.on_end(self._stop.set)

    def start(self) -> None:
        """Begin to watch."""
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
        self.shared = {topic for topic, names in nodes.items() if len(names) > 1}
        # Only topics with a publisher: the master keeps the types of all others, too.
        self.published = {topic: types.get(topic) for topic, names in nodes.items() if names}
        wrong: Wrong = {}
        for topic, (_, expected) in self._expected().items():
            sent = self.published.get(topic)
            if sent not in (None, "*", expected):
                text = f"{expected} expected, the publisher sends {sent}"
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
            self._failures += 1
            LOG.error("cannot register again (%d of %d): %s", self._failures, _ATTEMPTS, error)
            self.state = LOST
            if self._failures >= _ATTEMPTS:
                self._end(MASTER_LOST, f"cannot register again at the ROS master: {error}")
            return
        self._failures = 0
        self.state = REREGISTERED
        LOG.warn("the ROS master did not know this node any more: registered again")


def watch(
    options: Settings, ending: RosEnding, expected: Expected, changed: Callable[[], None]
) -> Watchdog | None:
    """Return the watchdog of this process, ``None`` where a person wants none."""
    return Watchdog(options, ending, expected, changed) if options.watchdog_period else None


def reregister(master: Peer, node: str, own_uri: str) -> None:
    """Register at a new master all that rospy itself registered at the former one.

    Both managers are inner parts of rospy (ros_comm 1.15.15): a test guards this per version.
    """
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
