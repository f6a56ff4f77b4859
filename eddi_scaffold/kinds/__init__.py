"""Monitor kinds: what the generator knows of ConSerts, Bayesian networks, ... as plain functions.

A kind is one folder below this one (or a package of a third party with the entry point group
``eddi_scaffold.kinds``) that offers ``KIND``. Kinds know neither each other nor a platform.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from eddi_scaffold.problems import Place, Problem
    from eddi_scaffold.readers.eddi import EddiDocument
    from eddi_scaffold.source import Source

InputType = Literal["bool", "float", "int", "str"]
JsonValue = Any
"""What ``json`` reads and writes: None, bool, int, float, str, list, dict."""


@dataclass(frozen=True)
class ModelInput:
    """One thing that a monitor must be told at run time.

    Attributes:
        id: as in the model (``RtE_A_E0``).
        type: Python type of the value that ``EDDIInput`` holds.
        safety: a value that stays forever when its publisher dies would be dangerous, so a
            missing ``max_age`` is a warning.
        unit: unit of the model for a number, ``None`` otherwise.
        units: unit -> exact factor (numerator, denominator) from that unit to ``unit``: the
            units in which a configuration may declare the input.
        description: one line for generated comments.
        covered: short text that says which values count as good (``[0, 5) m``), for comments.
        is_good: would this value, in ``unit``, be evidence that can make an output active? Used to
            refuse unsafe defaults; ``None`` when the kind has no such notion.
    """

    id: str
    type: InputType
    safety: bool = True
    unit: str | None = None
    units: Mapping[str, tuple[int, int]] | None = None
    description: str | None = None
    covered: str | None = None
    is_good: Callable[[object], bool] | None = None


@dataclass(frozen=True)
class Model:
    """One model of a kind, checked as far as it could be.

    Attributes:
        kind: name of the kind (``consert``).
        name: name of the model in its file.
        data: the kind's own typed model; only the kind looks inside.
        source: the file it was read from.
        place: where it stands in that file.
    """

    kind: str
    name: str
    data: Any
    source: Source
    place: Place


@dataclass(frozen=True)
class Reading:
    """What a reader found: models and everything that is wrong with them."""

    models: tuple[Model, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Settings:
    """What a configuration says about a model, as the kind needs it.

    Attributes:
        guarantee_ids: which ids a ConSert monitor publishes.
        filter: ``{"kind": "none"}``, ``{"kind": "debounce", "regain_after": n}`` or
            ``{"kind": "majority", "window": n}``.
        parameters: the remaining kind-specific keys of the configuration.
    """

    guarantee_ids: str = "source"
    filter: Mapping[str, JsonValue] | None = None
    parameters: Mapping[str, JsonValue] | None = None


@dataclass(frozen=True)
class Kind:
    """The functions that make a monitor kind.

    Attributes:
        name: module-like name, the same in the runtime (``consert``).
        title: for people (``ConSert``).
        config_types: spellings of ``Model: type:`` in a configuration, compared without case.
        eddi_classes: class names of EDDI XML that hold models of this kind, without case.
        read_eddi: EDDI document -> models and problems.
        sniff: does this file, by its first bytes and name, hold a model of this kind by itself?
        read_file: such a file -> models and problems.
        check: problems of one model that the readers do not see (static checks).
        counts: what ``show`` prints, in order (``{"guarantees": 2, ...}``).
        outline: the tree that ``show`` prints: lines with two blanks per level.
        export: file name -> text of the kind's own format.
        inputs: what the monitor must be told.
        runtime_model: the ``model`` part of ``config/model.json``.
        messages: ROS message name -> ``.msg`` text; field names fit ROS 1 and ROS 2.
        output_message: name of the message that the monitor publishes.
        status_message: name of the message with the facts behind it, ``None`` for none.
    """

    name: str
    title: str
    config_types: tuple[str, ...]
    eddi_classes: tuple[str, ...]
    read_eddi: Callable[[EddiDocument, Source, Sequence[str]], Reading]
    sniff: Callable[[Source], bool]
    read_file: Callable[[Source, Sequence[str]], Reading]
    check: Callable[[Model], Sequence[Problem]]
    counts: Callable[[Model], Mapping[str, int]]
    outline: Callable[[Model], Sequence[str]]
    export: Callable[[Model], Mapping[str, str]]
    inputs: Callable[[Model], Sequence[ModelInput]]
    runtime_model: Callable[[Model, Settings], dict[str, JsonValue]]
    messages: Mapping[str, str]
    output_message: str
    status_message: str | None = None


@cache
def kinds() -> Mapping[str, Kind]:
    """Return every known kind by name, sorted: the folders here, then third parties' packages."""
    found: dict[str, Kind] = {}
    for module in pkgutil.iter_modules(__path__):
        if module.ispkg:
            kind: Kind = importlib.import_module(f"{__name__}.{module.name}").KIND
            found[kind.name] = kind
    from importlib.metadata import entry_points  # noqa: PLC0415 - 4 MB that a reader does not need

    for entry in entry_points(group="eddi_scaffold.kinds"):
        kind = entry.load()
        found.setdefault(kind.name, kind)
    return dict(sorted(found.items()))
