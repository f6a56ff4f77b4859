"""Copier in a process that renders hundreds of packages: what each of them would repeat, once.

Nothing is left out. Copier reads the same questions and compiles the same few hundred small
templates for every package, gathers all answers for the name of each file of the runtime, and asks
git for the same setting for every file; together that is most of the time.
"""

from __future__ import annotations

import os
import pickle
import runpy
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from contextvars import Context
from functools import cache
from pathlib import Path
from types import CodeType, SimpleNamespace
from typing import Any, cast
from unittest.mock import patch

import copier._main
import copier._template
import jinja2
from copier._cli import CopierApp
from copier._main import Worker
from plumbum import local

_ASK = ("git", "config", "--type=bool", "--get", "core.fileMode")
_ANSWER = "git ignores modes"


def copier_here(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run Copier's command line in this process: it starts once, and keeps what it repeats.

    The programs that it starts are forks of this process. `tests/packaging` and `tests/e2e` start
    all of them anew.
    """
    render_faster()
    before, here = [os.dup(1), os.dup(2)], Path.cwd()
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        os.dup2(out.fileno(), 1)  # of the tasks, too
        os.dup2(err.fileno(), 2)
        os.chdir(cwd)
        try:
            with (
                redirect_stdout(out),
                redirect_stderr(err),
                patch.object(copier._main, "subprocess", SimpleNamespace(run=_fork)),
            ):
                _, status = CopierApp.run(["copier", *map(str, words)], exit=False)
        finally:
            os.chdir(here)
            for number, kept in enumerate(before, 1):
                os.dup2(kept, number)
                os.close(kept)
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess(words, status, out.read(), err.read())


def _fork(
    command: Sequence[str], env: Mapping[str, str], **_: object
) -> subprocess.CompletedProcess[str]:
    """Run a task of a template, `python FOLDER ...` or `python -m copier ...`."""
    assert command[0] == sys.executable, command
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        status: object = 1
        try:
            os.chdir(local.cwd)
            os.environ.clear()
            os.environ.update(env)
            sys.argv = [word for word in command[1:] if word != "-IS"]
            if command[1] == "-m":
                _, status = Context().run(CopierApp.run, [*command[2:]], exit=False)
            else:
                ours = [name for name in sys.modules if name.split(".")[0] == "eddi_scaffold"]
                for name in ours:  # the template brings its own
                    del sys.modules[name]
                runpy.run_path(sys.argv[0], run_name="__main__")
        except SystemExit as end:
            status = end.code
        except BaseException:  # noqa: BLE001
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status if isinstance(status, int) else int(status is not None))
    ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return subprocess.CompletedProcess(command, ended)


@cache
def render_faster() -> None:
    """Change Jinja and Copier in this process, until it ends."""
    _read_questions_once()
    _compile_once()
    _take_plain_texts_as_they_are()
    _ask_git_once()


def _read_questions_once() -> None:
    read: dict[tuple[bytes, ...], bytes] = {}
    read_anew = copier._template.load_template_config

    def load(path: Path, *args: Any, **more: Any) -> Any:
        files = sorted(path.parent.glob("copier_templates/*/*.yml"))
        key = tuple(file.read_bytes() for file in (path, *files))
        if key not in read:
            read[key] = pickle.dumps(read_anew(path, *args, **more))
        return pickle.loads(read[key])

    copier._template.load_template_config = load


def _compile_once() -> None:
    compiled: dict[tuple[object, ...], CodeType] = {}
    compile_anew = jinja2.Environment.compile

    def compile_(self: jinja2.Environment, source: Any, *args: Any, **more: Any) -> Any:
        if not isinstance(source, str) or "yield" in source:  # whose parser keeps what it has read
            return compile_anew(self, source, *args, **more)
        syntax = (type(self), *(str(getattr(self, name)) for name in _SYNTAX))
        extensions = tuple(self.extensions), frozenset(self.filters), frozenset(self.tests)
        key = (source, args, *more.items(), *syntax, *extensions)
        if key not in compiled:
            compiled[key] = compile_anew(self, source, *args, **more)
        self.preprocess(source)  # Copier's extension forgets the yield of the template before
        return compiled[key]

    jinja2.Environment.compile = compile_  # type: ignore[method-assign]


def _take_plain_texts_as_they_are() -> None:
    render_anew = Worker._render_string

    def render(self: Any, string: str, extra_context: Any = None) -> str:
        if "{" in string:
            return render_anew(self, string, extra_context)
        self.jinja_env.preprocess(string)  # as in `compile_`
        return string

    name_anew = cast(property, Worker.answers_relpath).fget
    assert name_anew is not None

    def answers_relpath(self: Any) -> Path:
        path = str(self.answers_file or self.template.answers_relpath)
        if "{" in path:
            return cast(Path, name_anew(self))
        self.jinja_env.preprocess(path)
        return Path(path)

    Worker._render_string = render  # type: ignore[method-assign]
    Worker.answers_relpath = property(answers_relpath)  # type: ignore[method-assign]


_SYNTAX = (
    *("block_start_string", "block_end_string", "variable_start_string", "variable_end_string"),
    *("comment_start_string", "comment_end_string", "line_statement_prefix", "trim_blocks"),
    *("line_comment_prefix", "lstrip_blocks", "newline_sequence", "keep_trailing_newline"),
    *("optimized", "autoescape", "is_async"),
)
"""What of an environment decides how a template is compiled."""


def _ask_git_once() -> None:
    """Ask before the first file of a rendering whether git needs to be told of modes."""
    tell = Worker._sync_git_index_executable_bit

    def tell_if_needed(self: Any, path: Path, mode: int) -> None:
        known = vars(self)
        if _ANSWER not in known:
            folder = self.subproject.local_abspath
            answer = subprocess.run(_ASK, cwd=folder, capture_output=True, text=True, check=False)
            known[_ANSWER] = answer.stdout.strip() == "false"
        if known[_ANSWER]:
            tell(self, path, mode)

    Worker._sync_git_index_executable_bit = tell_if_needed  # type: ignore[method-assign]
