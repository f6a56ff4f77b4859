"""One connection to a publisher (TCPROS): its head, and messages as they come."""

from __future__ import annotations

import contextlib
import socket
import struct
import time
from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import urlsplit

from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.watch.messages import DIAGNOSTICS
from eddi_scaffold.watch.ros1.calls import TIMEOUT_S, WHOLE_S, CallError, call
from eddi_scaffold.watch.ros1.decoding import decode, same_definition, without_stamp

_LENGTH = struct.Struct("<I")
_MAX_HEAD = 64 * 1024
_MAX_MESSAGE = 4 * 1024 * 1024
_BLOCK = 256 * 1024
_OURS = b"runtime_version"
"""What is in no other node's diagnostics."""
_ALIVE = (
    (socket.SO_KEEPALIVE, socket.SOL_SOCKET, 1),
    (getattr(socket, "TCP_KEEPIDLE", None), socket.IPPROTO_TCP, 5),
    (getattr(socket, "TCP_KEEPINTVL", None), socket.IPPROTO_TCP, 2),
    (getattr(socket, "TCP_KEEPCNT", None), socket.IPPROTO_TCP, 3),
)


class PublisherError(Exception):
    """The publisher does not send, or something else than is expected."""


class Connection:
    """Messages of one topic of one node.

    Attributes:
        topic: full name.
        node: full name.
        type: of its messages.
        socket: to wait for.

    Args:
        topic: as above.
        node: as above.
        type_: as above.
        connected: the socket; its head is read.
        head: what the publisher said first.
    """

    def __init__(
        self, topic: str, node: str, type_: str, connected: socket.socket, head: Mapping[str, str]
    ) -> None:
        self.topic, self.node, self.type, self.socket = topic, node, type_, connected
        self._latching = head.get("latching") == "1"
        self._rest = bytearray()
        self._last: tuple[bytes, Any] | None = None

    def read(self) -> Iterator[tuple[Any, bool]]:
        """Yield each message that has come, and whether it may be an old one.

        Equal messages are one object: only what changed is decoded.

        Raises:
            OSError: the connection has ended.
            DecodingError: something else than messages came.
        """
        block = self.socket.recv(_BLOCK)
        if not block:
            raise ConnectionResetError("the publisher has ended")
        self._rest += block
        data, at = self._rest, 0
        while len(data) - at >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(data, at)
            if length > _MAX_MESSAGE:
                raise ConnectionResetError(f"a message of {length} bytes")
            end = at + _LENGTH.size + length
            if end > len(data):
                break
            content = self._decoded(bytes(data[at + _LENGTH.size : end]))
            if content is not None:
                yield content, self._latching
            self._latching, at = False, end
        del data[:at]

    def _decoded(self, data: bytes) -> Any:
        if self.type == DIAGNOSTICS and _OURS not in data:
            return None
        key = without_stamp(self.type, data)
        if self._last is None or self._last[0] != key:
            self._last = (key, decode(self.type, data))
        return self._last[1]


def connect(uri: str, node: str, topic: str, type_: str, caller: str) -> Connection:
    """Return a connection to a publisher; waits some seconds at most.

    Args:
        uri: of the node's slave API.
        node: its name.
        topic: full name.
        type_: of its messages, a known one.
        caller: our name.

    Raises:
        CallError: the node does not answer.
        PublisherError: it refuses, or has another definition of the message.
        OSError: it cannot be reached.
    """
    answer = call(uri, caller, "requestTopic", topic, [["TCPROS"]])
    try:
        protocol, host, port = answer
        address = (str(host), int(port))
    except (TypeError, ValueError):
        raise CallError(f"{node} offers no TCPROS for {topic}") from None
    if protocol != "TCPROS":
        raise CallError(f"{node} offers no TCPROS for {topic}")
    made = _reached(address, urlsplit(uri).hostname)
    try:
        made.sendall(_head(callerid=caller, topic=topic, type="*", md5sum="*", tcp_nodelay="1"))
        head = _read_head(made)
        _check(head, node, topic, type_)
        for option, level, value in _ALIVE:
            if option is not None:
                made.setsockopt(level, option, value)
        made.setblocking(False)
    except BaseException:
        made.close()
        raise
    return Connection(topic, node, type_, made, head)


def _reached(address: tuple[str, int], other_host: str | None) -> socket.socket:
    """Return a socket to a publisher, by the name that its own API has where it gives another."""
    try:
        return socket.create_connection(address, TIMEOUT_S)
    except OSError:
        if other_host in (None, address[0]):
            raise
    return socket.create_connection((other_host, address[1]), TIMEOUT_S)


def _head(**fields: str) -> bytes:
    lines = (f"{name}={value}".encode() for name, value in fields.items())
    body = b"".join(_LENGTH.pack(len(line)) + line for line in lines)
    return _LENGTH.pack(len(body)) + body


def _read_head(made: socket.socket) -> dict[str, str]:
    end = time.monotonic() + WHOLE_S
    (length,) = _LENGTH.unpack(_exactly(made, _LENGTH.size, end))
    if length > _MAX_HEAD:
        raise PublisherError(f"a head of {length} bytes")
    body, at = _exactly(made, length, end), 0
    found: dict[str, str] = {}
    while at + _LENGTH.size <= len(body):
        (size,) = _LENGTH.unpack_from(body, at)
        line = body[at + _LENGTH.size : at + _LENGTH.size + size]
        name, _, value = line.decode("utf-8", "replace").partition("=")
        found[name] = value
        at += _LENGTH.size + size
    return found


def _exactly(made: socket.socket, length: int, end: float) -> bytes:
    found = b""
    while len(found) < length:
        if time.monotonic() > end:
            raise TimeoutError("the head takes too long")
        block = made.recv(length - len(found))
        if not block:
            raise ConnectionResetError("the publisher has ended")
        found += block
    return found


def _check(head: Mapping[str, str], node: str, topic: str, type_: str) -> None:
    if "error" in head:
        raise PublisherError(f"{node} refuses {topic}: {head['error']}")
    if head.get("type") != type_:
        raise PublisherError(f"{topic}: {node} sends {head.get('type')}, not {type_}")
    if not same_definition(type_, head.get("message_definition", "")):
        fields = ", ".join(known_messages()[type_])
        text = f"{topic}: {node} has another definition of {type_} than {fields}"
        raise PublisherError(text)


def close(made: socket.socket) -> None:
    """Close a socket, whatever state it is in."""
    with contextlib.suppress(OSError):
        made.close()
