"""Copier in a process that renders hundreds of packages: what each of them would repeat, once.

Nothing is left out. Copier reads the same questions and compiles the same few hundred small
templates for every package, gathers all answers for the name of each file of the runtime, and asks
git for the same setting for every file; together that is most of the time.
"""

from __future__ import annotations

import hashlib
import json
import marshal
import os
import pickle
import runpy
import shutil
import subprocess
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
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

from eddi_scaffold.packages.rendering import Renderer

COMPILED = "EDDI_TESTS_COMPILED"
"""Names the folder of what the processes of a run have made; without it each is on its own."""
_ASK = ("git", "config", "--type=bool", "--get", "core.fileMode")
_ANSWER = "git ignores modes"


def copier_here(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run Copier's command line in this process: it starts once, and keeps what it repeats.

    The programs that it starts are forks of this process. `tests/packaging` starts all of them
    anew.
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
    _render_once()


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
    compiled: dict[str, CodeType] = {}
    compile_anew = jinja2.Environment.compile

    def compile_(
        self: jinja2.Environment,
        source: Any,
        name: str | None = None,
        filename: str | None = None,
        **more: Any,
    ) -> Any:
        if not isinstance(source, str) or "yield" in source:  # whose parser keeps what it has read
            return compile_anew(self, source, name, filename, **more)
        syntax = [str(getattr(self, key)) for key in _SYNTAX]
        names = [sorted(self.extensions), sorted(self.filters), sorted(self.tests)]
        key = repr((source, name, sorted(more.items()), type(self), syntax, names))
        if key not in compiled:  # the folder of a template is another one each time
            compiled[key] = _shared(key, lambda: compile_anew(self, source, name, None, **more))
        self.preprocess(source)  # Copier's extension forgets the yield of the template before
        return compiled[key]

    jinja2.Environment.compile = compile_  # type: ignore[method-assign]


def _shared(key: str, compile_anew: Callable[[], CodeType]) -> CodeType:
    """Return what any process of this run has compiled already."""
    if not (folder := os.environ.get(COMPILED)):
        return compile_anew()
    file = Path(folder, hashlib.sha256(key.encode()).hexdigest())
    with suppress(OSError):
        return cast(CodeType, marshal.loads(file.read_bytes()))
    code = compile_anew()
    with suppress(OSError), tempfile.NamedTemporaryFile(dir=folder, delete=False) as new:
        new.write(marshal.dumps(code))
        new.flush()
        Path(new.name).replace(file)
    return code


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


def _render_once() -> None:
    """Render a package once in a run: templates and answers decide every byte of it."""
    render_anew = Renderer._run

    def run(self: Renderer, answers: dict[str, Any], folder: Path) -> None:
        place = os.environ.get(COMPILED)
        if not place or folder.exists():
            return render_anew(self, answers, folder)
        os.umask(mask := os.umask(0))
        if "digest" not in vars(self):
            vars(self)["digest"] = _digest_of(self.source.folder)
        key = (vars(self)["digest"], mask, json.dumps(answers, sort_keys=True, default=repr))
        kept = Path(place, f"{hashlib.sha256(repr(key).encode()).hexdigest()}.package")
        if not kept.exists():
            with warnings.catch_warnings(record=True) as raised:
                render_anew(self, answers, folder)
            for one in raised:
                warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
            if not raised:
                new = Path(tempfile.mkdtemp(dir=place), "package")
                shutil.copytree(folder, new, symlinks=True)
                with suppress(OSError):  # another process was faster
                    new.rename(kept)
            return None
        shutil.copytree(kept, folder, symlinks=True)
        return None

    Renderer._run = run  # type: ignore[method-assign]


def _digest_of(folder: Path) -> str:
    """Return a digest of all templates in a folder."""
    digest = hashlib.sha256()
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        digest.update(f"{file.relative_to(folder)} {file.stat().st_mode}\0".encode())
        digest.update(file.read_bytes() + b"\0")
    return digest.hexdigest()
