"""The command line. One module per command; heavy imports stand inside the commands."""

from __future__ import annotations

import sys

from eddi_scaffold.cli.app import app
from eddi_scaffold.console import console
from eddi_scaffold.problems import EddiError

EXIT_NO = 1
EXIT_BAD_INPUT = 2
EXIT_LOOK = 3
EXIT_OUR_BUG = 70
EXIT_INTERRUPTED = 130


def main() -> None:
    """Run the command line and end the process: the one funnel for errors."""
    arguments = sys.argv[1:]
    try:
        app()
    except EddiError as failure:
        if "--json" in arguments:
            console.json({"problems": [problem.as_json() for problem in failure.problems]})
        else:
            console.problems(failure.problems)
        sys.exit(EXIT_BAD_INPUT)
    except KeyboardInterrupt:
        console.say("interrupted, nothing is half-written")
        sys.exit(EXIT_INTERRUPTED)
    except BrokenPipeError:
        # whoever read our output has gone, for instance `| head`
        sys.stderr.close()
        sys.exit(0)
    except Exception as bug:  # noqa: BLE001 - a user never sees a traceback unasked
        _report_bug(bug, with_traceback="--traceback" in arguments)
        sys.exit(EXIT_OUR_BUG)


def _report_bug(bug: Exception, *, with_traceback: bool) -> None:
    import traceback

    from eddi_scaffold import __version__

    if with_traceback:
        console.say("".join(traceback.format_exception(bug)))
    frame = traceback.extract_tb(bug.__traceback__)[-1]
    console.say(
        f"this is a bug in eddi-scaffold {__version__}: {type(bug).__name__}: {bug} "
        f"({frame.filename.rpartition('/')[2]}:{frame.lineno})\n"
        "please report it with the model that shows it; --traceback shows the rest"
    )
