"""Events in an EDDI, read and written: one declaration for each value of a map ``eddi.events``.

The declarations become the lines of one text, which is read like a file of events; what is wrong
in it is reported at the value, with the column in its text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import PartSource, Source
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, problem
from eddi_scaffold.conditions.findings import TextFindings, in_text
from eddi_scaffold.conditions.tokens import comments_of, tokens_of
from eddi_scaffold.eddi_xml.extensions import (
    EVENTS,
    MODEL,
    ExtensionMap,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.kinds.event.events import DEFAULT_RATE, NAME, EventModel, Placed, read_text

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument


DECLARATIONS = ("ENUM", "VAR", "CONST", "EVENT")
COMMENT, FREQUENCY = "comment", "frequency"
_LIMIT = 64 * 1024
_WORD = re.compile(r"(?:ENUM|VAR|CONST|EVENT)\b", re.IGNORECASE)
_TEXT = re.compile(r'"[^"]*"')


def read_eddi(document: EddiDocument, source: Source, _marks: Sequence[str]) -> ReadResult:
    """Read the events of an EDDI."""
    models: list[EventModel] = []
    problems: list[Problem] = []
    for extension_map in extension_maps(document, EVENTS):
        known = (MODEL, FREQUENCY, *DECLARATIONS, COMMENT)
        wrong = [*unknown_tags(extension_map, known, (FREQUENCY,)), *_wrong_values(extension_map)]
        problems += wrong
        if extension_map.model is None or has_errors(wrong):
            continue  # a missing name is told once for all kinds
        model, more = _model(extension_map, extension_map.model, source)
        problems += more
        models += [model] if model is not None else []
    return ReadResult(tuple(models), tuple(problems))


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


def _model(
    extension_map: ExtensionMap, name: str, source: Source
) -> tuple[EventModel | None, list[Problem]]:
    lines = extension_map.of(*DECLARATIONS, COMMENT)
    text = "".join(
        f"// {value.text}\n" if value.tag == COMMENT else f"{value.tag} {value.text}\n"
        for value in lines
    )
    rate = next((_rate(value.text) for value in extension_map.of(FREQUENCY)), None)
    places = tuple((value.tag, value.place) for value in lines)
    part = PartSource(source, text.encode())
    data, problems = read_text(text, source.name, Placed(places, extension_map.place), rate)
    if data is None:
        return None, problems
    return EventModel(NAME, name, data, part, extension_map.place), problems


def _rate(text: str) -> float | None:
    try:
        rate = float(text)
    except ValueError:
        return None
    return rate if 1e-6 <= rate <= 1e9 else None


def in_map(model: EventModel) -> tuple[str, Sequence[tuple[str, str]]]:
    """Return the map that holds the events of a file.

    Raises:
        EddiError: a comment is not on a line of its own, or there is a bare expression (X031).
    """
    text = model.data.text
    tokens = [
        token for token in tokens_of(text, TextFindings(text, in_text(text))) if token.text != ";"
    ]
    begins = [
        k
        for k, token in enumerate(tokens)
        if token.word in DECLARATIONS and (k == 0 or tokens[k - 1].text != ".")
    ]
    if not begins or begins[0] != 0:
        raise EddiError(problem("X031.not_a_declaration", model.place))
    entries: list[tuple[int, str, str]] = []
    for first, last in zip(begins, [*begins[1:], len(tokens) - 1], strict=True):
        start, end = tokens[first].end, tokens[last - 1].end
        words = re.sub(r"[ \t]*[\r\n]\s*", " ", text[start:end]).strip()
        entries.append((tokens[first].start, tokens[first].word, words))
        _refuse_comments(model, text, tokens[first].start, end)
    for start, end in comments_of(text):
        entries.append((start, COMMENT, text[start + 2 : end].strip()))
    rate = [(FREQUENCY, f"{model.data.rate:g}")] if model.data.rate != DEFAULT_RATE else []
    declared = [(tag, value) for _, tag, value in sorted(entries)]
    return EVENTS, [(MODEL, model.name), *rate, *declared]


def _refuse_comments(model: EventModel, text: str, start: int, end: int) -> None:
    """Refuse a comment inside of a declaration, or behind it on its line."""
    line = text.find("\n", end)
    for at, _ in comments_of(text):
        if start < at < (line if line >= 0 else len(text)):
            place = in_text(text, model.source.name)(at)
            raise EddiError(problem("X031.comment_behind", place))
