"""The command line. A module per group of commands; heavy imports are inside the commands."""

from __future__ import annotations

import signal
import sys
import traceback
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem


def program() -> None:
    """Be the process: ``main``; Ctrl-C while Python itself ends changes nothing any more."""
    try:
        main()
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def main() -> None:
    """Run the command line and end the process: the one funnel for errors."""
    try:
        status = _status(sys.argv[1:])
    except KeyboardInterrupt:  # while a problem was printed
        status = ExitStatus.INTERRUPTED
    sys.exit(status)


def _status(arguments: Sequence[str]) -> int:
    console.quiet, console.verbose = False, False
    with_traceback = "--traceback" in arguments
    try:
        from eddi_scaffold.cli.app import app  # Ctrl-C while this loads is caught, too
        from eddi_scaffold.common.files import inputs_noted

        with inputs_noted():
            result = app(list(arguments), standalone_mode=False)
    except EddiError as failure:
        return _fail(failure.problems, arguments)
    except KeyboardInterrupt:
        result = ExitStatus.INTERRUPTED
    except OSError as refused:  # permission, full disk, too many open files
        place = Place(str(refused.filename)) if refused.filename is not None else Place()
        if with_traceback:
            console.complain("".join(traceback.format_exception(refused)))
        reason = refused.strerror or refused
        return _fail([problem("F001.system", place, reason=reason)], arguments)
    except Exception as failed:  # noqa: BLE001 - a user never sees a traceback unasked
        if type(failed).__name__ == "Abort":  # Ctrl-C as older versions of Typer report it
            result = ExitStatus.INTERRUPTED
        elif hasattr(failed, "format_message"):  # wrong usage; Typer keeps its class private
            misused: Any = failed
            if _wants_json(arguments):
                reason = " ".join(misused.format_message().split())
                return _fail([problem("G000.usage", reason=reason)], arguments)
            misused.show()
            return ExitStatus.BAD_INPUT
        else:
            _report_bug(failed, with_traceback=with_traceback)
            return ExitStatus.OUR_BUG
    if result == ExitStatus.INTERRUPTED:
        console.say("interrupted, nothing is half-written")
    return result if isinstance(result, int) else 0


def _fail(problems: Sequence[Problem], arguments: Sequence[str]) -> int:
    if _wants_json(arguments):
        console.json({"problems": [problem.as_json() for problem in problems]})
    else:
        console.problems(problems)
    return ExitStatus.BAD_INPUT


def _wants_json(arguments: Sequence[str]) -> bool:
    words = {"--json", "--format=json"}
    return not words.isdisjoint(arguments) or ("--format", "json") in pairwise(arguments)


def _report_bug(bug: Exception, *, with_traceback: bool) -> None:
    from eddi_scaffold import __version__

    if with_traceback:
        console.complain("".join(traceback.format_exception(bug)))
    frame = traceback.extract_tb(bug.__traceback__)[-1]
    console.complain(
        f"this is a bug in eddi-scaffold {__version__}: {type(bug).__name__}: {bug} "
        f"({frame.filename.rpartition('/')[2]}:{frame.lineno})\n"
        "please report it with the model that shows it; --traceback shows the rest"
    )
