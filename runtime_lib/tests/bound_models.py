"""Typed models with their inputs, compiled as for a package and run in this process."""

from __future__ import annotations

from dataclasses import replace
from types import ModuleType
from typing import Any, NamedTuple

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.kinds.consert.compile import compile_consert
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.program.input_expressions import BoundInput, expression_lines
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, module_text
from eddi_scaffold.program.python_text import comment
from eddi_scaffold.program.running import module_of

DIGEST = 64 * "0"


class BoundModel(NamedTuple):
    model: Model
    declaration: Declaration

    def compiled(self, **more: Any) -> CompiledMonitor:
        if isinstance(self.model, ConSertModel):
            return compile_consert(self.model.data, self.model.options, self.declaration, **more)
        return self.model.compile(self.declaration)

    def text(self, **more: Any) -> str:
        return self._text(self.compiled(**more))

    def _text(self, compiled: CompiledMonitor) -> str:
        lines = [*expression_lines(self.declaration.inputs), *compiled.lines]
        origin = f" of {comment(self.model.source.file_name)}"
        compiled = replace(compiled, lines=lines)
        return module_text(self.model.kind, compiled, self.declaration.model_id, origin)

    def module(self, **more: Any) -> ModuleType:
        compiled = self.compiled(**more)
        id_, tables = self.declaration.model_id, compiled.tables
        return module_of(self._text(compiled), id_, tables.__getitem__)

    def monitor(self, **more: Any) -> Any:
        return self.module(**more).Monitor()


def bound_input(id_: str, **keys: Any) -> BoundInput:
    """Return an input whose attribute has its id unless the keys say otherwise."""
    pairs = {key: tuple(it) if isinstance(it, list) else it for key, it in keys.items()}
    return BoundInput(**{"id": id_, "attribute": id_, **pairs})


def bound_model(
    kind: str, name: str, data: object, options: object, inputs: list[BoundInput], place=None
) -> BoundModel:
    source = Source(f"{name}.yml", b"")
    keys = {"data": data} if options is None else {"data": data, "options": options}
    model = kinds()[kind].model_class(name, source, place or Place(source.name), **keys)
    return BoundModel(model, Declaration(name, DIGEST, tuple(inputs)))


def text_of(kind: str, compiled: CompiledMonitor, declaration: Declaration) -> str:
    return module_text(kind, compiled, declaration.model_id)


def loaded(kind: str, compiled: CompiledMonitor, declaration: Declaration) -> ModuleType:
    return module_of(text_of(kind, compiled, declaration), declaration.model_id)
