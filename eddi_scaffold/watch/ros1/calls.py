"""Calls to the ROS master and to nodes (XML-RPC), with a time limit."""

from __future__ import annotations

import http.client
import xmlrpc.client
from typing import Any

TIMEOUT_S = 2.0
_UNREACHABLE = (OSError, http.client.HTTPException, xmlrpc.client.Error, ValueError, TypeError)


class CallError(Exception):
    """There is no answer, or it is no."""


class _Transport(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT_S
        return connection


def call(uri: str, caller: str, method: str, *arguments: object) -> Any:
    """Return the value of a call of the ROS master API or slave API.

    Raises:
        CallError: there is no usable answer.
    """
    try:
        with xmlrpc.client.ServerProxy(uri, transport=_Transport()) as proxy:
            answer: Any = getattr(proxy, method)(caller, *arguments)
        status, text, value = answer
    except _UNREACHABLE as problem:
        raise CallError(f"{uri} does not answer: {problem}") from None
    if status != 1:
        raise CallError(str(text))
    return value
