"""Start and end of a process with a node of rospy.

What cannot work ends before the node registers, so that the graph never sees a broken node. XML-
RPC to the master and to other nodes has a time limit here, which rospy's own proxies have not.
"""

from __future__ import annotations

import http.client
import sys
import time
import xmlrpc.client
from contextlib import suppress
from typing import Dict, Tuple, Union

import rosgraph
import rosgraph.names
import rospy
import rospy.client
import rospy.core
import rospy.names

from ...node.loop import LOG, Ending
from ...node.start import Settings, StartError, settings, write_to_stderr

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
        """Return the address of a node, ``None`` when this master does not know it."""
        try:
            return str(self.call("lookupNode", node))
        except Refused:
            return None


def answers_as(uri: str, node: str, caller: str) -> bool:
    """Return whether a living node of this name answers at an address.

    A dead registration may point to a port that another node has by now, so the name is asked for;
    ``getName`` exists in rospy only, where it is missing ``getPid`` decides.
    """
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
    given = rospy.names.get_mappings().get("__name", name)
    # The same call as in rospy.init_node, which has not run yet.
    return str(rosgraph.names.resolve_name(given, rospy.names.get_caller_id()))


def wait_for_master(node: str) -> Peer:
    """Return the master as soon as it answers; one line on stderr when that takes long."""
    uri = rosgraph.get_master_uri()
    if not str(uri).startswith(("http://", "https://")):
        raise StartError(f"ROS_MASTER_URI is no http address: {uri}")
    master = Peer(uri, node)
    reported = False
    while True:
        try:
            master.call("getPid")
        except Refused:  # noqa: PERF203 - waits anyway
            return master
        except Unreachable as error:
            if not reported:
                reported = True
                write_to_stderr(node, f"the ROS master does not answer, waiting for it ({error})")
            time.sleep(_POLL_S)
        else:
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
    given: dict[str, object] = dict(held) if isinstance(held, dict) else {}
    try:
        given.update(rospy.client.load_command_line_node_params(list(sys.argv)))
    except rospy.ROSInitException as error:
        raise StartError(str(error)) from error
    return settings(given, frequency, startup_grace, ON_MASTER_LOSS)


class RosEnding(Ending):
    """The end of a process with a node of rospy: status 0, ``TAKEN_OVER`` or ``MASTER_LOST``."""

    def install(self) -> None:
        rospy.on_shutdown(self.begin)
        rospy.core.add_preshutdown_hook(self._explain)
        super().install()

    def end(self, status: int, reason: str) -> None:
        """End the process with a status."""
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
