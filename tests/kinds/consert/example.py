"""One small ConSert with everything in it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.consert_model import ConSertModel

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model

ROVER = Path(__file__).with_name("rover.yml").read_text(encoding="utf-8")


def read(text: str, name: str = "Rover.yml", marks: tuple[str, ...] = ()) -> Model:
    reading = ConSertModel.read_file(Source(name, text.encode()), marks)
    assert [p for p in reading.problems if p.level == "error"] == []
    (model,) = reading.models
    return model
