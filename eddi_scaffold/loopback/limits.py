"""How long a request may take, and how many there may be at once."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import suppress
from http.server import ThreadingHTTPServer
from io import RawIOBase
from typing import Any

_BUSY = b"HTTP/1.0 503 Service Unavailable\r\nContent-Length: 0\r\nRetry-After: 5\r\n\r\n"


class TimedInput(RawIOBase):
    """What comes over a connection, until its time is over: however slowly it drips.

    Args:
        connection: whose timeout is what is left.
        seconds: from now on.
    """

    def __init__(self, connection: socket.socket, seconds: float) -> None:
        self._connection = connection
        self._end = time.monotonic() + seconds

    def readable(self) -> bool:
        """Return True: it can be read."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Wait for more, as long as there is time.

        Raises:
            TimeoutError: there is none left.
        """
        self.limit()
        return self._connection.recv_into(buffer)

    def limit(self) -> None:
        """Give what is read or written next no more than the time that is left.

        Raises:
            TimeoutError: there is none left.
        """
        left = self._end - time.monotonic()
        if left <= 0:
            raise TimeoutError
        self._connection.settimeout(left)


class LimitedServer(ThreadingHTTPServer):
    """A server with a thread for each connection, and an end to their number.

    Args:
        address: host and port.
        handler: what answers a connection.
        connections: at once.

    Attributes:
        names: what ``Host`` may be.
    """

    daemon_threads = True

    def __init__(self, address: tuple[str, int], handler: Any, connections: int) -> None:
        self._free = threading.Semaphore(connections)
        super().__init__(address, handler)
        hosts = (address[0], "localhost")
        self.names = frozenset(f"{host}:{self.server_port}" for host in hosts)
        if self.server_port == 80:  # then browsers leave it out
            self.names |= frozenset(hosts)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread of its own, or not at all."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
            return
        with suppress(OSError):
            request.setblocking(False)
            request.send(_BUSY)
        self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer, and make room for the next one."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()
