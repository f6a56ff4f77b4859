"""Events as data, read from files and from EDDIs.

In an EDDI there is a declaration for each value of a map ``eddi.events``. They become the lines of
a text, which is read like a file; what is wrong in it is reported at the value, with the column in
its text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.common.units import accepted
from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.standalone import column_of
from eddi_scaffold.conditions.tokens import (
    DECLARATIONS,
    TextFindings,
    comments_of,
    in_text,
    line_and_column,
    tokens_of,
)
from eddi_scaffold.conditions.uses import uses
from eddi_scaffold.eddi_xml.extensions import (
    EVENTS,
    MODEL,
    ExtensionMap,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.program.instructions import Program

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument


NAME = "event"
DEFAULT_RATE = 10.0  # Steps per second where no configuration gives another number
_VARIABLE = re.compile(r"VAR\s+(\w+)")


@dataclass(frozen=True)
class Events:
    """A file of events."""

    text: str = field(compare=False)  # of the file
    analysis: Analysis  # of the text, at the rate if it is known already
    rate: float  # steps per second
    # places of the lines in an EDDI, then of them all; empty in a file of events
    placed: Sequence[Place] = field(default=(), compare=False)


def read_text(
    text: str, name: str, placed: Sequence[Place] = (), rate: float | None = None
) -> tuple[Events | None, list[Problem]]:
    """Read a text of events, perhaps of an EDDI, with their rate without a configuration."""
    analysis = analysed(text, name, placed, None)
    place = placed[-1] if placed else Place(name, 1, 1)
    numbers = [event for event in analysis.events if event.type != "bool"]
    problems = [*analysis.problems, *(problem("E007.event_number", place) for _ in numbers)]
    events = Events(text, analysis, DEFAULT_RATE if rate is None else rate, placed)
    return None if has_errors(problems) else events, problems


def analysed(text: str, name: str, placed: Sequence[Place], rate: float | None) -> Analysis:
    """Return the analysis of a text at a rate, or before there is one.

    Raises:
        EddiError: the rate is not a positive number up to 1e9 (E005).
    """
    of = line_and_column(text)

    def locate(offset: int) -> Place:
        return placed[min(of(offset)[0], len(placed)) - 1]

    any_rate, in_eddi = rate is None, locate if placed else None
    return analyse(text, rate=rate, any_rate=any_rate, name=name, locate=in_eddi)


def commented(text: str) -> Iterator[tuple[str, str]]:
    """Yield the name of each VAR, with the comments above and behind it."""
    above: list[str] = []
    for line in text.splitlines():
        code, _, comment = (part.strip() for part in line.partition("//"))
        declaration = _VARIABLE.match(code)
        if declaration is not None:
            yield declaration[1], " ".join([*above, comment])
        above = [*above, comment] if comment and not code else []


def input_of(variable: Variable, uses: tuple[Use, ...]) -> ModelInput:
    """Return the input of a variable."""
    is_number = variable.type is not None and variable.type.kind == "number"
    covered = None
    if variable.range is not None:
        low, high = variable.range
        covered = f"known in [{low:g}, {high:g}] {variable.unit or ''}".rstrip()
    return ModelInput(
        variable.name,
        column_of(variable),
        unit=variable.unit or ("" if is_number else None),
        units=accepted(variable.unit) if is_number else None,
        covered=covered,
        uses=uses,
    )


def uses_of(program: Program) -> Mapping[str, tuple[Use, ...]]:
    """Return for each variable how it can bring an event nearer to what it claims.

    An EVIDENCE claims that it is true, a HAZARD that it is not.
    """
    uses_of_variable: dict[str, tuple[Use, ...]] = {}
    for result in program.results:
        for name, more in uses(program, result.operation, side=not result.hazard).items():
            uses_of_variable[name] = (*uses_of_variable.get(name, ()), *more)
    return uses_of_variable


COMMENT, FREQUENCY = "comment", "frequency"


def events_of_eddi(
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
        words = {COMMENT: "//"}
        rows = (f"{words.get(value.tag, value.tag)} {value.text}" for value in lines)
        text = "".join(f"{' '.join(row.splitlines())}\n" for row in rows)
        rate = next((_rate(value.text) for value in extension_map.of(FREQUENCY)), None)
        placed = [*(value.place for value in lines), extension_map.place]
        events, more = read_text(text, source.name, placed, rate)
        problems += more
        if events is not None:
            files.append((extension_map, replace(source, part=text.encode()), events))
    return files, problems


def _wrong_values(extension_map: ExtensionMap) -> Iterator[Problem]:
    """Yield what is wrong with values before they are one text (X031)."""
    for value in extension_map.of(*DECLARATIONS):
        if "//" in re.sub('"[^"]*"', "", value.text):
            yield problem("X031.comment", value.place, tag=value.tag, comment=COMMENT)
    for value in extension_map.of(FREQUENCY):
        if _rate(value.text) is None:
            yield problem("X031.frequency", value.place, value=value.text)


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
    tokens = [token for token in tokens_of(text, TextFindings(in_text(text))) if token.text != ";"]
    begins = [k for k, token in enumerate(tokens) if token.keyword in DECLARATIONS]
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
