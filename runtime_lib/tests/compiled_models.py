"""Compiled monitors as text and as modules, without a package around them."""

from __future__ import annotations

from types import ModuleType

from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, module_text
from eddi_scaffold.program.running import module_of


def text_of(kind: str, compiled: CompiledMonitor, declaration: Declaration) -> str:
    return module_text(kind, compiled, declaration.model_id)


def loaded(kind: str, compiled: CompiledMonitor, declaration: Declaration) -> ModuleType:
    return module_of(text_of(kind, compiled, declaration), declaration.model_id)
