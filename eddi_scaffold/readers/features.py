"""What models say twice or refer to in vain, also where no monitor uses it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.problems import Problem, error
from eddi_scaffold.readers import vocabulary as word
from eddi_scaffold.readers.spelling import fold
from eddi_scaffold.readers.survey import MONITORED, kind_of_model
from eddi_scaffold.readers.xmi import feature_of

if TYPE_CHECKING:
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.readers.xmi import Element

_READ = MONITORED | {"failure_model", "state_machine"}


def check_features(document: EddiDocument) -> Iterator[Problem]:
    """Yield X011 for two spellings of one thing, and X007, X008, X012 for references."""
    waiting = list(reversed(document.roots))
    while waiting:
        element = waiting.pop()
        if kind_of_model(document, element) not in _READ:
            waiting += reversed(element)
            continue
        for part in element.iter():
            yield from _said_twice(document, part)
            yield from _references(document, part)


def _said_twice(document: EddiDocument, part: Element) -> Iterator[Problem]:
    first: dict[str, str] = {}
    for name in map(str, part.attrib):
        other = first.setdefault(word.ONE_THING.get(fold(name), name), name)
        if other != name:
            message = f'"{other}" and "{name}" say the same thing; write one of them'
            yield error("X011", message, document.place(part))


def _references(document: EddiDocument, part: Element) -> Iterator[Problem]:
    parent, limit = part.getparent(), document.limits.reference_tokens
    tokens = [
        (part, name, token)
        for name, text in part.attrib.items()
        if fold(str(name)) in word.REFERENCES
        for token in str(text).split()[:limit]
    ]
    if parent is not None and "href" in part.attrib:
        tokens.append((parent, feature_of(part), part.attrib["href"]))
    for element, name, token in tokens:
        found = document.target(element, str(name), str(token))
        if isinstance(found, Problem):
            # what a monitor needs not be there: a requirement in a file of its own, for example
            is_far = found.code == "X012" and fold(str(name)) in word.LINKS
            yield replace(found, level="warning") if is_far else found
