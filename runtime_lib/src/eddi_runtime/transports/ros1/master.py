"""XML-RPC to the ROS master and to other nodes, always with a time limit.

rospy's own proxies have none: a host that vanished, or a master that hangs, would block the
caller for minutes.
"""

from __future__ import annotations

import http.client
import xmlrpc.client
from typing import Dict, Tuple, Union

Address = Union[str, Tuple[str, Dict[str, str]]]
TIMEOUT_S = 2.0


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
    """One XML-RPC server: the master or the slave API of a node. Not for use by two threads.

    Every call of the ROS API carries the name of the node that calls.
    """

    def __init__(self, uri: str, caller: str, timeout: float = TIMEOUT_S) -> None:
        self.uri = uri
        self._caller = caller
        self._timeout = timeout

    def call(self, method: str, *arguments: object) -> object:
        """Call one method of the ROS master or slave API and return its value.

        Raises:
            Unreachable: no usable answer.
            Refused: the answer carries another status than success.
        """
        try:
            # A new connection per call: the master may have been restarted in between.
            proxy = xmlrpc.client.ServerProxy(self.uri, transport=_Transport(self._timeout))
            with proxy:
                answer = getattr(proxy, method)(self._caller, *arguments)
            status, text, value = answer
        except (
            OSError,
            http.client.HTTPException,
            xmlrpc.client.Error,
            ValueError,
            TypeError,
        ) as e:
            raise Unreachable(f"{self.uri}: {type(e).__name__}: {e}") from e
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

    A dead registration may point to a port that another node has by now, hence the name is
    asked for too; ``getName`` exists in rospy only, where it is missing ``getPid`` decides.
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
