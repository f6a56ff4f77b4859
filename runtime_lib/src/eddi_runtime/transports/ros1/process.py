"""Start and end of a process with a node of rospy.

A start that cannot work ends before the node registers, so that the ROS graph never sees a broken
node. rospy's own shutdown talks to the ROS master without a time limit: a master that hangs, or a
host that vanished, would keep the process (and roslaunch) waiting.
"""

from __future__ import annotations

import sys
import time

import rosgraph
import rosgraph.names
import rospy
import rospy.client
import rospy.core
import rospy.names

from ...node.ending import Ending
from ...node.logs import LOG
from ...node.settings import Settings, settings
from ...node.start import StartError, write_to_stderr
from .master import Peer, Refused, Unreachable, answers_as

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
    """Return what a person has set, as soon as the master answers and nothing forbids a start.

    Raises:
        StartError: a living node has our name, or a parameter is wrong.
    """
    master = wait_for_master(node)
    _refuse_duplicate(master, node)
    given = _private_parameters(master, node)
    options, wrong = settings(given, frequency, startup_grace, ON_MASTER_LOSS)
    if wrong:
        raise StartError("; ".join(wrong))
    return options


def _refuse_duplicate(master: Peer, node: str) -> None:
    # The master would shut the other one down, with respawn on both sides for ever in turns.
    try:
        uri = master.uri_of(node)
    except Unreachable:
        return
    if uri is not None and answers_as(uri, node, node):
        raise StartError(f"a node with the name {node} is running at {uri}; nothing was started")


def _private_parameters(master: Peer, node: str) -> dict[str, object]:
    """Return the private parameters: the master's, then those of the command line."""
    try:
        given = master.call("getParam", node)
    except (Refused, Unreachable):
        given = {}
    parameters: dict[str, object] = dict(given) if isinstance(given, dict) else {}
    try:
        parameters.update(rospy.client.load_command_line_node_params(list(sys.argv)))
    except rospy.ROSInitException as error:
        raise StartError(str(error)) from error
    return parameters


class RosEnding(Ending):
    """The end of a process with a node of rospy: status 0, ``TAKEN_OVER`` or ``MASTER_LOST``."""

    def install(self) -> None:
        """Hear of every end that rospy knows; ``rospy.init_node`` has been called."""
        rospy.on_shutdown(self.begin)
        rospy.core.add_preshutdown_hook(self._explain)
        super().install()

    def end(self, status: int, reason: str) -> None:
        """End the process with a status."""
        LOG.error("ending with status %d: %s", status, reason)
        self.status = status
        rospy.signal_shutdown(reason)

    def wait(self) -> None:
        """Wait until the node is unregistered and all is logged; the guard limits the wait."""
        while self.begun and not rospy.is_shutdown():
            time.sleep(0.01)
        super().wait()

    def _explain(self, reason: str) -> None:
        if _REASON_OF_MASTER in reason:
            self.status = TAKEN_OVER
            LOG.error("the ROS master ended this node: another one has its name (%s)", reason)
