"""Compiled text as a running monitor, in a program that has the generator."""

from __future__ import annotations

import linecache
from collections.abc import Callable
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from pathlib import PurePath
from types import ModuleType

_NAME = "compiled"


class _Files(Loader):
    """Gives a module in memory its data files, as loaders of files do (PEP 302)."""

    def __init__(self, data: Callable[[str], bytes]) -> None:
        self._data = data

    def get_data(self, path: str) -> bytes:
        """Return the bytes of a file beside the module."""
        return self._data(PurePath(path).name)


def _no_data(name: str) -> bytes:
    raise FileNotFoundError(name)


def module_of(text: str, model_id: str, data: Callable[[str], bytes] = _no_data) -> ModuleType:
    """Return the module of a compiled text; tracebacks and debuggers show its lines.

    Args:
        text: of ``compiled.py``.
        model_id: id of its model.
        data: name -> bytes of a bulk file beside it.
    """
    name = f"<{model_id}>/compiled.py".replace("\0", "?")  # which no name of a file may hold
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    module = ModuleType(_NAME)
    module.__file__ = name
    module.__spec__ = ModuleSpec(_NAME, _Files(data), origin=name)
    exec(compile(text, name, "exec"), vars(module))  # noqa: S102 - our own text, in the generator
    return module
