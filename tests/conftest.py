"""Hypothesis profiles, what runs first, and how long a test may take.

The profile `quick` is for every run, `fast` for `script/test --fast`, and
`--hypothesis-profile=long` for thousands of examples. `--update-golden` writes the expected
packages anew.
"""

from __future__ import annotations

import atexit
import gc
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import typer.main
from hypothesis import HealthCheck, settings

from tests.data_files import left_out

collect_ignore = ["golden"]  # generated packages, whose tests run where they belong

_MEMORY = Path("/dev/shm")
if (
    "TMPDIR" not in os.environ
    and os.access(_MEMORY, os.W_OK)
    and not os.statvfs(_MEMORY).f_flag & os.ST_NOEXEC
    and shutil.disk_usage(_MEMORY).free > 4 * 2**30
):  # git, Copier and our own transactions flush a lot: several times faster in memory
    os.environ["TMPDIR"] = str(_MEMORY)
    tempfile.tempdir = None  # asked before, by pytest itself

if "EDDI_TESTS_COMPILED" not in os.environ:  # of templates, for all processes; see quick_copier.py
    os.environ["EDDI_TESTS_COMPILED"] = tempfile.mkdtemp(prefix="eddi-compiled-")
    atexit.register(shutil.rmtree, os.environ["EDDI_TESTS_COMPILED"], ignore_errors=True)

_WRITES_NO_BYTECODE = sys.dont_write_bytecode
sys.dont_write_bytecode = False  # asserts are rewritten once, and not by each worker; see below

# Every command that runs in this process would make typer look at all commands and options again.
typer.main.get_command = cache(typer.main.get_command)

# A shell starts background jobs with SIGINT ignored, and every child of ours would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile(
    "quick",
    max_examples=15,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
)
settings.register_profile("fast", settings.get_profile("quick"), max_examples=10)
settings.register_profile(
    "long", max_examples=5000, deadline=None, suppress_health_check=list(HealthCheck)
)
settings.load_profile("quick")


@pytest.fixture(scope="session", autouse=True)
def own_state(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the journals of the tests out of the tester's home."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Let the long profile take its time, unless a limit is asked for."""
    if config.getoption("--hypothesis-profile") == "long" and config.option.timeout is None:
        config.option.timeout = 0


def pytest_collection_finish() -> None:
    """Leave no bytecode in what the tests generate, where a person wants none.

    And look for cycles less often, and not in thousands of tests: that is a twentieth of all time.
    """
    sys.dont_write_bytecode = _WRITES_NO_BYTECODE
    gc.freeze()
    gc.set_threshold(20_000, 20)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files, so that no worker waits for one at the end.

    Those with ROS, which wait a lot, and others, which compute, take turns.
    """
    marks: dict[Path, set[str]] = {}
    for item in items:
        marks.setdefault(item.path, set()).update(mark.name for mark in item.iter_markers())
    classes = [[p for p in marks if "ros" in marks[p]], [p for p in marks if "ros" not in marks[p]]]
    turns = {path: turn for files in classes for turn, path in enumerate(files)}
    items.sort(key=lambda item: ("slow" not in marks[item.path], turns[item.path]))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what a run without other people's files does not show."""
    skipped = terminalreporter.stats.get("skipped", ())
    if line := left_out([str(report.longrepr) for report in skipped]):
        terminalreporter.write_line(line)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="accept what is generated now")
    parser.addoption("--update-frozen", action="store_true", help="accept other texts as frozen")
    parser.addoption("--frozen-texts", metavar="FOLDER", help="write all frozen texts to a folder")
