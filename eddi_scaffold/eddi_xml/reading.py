"""An EDDI document: elements with classes, places and references, whatever tool wrote it.

Nothing is done per element before somebody asks, so a file costs little more than its parse.
Classes are bound by package key and class name, never by the full namespace URI: URIs and
prefixes differ between generations of one metamodel.
"""

from __future__ import annotations

from typing import BinaryIO

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import DEFAULT_LIMITS, Limits, load
from eddi_scaffold.eddi_xml.unread import unknown_classes
from eddi_scaffold.eddi_xml.vocabulary import fold, is_misprint, local_name
from eddi_scaffold.eddi_xml.xml_text import HEAD_BYTES, looks_like_xml


def recognises(source: Source) -> bool:
    """Return whether a file looks like XML."""
    with source.open() as stream:
        return looks_like_xml(stream.read(HEAD_BYTES))


def read_document(
    source: Source,
    limits: Limits = DEFAULT_LIMITS,
) -> tuple[EddiDocument | None, list[Problem]]:
    """Parse an EDDI; ``None`` and the errors X001 or X003 when that is impossible."""
    with source.open() as stream:
        return read_stream(stream, source.name, limits)


def read_stream(
    stream: BinaryIO,
    name: str,
    limits: Limits = DEFAULT_LIMITS,
) -> tuple[EddiDocument | None, list[Problem]]:
    """Parse an EDDI from a seekable stream."""
    tree, problems = load(stream, name, limits)
    if tree is None:
        return None, problems
    document = EddiDocument(tree, name, limits)
    return document, [*problems, *_root_misprints(document), *unknown_classes(document)]


def _root_misprints(document: EddiDocument) -> list[Problem]:
    return [
        problem("X006.root", document.place(root), name=name)
        for root in document.roots
        if fold(name := local_name(document.class_of(root).printed)) == "ddipackage"
        and is_misprint(name)
    ]
