"""What a kind is given to compile one of its models, and what it returns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.compiling.program.instructions import Program


@dataclass(frozen=True)
class BoundInput:
    """One input of a monitor, as ``eddi_runtime.InputSpec`` describes it."""

    id: str
    attribute: str
    requires: tuple[str, ...] = ()
    max_age: float | str | None = None
    factor: tuple[int, int] | None = None
    default: Any = None
    every_message: bool = False
    expression: Mapping[str, Any] | None = None
    accepts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Declaration:
    """What each compiled monitor begins with, whatever its kind.

    Attributes:
        model_id: id of the model, as the runtime reports it.
        digest: of all that decides what the monitor computes; robots compare it.
        inputs: in the order of the configuration.
    """

    model_id: str
    digest: str
    inputs: tuple[BoundInput, ...]


@dataclass(frozen=True)
class CompiledMonitor:
    """A compiled model, not yet a module: who writes that knows where the runtime is.

    Attributes:
        format: of the part of the runtime that its kind has.
        modules: of that part, those which only some monitors import.
        lines: the class ``Monitor``, behind those of its computed inputs where it has any.
        tables: name -> content of the files that must lie next to the module.
        program: its step as a program; None for a kind whose step calls functions of the runtime.
    """

    format: int
    lines: Sequence[str]
    modules: Sequence[str] = ()
    tables: Mapping[str, bytes] = field(default_factory=dict)
    program: Program | None = None
