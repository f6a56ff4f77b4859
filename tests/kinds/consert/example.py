"""One small ConSert with everything in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import yaml

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.compile import STRAIGHT_LINE_LIMIT
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.options import ConSertOptions
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import DIGEST, BoundModel, bound_input
from tests.data_files import data_file

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model

ROVER = Path(__file__).with_name("rover.yml").read_text(encoding="utf-8")


def read(text: str, name: str = "Rover.yml", marks: tuple[str, ...] = ()) -> Model:
    reading = ConSertModel.read_file(Source(name, text.encode()), marks)
    assert [p for p in reading.problems if p.level == "error"] == []
    (model,) = reading.models
    return model


@cache
def oracle() -> dict[str, Any]:
    path = data_file("conserts/oracle.yml")
    data = yaml.load(path.read_bytes(), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    return dict(data)


def as_source(document: Any, name: str = "model.yml") -> Source:
    text = document if isinstance(document, str) else yaml.safe_dump(document, sort_keys=False)
    return Source(name, text.encode())


def monitor_of(
    model: ConSertModel, limit: int = STRAIGHT_LINE_LIMIT, options: ConSertOptions | None = None
) -> tuple[Any, Callable[[Mapping[str, Any]], Any]]:
    """Return the monitor, and what makes its input from values by id."""
    configured = replace(model, options=options or ConSertOptions())
    bound = tuple(bound_input(one.id) for one in model.inputs())
    made = BoundModel(configured, Declaration(model.name, DIGEST, bound)).monitor(limit=limit)
    return made, lambda values: SimpleNamespace(**values)
