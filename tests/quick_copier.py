"""Copier in a process that renders hundreds of packages: what each of them would repeat, once.

Nothing is left out. Copier compiles the same few hundred small templates for every package, and
asks git for the same setting for every file; together that is half of the time.
"""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import jinja2
from copier._main import Worker

_ASK = ("git", "config", "--type=bool", "--get", "core.fileMode")
_ANSWER = "git ignores modes"


@cache
def render_faster() -> None:
    """Change Jinja and Copier in this process, until it ends."""
    _compile_once()
    _ask_git_once()


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
