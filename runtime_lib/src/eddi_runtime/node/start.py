"""Everything before a node is seen by others: what cannot work ends here, with the reason."""

import os
import signal
import sys
from contextlib import contextmanager
from typing import Iterator

from ..compatibility import ModelError

__all__ = ["StartError", "end_at_signals", "installed", "reported", "write_to_stderr"]

_ADVICE = "run `eddi-scaffold upgrade` or `copier recopy --trust --force` in the package"


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
    write_to_stderr(package, f"error: {reason}")
    sys.exit(1)


@contextmanager
def installed(package: str, advice: str) -> Iterator[None]:
    """End with one line, not a traceback, when what comes with a robot's system is not there."""
    try:
        yield
    except ImportError as error:
        write_to_stderr(package, f"error: {error}: {advice}")
        sys.exit(1)


def end_at_signals() -> None:
    """End at once at a signal: a node that has said nothing yet leaves nothing behind."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))


def write_to_stderr(node: str, text: str) -> None:
    """Write a line of a node whose transport has no log yet."""
    sys.stderr.write(f"{node}: {text}\n")
    sys.stderr.flush()
