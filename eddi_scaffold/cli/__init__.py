"""The command line. One module per command; heavy imports stand inside the commands."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from eddi_scaffold.cli.console import console
from eddi_scaffold.problems import EddiError, Place, Problem, error

EXIT_NO = 1
EXIT_BAD_INPUT = 2
EXIT_LOOK = 3
EXIT_OUR_BUG = 70
EXIT_INTERRUPTED = 130

_EVERYWHERE = frozenset(
    {"-q", "--quiet", "-v", "--verbose", "--color", "--no-color", "--traceback"}
)


def program() -> None:
    """Be the process: ``main``, and Ctrl-C while Python itself ends is an interruption as well."""
    try:
        try:
            main()
        finally:
            signal.signal(signal.SIGINT, _interrupted)
    except KeyboardInterrupt:
        _interrupted()


def _interrupted(*_: object) -> None:
    os._exit(EXIT_INTERRUPTED)  # all is written: nothing but the end of Python is left out


def main() -> None:
    """Run the command line and end the process: the one funnel for errors."""
    try:
        status = _status(hoisted(sys.argv[1:]))
    except KeyboardInterrupt:  # while a problem was printed
        status = EXIT_INTERRUPTED
    sys.exit(status)


def hoisted(arguments: Sequence[str]) -> list[str]:
    """Put the global options before the command, so that `check -q` does what people expect."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    front = [word for word in arguments[:end] if word in _EVERYWHERE]
    rest = [word for word in arguments[:end] if word not in _EVERYWHERE]
    return [*front, *rest, *arguments[end:]]


def _status(arguments: Sequence[str]) -> int:
    """Run one command and return its exit status."""
    try:
        from eddi_scaffold.cli.app import app  # Ctrl-C while this loads is caught, too

        result = app(list(arguments), standalone_mode=False)
    except EddiError as failure:
        return _fail(failure.problems, arguments)
    except KeyboardInterrupt:
        result = EXIT_INTERRUPTED
    except OSError as refused:  # permission, full disk, too many open files
        return _fail([_refusal(refused)], arguments, refused)
    except Exception as failed:  # noqa: BLE001 - a user never sees a traceback unasked
        if type(failed).__name__ == "Abort":  # Ctrl-C as older versions of Typer tell it
            result = EXIT_INTERRUPTED
        elif hasattr(failed, "format_message"):  # wrong usage; Typer keeps its class private
            return _misused(failed, arguments)
        else:
            _report_bug(failed, with_traceback="--traceback" in arguments)
            return EXIT_OUR_BUG
    if result == EXIT_INTERRUPTED:
        console.say("interrupted, nothing is half-written")
    return result if isinstance(result, int) else 0


def _fail(
    problems: Sequence[Problem], arguments: Sequence[str], cause: Exception | None = None
) -> int:
    if cause is not None and "--traceback" in arguments:
        _say_traceback(cause)
    if _wants_json(arguments):
        console.json({"problems": [problem.as_json() for problem in problems]})
    else:
        console.problems(problems)
    return EXIT_BAD_INPUT


def _misused(failed: Any, arguments: Sequence[str]) -> int:
    if _wants_json(arguments):
        return _fail([error("G000", " ".join(failed.format_message().split()))], arguments)
    failed.show()
    return EXIT_BAD_INPUT


def _wants_json(arguments: Sequence[str]) -> bool:
    return (
        "--json" in arguments
        or "--format=json" in arguments
        or ("--format", "json") in pairwise(arguments)
    )


def _refusal(refused: OSError) -> Problem:
    place = Place(str(refused.filename)) if refused.filename is not None else Place()
    return error("F006", f"the system refused: {refused.strerror or refused}", place)


def _say_traceback(failed: Exception) -> None:
    import traceback

    console.complain("".join(traceback.format_exception(failed)))


def _report_bug(bug: Exception, *, with_traceback: bool) -> None:
    import traceback

    from eddi_scaffold import __version__

    if with_traceback:
        _say_traceback(bug)
    frame = traceback.extract_tb(bug.__traceback__)[-1]
    console.complain(
        f"this is a bug in eddi-scaffold {__version__}: {type(bug).__name__}: {bug} "
        f"({frame.filename.rpartition('/')[2]}:{frame.lineno})\n"
        "please report it with the model that shows it; --traceback shows the rest"
    )
