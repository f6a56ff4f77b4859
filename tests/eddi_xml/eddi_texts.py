"""Small EDDI files of our own, and ways to read them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import in_order
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.survey import survey
from eddi_scaffold.kinds.consert.options import with_default_guarantees
from eddi_scaffold.kinds.consert.read_eddi import read_eddi

if TYPE_CHECKING:
    from collections.abc import Iterable

    from eddi_scaffold.common.problems import Problem
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.kinds.consert.consert import ConSert

MODELS = Path(__file__).parent / "models"
ROVER = (MODELS / "rover.xml").read_text(encoding="utf-8")
OLDER = (MODELS / "older.xml").read_text(encoding="utf-8")
SAFETY_CASE = (MODELS / "safety_case.xml").read_text(encoding="utf-8")


def read(data: bytes | str, *marks: str) -> tuple[tuple[ConSert, ...], list[Problem]]:
    """Read the ConSerts of a file called m.xml, and survey it, as the commands do."""
    source = Source("m.xml", data.encode() if isinstance(data, str) else data)
    document, problems = read_document(source)
    if document is None:
        return (), in_order(problems)
    survey(document)
    conserts, more = read_eddi(document, source)
    marked, unclear = with_default_guarantees(conserts, marks, source.name)
    return marked, in_order([*problems, *more, *unclear])


def parsed(data: bytes | str) -> tuple[EddiDocument, list[Problem]]:
    """Return a file called m.xml, which can be read, with what is reported of it."""
    source = Source("m.xml", data.encode() if isinstance(data, str) else data)
    document, problems = read_document(source)
    assert document is not None
    return document, problems


def texts(problems: Iterable[Problem]) -> list[str]:
    """Return problems as one line each; the path of the element is not in it."""
    return [
        f"{p.place.file}:{p.place.line}: {p.level} {p.code}: {p.message}"
        for p in in_order(problems)
    ]


def codes(problems: Iterable[Problem]) -> set[str]:
    return {p.code for p in problems}
