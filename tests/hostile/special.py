"""Special files, and limits of time and memory for what must refuse them at once."""

from __future__ import annotations

import os
import resource
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SECONDS = 60
MEMORY = 1 << 30


class Late(BaseException):
    """Nothing that a command would catch."""


@contextmanager
def limited() -> Iterator[None]:
    """Fail instead of waiting for ever, or of reading until the memory is full."""

    def stop(*_: object) -> None:
        raise Late(f"not done after {SECONDS} s")

    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    handler = signal.signal(signal.SIGALRM, stop)
    resource.setrlimit(resource.RLIMIT_AS, (now + MEMORY, before[1]))
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, handler)
        resource.setrlimit(resource.RLIMIT_AS, before)


def a_socket(path: Path) -> None:
    """Leave a socket that nobody listens at."""
    here = Path.cwd()
    os.chdir(path.parent)  # its name may not be long
    try:
        with socket.socket(socket.AF_UNIX) as talk:
            talk.bind(path.name)
    finally:
        os.chdir(here)
