"""What each diagnostic says and means: the only place of these texts.

A file for the codes of each letter, ``K.toml``. A code has a table with its ``title``, ``why`` it
matters and what helps (``fix``); what is printed stands in a table for each case
(``[K029.long]``), or in that of the code where it has one case only. A call names the case, and
gives the fields of its text and its hint.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

from eddi_scaffold.common.toml_tables import read_toml

Level = Literal["error", "warning", "info"]
FOLDER = Path(__file__).parent


class Case(NamedTuple):
    """What is printed: a level, and templates of a text and of a hint."""

    level: Level
    text: str
    hint: str | None


@dataclass(frozen=True)
class Diagnostic:
    """One code."""

    code: str  # the letter of its area, and three digits
    title: str  # a few words
    why: str  # why it matters
    fix: str  # what helps
    # name -> what is printed; the name is empty where there is one case only
    cases: dict[str, Case]

    @property
    def levels(self) -> list[Level]:
        """With which it can come, the worst first."""
        levels = {case.level for case in self.cases.values()}
        return [level for level in get_args(Level) if level in levels]

    def as_json(self) -> dict[str, object]:
        """Return all of it for programs."""
        return {
            "code": self.code,
            "title": self.title,
            "levels": self.levels,
            "why": self.why,
            "fix": self.fix,
            "cases": [{"case": name, **case._asdict()} for name, case in self.cases.items()],
        }

    def shown(self) -> list[str]:
        """Return the lines of what is printed, with the names of fields in capitals."""
        lines = []
        for case in self.cases.values():
            lines.append(f"  {case.level}: {_FIELD.sub(_capitals, case.text)}")
            lines += [f"    hint: {_FIELD.sub(_capitals, case.hint)}"] if case.hint else []
        return lines


_FIELD = re.compile(r"\{(\w+)[^{}]*\}|\{\{|\}\}")


def _capitals(match: re.Match[str]) -> str:
    return match[1].upper() if match[1] else match[0][0]


class Area(NamedTuple):
    """The codes of one letter, and what they are about."""

    letter: str
    title: str
    about: str
    diagnostics: dict[str, Diagnostic]


@cache
def area(letter: str) -> Area:
    """Return the codes of one letter: a command loads only the areas of its problems."""
    tables = read_toml(FOLDER / f"{letter}.toml")
    title, about = tables.pop("title"), tables.pop("about")
    return Area(
        letter, title, about, {code: _diagnostic(code, table) for code, table in tables.items()}
    )


def _diagnostic(code: str, table: dict[str, Any]) -> Diagnostic:
    cases = {name: entry for name, entry in table.items() if isinstance(entry, dict)}
    return Diagnostic(
        code,
        table["title"],
        " ".join(table["why"].split()),
        " ".join(table["fix"].split()),
        {
            name: Case(entry["level"], entry["text"], entry.get("hint"))
            for name, entry in (cases or {"": table}).items()
        },
    )


def case_of(name: str) -> Case:
    """Return the case that a call names, ``K029.long`` or ``K028``."""
    code, _, case = name.partition(".")
    return area(code[0]).diagnostics[code].cases[case]


def areas() -> list[Area]:
    """Return all areas, in the order of their letters."""
    return [area(path.stem) for path in sorted(FOLDER.glob("*.toml"))]


def find(code: str) -> Diagnostic | None:
    """Return the diagnostic of a code, in whatever case it is written."""
    diagnostics = (entry for area in areas() for entry in area.diagnostics.values())
    return next((entry for entry in diagnostics if entry.code == code.upper()), None)
