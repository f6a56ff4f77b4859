"""What each diagnostic means, why it matters and what to do: the registry behind ``explain``.

The texts are in ``areas/*.md``, one file for the codes of one letter, edited by hand::

    # K: Configurations

    What the codes of this letter are about.

    ## K002 unknown key

    *warning*

    Why it matters.

    What to do: what helps.

        what is printed, word for word (`script/diagnostics.py` fills it in)
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import cast

from eddi_scaffold.common.problems import Level

AREAS = Path(__file__).with_name("areas")
_SECTION = re.compile(
    r"([A-Z]\d{3}) (.+)\n\n\*(.+)\*\n\n((?:.+\n)+)\nWhat to do: ((?:.+\n)+)((?: {4}.+\n|\n)*)"
)


@dataclass(frozen=True)
class Diagnostic:
    """One code.

    Attributes:
        code: the letter of its area, and three digits.
        title: a few words.
        levels: with which it can come.
        why: why it matters.
        what_to_do: what helps.
        example: lines as they are printed, from a test.
    """

    code: str
    title: str
    levels: tuple[Level, ...]
    why: str
    what_to_do: str
    example: str


@dataclass(frozen=True)
class Area:
    """The codes of one letter.

    Attributes:
        letter: with which they begin.
        title: what they are about, in a few words.
        about: the same in sentences.
        diagnostics: in the order of their codes.
    """

    letter: str
    title: str
    about: str
    diagnostics: tuple[Diagnostic, ...]


@cache
def areas() -> tuple[Area, ...]:
    """Return all areas, in the order of their letters."""
    return tuple(parse_area(path.read_text("utf-8")) for path in sorted(AREAS.glob("*.md")))


def parse_area(text: str) -> Area:
    """Return the area that one file describes.

    Raises:
        ValueError: the file has not the form that the docstring of this module shows.
    """
    head, *sections = re.split(r"(?m)^## ", text)
    match = re.fullmatch(r"# ([A-Z]): (.+)\n\n(.+)", head.strip(), re.DOTALL)
    if match is None:
        raise ValueError(f"no head of an area: {head!r}")
    letter, title, about = match.groups()
    return Area(letter, title, _joined(about), tuple(_diagnostic(section) for section in sections))


def _diagnostic(section: str) -> Diagnostic:
    match = _SECTION.fullmatch(f"{section.rstrip()}\n")
    if match is None:
        raise ValueError(f"no section of a diagnostic: {section!r}")
    code, title, levels, why, what_to_do, example = match.groups()
    return Diagnostic(
        code,
        title,
        tuple(cast("Level", level) for level in levels.split(", ")),
        _joined(why),
        _joined(what_to_do),
        re.sub(r"(?m)^ {4}", "", example).strip("\n"),
    )


def _joined(paragraph: str) -> str:
    return " ".join(paragraph.split())


def find(code: str) -> Diagnostic | None:
    """Return the diagnostic of a code, in whatever case it is written; ``None`` for none."""
    return next((one for one in _all() if one.code == code.upper()), None)


def near(code: str) -> list[str]:
    """Return up to three codes that are most like a text, of its letter where there are any."""
    code, known = code.upper(), [one.code for one in _all()]
    of_letter = [one for one in known if one[:1] == code[:1]]
    return difflib.get_close_matches(code, of_letter or known, n=3, cutoff=0.5)


def _all() -> list[Diagnostic]:
    return [diagnostic for area in areas() for diagnostic in area.diagnostics]
