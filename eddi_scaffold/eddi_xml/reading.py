"""Files of XML as EDDI documents, with what is wrong with their classes."""

from __future__ import annotations

from typing import BinaryIO

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import DEFAULT_LIMITS, Limits, load
from eddi_scaffold.eddi_xml.survey import unknown_classes
from eddi_scaffold.eddi_xml.vocabulary import fold, is_misprint, local_name
from eddi_scaffold.eddi_xml.xml_text import HEAD_BYTES, looks_like_xml


def recognises(source: Source) -> bool:
    """Return whether a file looks like XML."""
    with source.open() as stream:
        return looks_like_xml(stream.read(HEAD_BYTES))


def read_document(
    source: Source, limits: Limits = DEFAULT_LIMITS
) -> tuple[EddiDocument | None, list[Problem]]:
    """Parse an EDDI; ``None`` and the errors X001 or X003 when that is impossible."""
    with source.open() as stream:
        return read_stream(stream, source.name, limits)


def read_stream(
    stream: BinaryIO, name: str, limits: Limits = DEFAULT_LIMITS
) -> tuple[EddiDocument | None, list[Problem]]:
    """Parse an EDDI from a seekable stream."""
    element, problems = load(stream, name, limits)
    if element is None:
        return None, problems
    document = EddiDocument(element, name, limits)
    for root in document.roots:
        class_name = local_name(document.class_of(root).printed)
        if fold(class_name) == "ddipackage" and is_misprint(class_name):
            problems.append(problem("X006.root", document.place(root), name=class_name))
    return document, [*problems, *unknown_classes(document)]
