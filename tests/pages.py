"""Pages on this machine, served as long as a test asks them."""

from __future__ import annotations

import http.client
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import HTTPServer
from typing import Any


@contextmanager
def served(server: HTTPServer) -> Iterator[int]:
    """Answer on the port that is given."""
    with server:
        thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        yield server.server_port
        server.shutdown()
        thread.join()


def ask(
    port: int, path: str, method: str = "GET", body: bytes | str | None = None, **headers: str
) -> tuple[int, Any, str]:
    """Return status, headers and text of an answer; `Content_Type` is the header Content-Type."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, path, body, named)
    response = connection.getresponse()
    text = response.read().decode("utf-8", "replace")
    connection.close()
    return response.status, response.headers, text
