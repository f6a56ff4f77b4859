"""Compiled text as a running monitor, in a program that has the generator."""

from __future__ import annotations

import linecache
from types import ModuleType
from typing import Any

from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import ModelFile

_NAME = "compiled"


def build(model_file: ModelFile, hooks: Any = None) -> Any:
    """Return the monitor of a model: the text of its package, executed here.

    Args:
        model_file: the model.
        hooks: object with a person's methods, for kinds that have an editable module.

    Raises:
        ModelError: the model is wrong.
    """
    made = module_of(compile_model(model_file), model_file.id).Monitor
    return made() if hooks is None else made(hooks)


def module_of(text: str, model_id: str) -> ModuleType:
    """Return the module of a compiled text; tracebacks and debuggers show its lines."""
    name = f"<{model_id}>/compiled.py"
    linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
    module = ModuleType(_NAME)
    module.__file__ = name
    exec(compile(text, name, "exec"), vars(module))  # noqa: S102 - our own text, in the generator
    return module
