"""Everything before the node registers: its name, the master, its parameters.

A start that cannot work ends here, so that the ROS graph never sees a broken node.
"""

import sys
import time
from contextlib import contextmanager
from typing import Dict, Iterator

import rosgraph
import rosgraph.names
import rospy
import rospy.client
import rospy.names

from ...compatibility import ModelError
from ...node.settings import Settings, settings
from .master import Peer, Refused, Unreachable, answers_as

_ADVICE = "run `eddi-scaffold upgrade`, or `copier recopy --trust` in the package"
_POLL_S = 0.2


class StartError(Exception):
    """The node must not start; the text gives the reason for the user."""


@contextmanager
def reported(package: str) -> Iterator[None]:
    """End with one line, not a traceback, when the compiled monitor cannot be imported.

    Errors of hand-written modules keep their traceback.
    """
    try:
        yield
    except ModelError as error:
        reason = str(error)
    except SyntaxError as error:
        if not str(error.filename).endswith("compiled.py"):
            raise
        reason = f"{error.filename}: the file is damaged: {_ADVICE}"
    except ImportError as error:
        name = error.name or ""
        if name.partition(".")[0] != "eddi_runtime" and not name.endswith(".compiled"):
            raise
        reason = f"the package is not whole: {error}: {_ADVICE}"
    else:
        return
    _write_to_stderr(package, f"error: {reason}")
    sys.exit(1)


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
                _write_to_stderr(node, f"the ROS master does not answer, waiting for it ({error})")
            time.sleep(_POLL_S)
        else:
            if reported:
                _write_to_stderr(node, "the ROS master answers")
            return master


def options_of(node: str, frequency: float, startup_grace: float) -> Settings:
    """Return what a person has set, as soon as the master answers and nothing forbids a start.

    Args:
        node: its full name.
        frequency: of the generated node.
        startup_grace: of the generated node.

    Raises:
        StartError: a living node has our name, or a parameter is wrong.
    """
    master = wait_for_master(node)
    _refuse_duplicate(master, node)
    options, wrong = settings(_private_parameters(master, node), frequency, startup_grace)
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


def _private_parameters(master: Peer, node: str) -> Dict[str, object]:
    """Return the private parameters: the master's, then those of the command line."""
    try:
        given = master.call("getParam", node)
    except (Refused, Unreachable):
        given = {}
    parameters: Dict[str, object] = dict(given) if isinstance(given, dict) else {}
    try:
        parameters.update(rospy.client.load_command_line_node_params(list(sys.argv)))
    except rospy.ROSInitException as error:
        raise StartError(str(error)) from error
    return parameters


def _write_to_stderr(node: str, text: str) -> None:
    # rospy's log goes nowhere before init_node.
    sys.stderr.write(f"{node}: {text}\n")
    sys.stderr.flush()
