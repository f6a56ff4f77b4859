"""Calls to the ROS master and to nodes (XML-RPC), with a time limit."""

from __future__ import annotations

import contextlib
import http.client
import socket
import threading
import xmlrpc.client
from typing import Any

TIMEOUT_S = 2.0
"""Of each wait."""
WHOLE_S = 10.0
"""Of a whole answer, however slowly it drips."""
_MAX_ANSWER = 16 * 1024 * 1024
"""Bytes: what a master says of 10,000 topics is a quarter of it."""
_UNREACHABLE = (OSError, http.client.HTTPException, xmlrpc.client.Error, ValueError, TypeError)


class CallError(Exception):
    """There is no answer, or it is no."""


class _Connection(http.client.HTTPConnection):
    reached: socket.socket | None = None

    def connect(self) -> None:
        super().connect()
        self.reached = self.sock  # which is forgotten there once an answer begins


class _Transport(xmlrpc.client.Transport):
    accept_gzip_encoding = False  # a limit of size is one of what arrives
    made: _Connection | None = None
    ended = False

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        if self.ended:  # it is tried twice
            raise CallError(f"no answer within {WHOLE_S:g} s")
        name, self._extra_headers, _ = self.get_host_info(host)
        self.made = _Connection(str(name), timeout=TIMEOUT_S)
        self._connection = host, self.made
        return self.made

    def parse_response(self, response: Any) -> Any:
        body = response.read(_MAX_ANSWER + 1)
        if len(body) > _MAX_ANSWER:
            raise CallError(f"an answer of more than {_MAX_ANSWER} bytes")
        parser, values = self.getparser()
        parser.feed(body)
        parser.close()
        return values.close()

    def end(self) -> None:
        """Let who waits for the answer go."""
        self.ended = True
        reached = None if self.made is None else self.made.reached
        if reached is not None:
            with contextlib.suppress(OSError):
                reached.shutdown(socket.SHUT_RDWR)


def call(uri: str, caller: str, method: str, *arguments: object) -> Any:
    """Return the value of a call of the ROS master API or slave API.

    Raises:
        CallError: there is no usable answer.
    """
    transport = _Transport()
    clock = threading.Timer(WHOLE_S, transport.end)
    clock.daemon = True
    clock.start()
    try:
        with xmlrpc.client.ServerProxy(uri, transport=transport) as proxy:
            answer: Any = getattr(proxy, method)(caller, *arguments)
        status, text, value = answer
    except _UNREACHABLE as problem:
        raise CallError(f"{uri} does not answer: {problem}") from None
    finally:
        clock.cancel()
    if status != 1:
        raise CallError(str(text))
    return value
