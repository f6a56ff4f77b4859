"""Events in an EDDI, read and written: one declaration for each value of a map ``eddi.events``.

The declarations become the lines of one text, which is read like a file of events; what is wrong
in it is reported at the value, with the column in its text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.conditions.tokens import TextFindings, comments_of, in_text, tokens_of
from eddi_scaffold.eddi_xml.extensions import (
    EVENTS,
    MODEL,
    ExtensionMap,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.kinds.event.events import DEFAULT_RATE, EddiLines, Events, read_text

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument


DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
COMMENT, FREQUENCY = "comment", "frequency"
_LIMIT = 64 * 1024
_WORD = re.compile(r"(?:ENUM|VAR|CONST|EVENT)\b", re.IGNORECASE)
_TEXT = re.compile(r'"[^"]*"')


def read_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[tuple[ExtensionMap, Source, Events]], list[Problem]]:
    """Read the events of an EDDI: where they are, their text, what they are."""
    files: list[tuple[ExtensionMap, Source, Events]] = []
    problems: list[Problem] = []
    for extension_map in extension_maps(document, EVENTS):
        known = (MODEL, FREQUENCY, *DECLARATIONS, COMMENT)
        wrong = [*unknown_tags(extension_map, known, (FREQUENCY,)), *_wrong_values(extension_map)]
        problems += wrong
        if extension_map.model is None or has_errors(wrong):
            continue  # a missing name is told once for all kinds
        lines = extension_map.of(*DECLARATIONS, COMMENT)
        text = "".join(
            f"// {value.text}\n" if value.tag == COMMENT else f"{value.tag} {value.text}\n"
            for value in lines
        )
        rate = next((_rate(value.text) for value in extension_map.of(FREQUENCY)), None)
        placed = EddiLines(tuple((value.tag, value.place) for value in lines), extension_map.place)
        events, more = read_text(text, source.name, placed, rate)
        problems += more
        if events is not None:
            files.append((extension_map, replace(source, part=text.encode()), events))
    return files, problems


def _wrong_values(extension_map: ExtensionMap) -> Iterator[Problem]:
    """Yield what is wrong with values before they are one text (X031)."""
    for value in extension_map.of(*DECLARATIONS, COMMENT):
        if re.search(r"[\r\n]", value.text):
            yield problem("X031.line_end", value.place, tag=value.tag)
        elif value.tag == COMMENT:
            continue
        elif "//" in _TEXT.sub("", value.text):
            yield problem("X031.comment", value.place, tag=value.tag, comment=COMMENT)
        elif _WORD.match(value.text):
            yield problem("X031.keyword", value.place, tag=value.tag, word=value.text.split()[0])
    for value in extension_map.of(FREQUENCY):
        if _rate(value.text) is None:
            yield problem("X031.frequency", value.place, value=value.text)
    if sum(len(value.text) for value in extension_map.values) > _LIMIT:
        yield problem("X003.characters", extension_map.place, attribute=EVENTS, limit=_LIMIT)


def _rate(text: str) -> float | None:
    try:
        rate = float(text)
    except ValueError:
        return None
    return rate if 1e-6 <= rate <= 1e9 else None


def as_eddi_map(name: str, events: Events, place: Place) -> tuple[str, Sequence[tuple[str, str]]]:
    """Return the map that holds the events of a file.

    Raises:
        EddiError: a comment is not on a line of its own, or there is a bare expression (X031).
    """
    text = events.text
    tokens = [
        token for token in tokens_of(text, TextFindings(text, in_text(text))) if token.text != ";"
    ]
    begins = [
        k
        for k, token in enumerate(tokens)
        if token.keyword in DECLARATIONS and (k == 0 or tokens[k - 1].text != ".")
    ]
    if not begins or begins[0] != 0:
        raise EddiError(problem("X031.not_a_declaration", place))
    entries: list[tuple[int, str, str]] = []
    for first, last in zip(begins, [*begins[1:], len(tokens) - 1], strict=True):
        start, end = tokens[first].end, tokens[last - 1].end
        words = re.sub(r"[ \t]*[\r\n]\s*", " ", text[start:end]).strip()
        entries.append((tokens[first].start, tokens[first].keyword, words))
        line = text.find("\n", end)
        for at, _ in comments_of(text):  # inside of the declaration, or behind it on its line
            if tokens[first].start < at < (line if line >= 0 else len(text)):
                raise EddiError(problem("X031.comment_behind", in_text(text, place.file)(at)))
    for start, end in comments_of(text):
        entries.append((start, COMMENT, text[start + 2 : end].strip()))
    rate = [(FREQUENCY, f"{events.rate:g}")] if events.rate != DEFAULT_RATE else []
    declared = [(tag, value) for _, tag, value in sorted(entries)]
    return EVENTS, [(MODEL, name), *rate, *declared]
