"""Bayesian networks from BIF text (Cozman, "The Interchange Format ..." 0.15)."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Any, NamedTuple

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    SimilarNames,
    has_errors,
    problem,
)
from eddi_scaffold.kinds.bayesian_network.checks import (
    check_network,
    defined_twice,
    first_missing,
    no_variable,
    unsupported,
)
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network, in_digits
from eddi_scaffold.kinds.bayesian_network.read_xdsl import LARGEST

CODE = "B201"
_CONTROL = re.compile(r"[\0-\x08\x0e-\x1f\x7f]")


class Word(NamedTuple):
    """A word, a text in quotes without them, or a mark; empty at the end of the file."""

    text: str
    at: int
    is_name: bool


class Words:
    """What a text consists of, one word after the other.

    Args:
        source: the file.
        pattern: its groups are a text in quotes, a mark, a word, and what is none of them; white
            space and comments are in no group.

    Raises:
        EddiError: the file is not UTF-8, or holds control characters (B201).
    """

    def __init__(self, source: Source, pattern: re.Pattern[str]) -> None:
        self.file = source.name
        self._text = source.text(CODE)
        self._lines: list[int] | None = None
        control = _CONTROL.search(self._text)
        if control is not None:
            word = Word(control[0], control.start(), is_name=False)
            raise self.fault("B201.character", word, character=control[0])
        self._rest = self._words(pattern)
        self.next = next(self._rest)

    def _words(self, pattern: re.Pattern[str]) -> Iterator[Word]:
        for match in pattern.finditer(self._text):
            group = match.lastindex
            if group is None:
                continue
            word = Word(match[group], match.start(), group in (1, 3))
            if group == 4:
                raise self.fault("B201.unfinished", word, text=word.text)
            yield word
        while True:
            yield Word("", len(self._text), is_name=False)

    @property
    def at_end(self) -> bool:
        """Whether no word is left."""
        return self.next.at == len(self._text)

    def take(self) -> Word:
        """Return the next word and go on."""
        word, self.next = self.next, next(self._rest)
        return word

    def is_mark(self, *marks: str) -> bool:
        """Return whether the next word is one of these marks."""
        return not self.next.is_name and self.next.text in marks

    def skip_mark(self, mark: str) -> bool:
        """Return whether this mark is next, and go behind it."""
        found = self.is_mark(mark)
        if found:
            self.take()
        return found

    def mark(self, mark: str) -> None:
        """Go behind a mark that must be next."""
        if not self.skip_mark(mark):
            raise self.expected(f"`{mark}`")

    def name(self, what: str) -> Named:
        """Return the next word, which must be a name or a number."""
        if not self.next.is_name:
            raise self.expected(what)
        word = self.take()
        return Named(word.text, self.place(word))

    def names(self, what: str, end: str) -> list[Named]:
        """Return all names up to a mark, and go behind it."""
        found = []
        while not self.skip_mark(end):
            found.append(self.name(f"{what} or `{end}`"))
        return found

    def values(self, end: str = ";") -> tuple[str, ...]:
        """Return the texts of all names up to a mark, and go behind it; for many numbers."""
        found = []
        while self.next.is_name:
            found.append(self.take().text)
        self.mark(end)
        return tuple(found)

    def skip_to(self, mark: str) -> None:
        """Go behind the next mark of this form."""
        while not self.skip_mark(mark):
            if self.at_end:
                raise self.expected(f"`{mark}`")
            self.take()

    def place(self, word: Word) -> Place:
        """Return the place of a word."""
        if self._lines is None:
            self._lines = [0, *(match.end() for match in re.finditer("\n", self._text))]
        line = bisect_right(self._lines, word.at)
        return Place(self.file, line, word.at - self._lines[line - 1] + 1)

    def expected(self, what: str) -> EddiError:
        """Return the problem that the next word is something else."""
        found = "the end of the file" if self.at_end else repr(self.next.text)
        return self.fault("B201.expected", self.next, expected=what, actual=found)

    def fault(self, case: str, word: Word, /, **fields: Any) -> EddiError:
        """Return a problem with the form of the text (B201)."""
        return EddiError(problem(case, self.place(word), **fields))


_PATTERN = re.compile(
    r"""[\s,]+|//[^\n]*|/\*.*?\*/|"([^"]*)"|([{}()\[\]|;])|"""
    r"""((?:[^\s,{}()\[\]|;"/]+|/(?![/*]))+)|(/\*|.)""",
    re.DOTALL,
)
"""The format ignores commas; a comment may follow a word without a blank."""


@dataclass
class _Table:
    """What ``probability`` gives for one variable.

    Attributes:
        table: all numbers; the states of the variable itself vary slowest.
        rows: states of the parents -> numbers, with their place.
        default: the row of all other states.
    """

    place: Place
    parents: tuple[Named, ...]
    table: tuple[str, ...] | None = None
    rows: dict[tuple[str, ...], tuple[tuple[str, ...], Place]] = field(default_factory=dict)
    default: tuple[str, ...] | None = None


def read_bif(source: Source) -> tuple[Network | None, list[Problem]]:
    """Read the network of a BIF file."""
    try:
        reader = _Reader(Words(source, _PATTERN))
        reader.read()
    except EddiError as fault:
        return None, list(fault.problems)
    if reader.others:
        hint = "write it as a discrete variable"
        return None, [unsupported(of, nodes, hint) for of, nodes in reader.others.items()]
    drafts = [reader.draft(name, variable) for name, variable in reader.variables.items()]
    near = SimilarNames(reader.variables)
    for name, table in reader.tables.items():
        if name not in reader.variables:
            reader.problems.append(no_variable(name, table.place, near.hint(name)))
    network, problems = check_network(reader.name or source.stem, drafts, Place(source.name, 1))
    return (None if reader.problems else network), [*reader.problems, *problems]


class _Reader:
    def __init__(self, words: Words) -> None:
        self.words = words
        self.name = ""
        self.variables: dict[str, tuple[Place, tuple[Named, ...]]] = {}
        self.tables: dict[str, _Table] = {}
        self.others: dict[str, list[Named]] = {}
        self.problems: list[Problem] = []

    def read(self) -> None:
        """Read all blocks.

        Raises:
            EddiError: the text does not have the form of the format (B201).
        """
        blocks = {"network": self._network, "variable": self._variable, "probability": self._table}
        while not self.words.at_end:
            block = blocks.get(self.words.next.text)
            if block is None:
                raise self.words.expected("`network`, `variable` or `probability`")
            self.words.take()
            block()

    def _network(self) -> None:
        self.name = self.words.name("the name of the network").text
        self.words.mark("{")
        while not self.words.skip_mark("}"):
            self._property("`property`")

    def _property(self, what: str) -> None:
        if self.words.next.text != "property":
            raise self.words.expected(what)
        self.words.skip_to(";")

    def _variable(self) -> None:
        name = self.words.name("the name of a variable")
        states: tuple[Named, ...] = ()
        of = ""
        self.words.mark("{")
        while not self.words.skip_mark("}"):
            if self.words.next.text != "type":
                self._property("`type`, `property` or `}`")
                continue
            if of:
                raise self.words.fault("B201.two_types", self.words.next, name=name.text)
            self.words.take()
            of = self.words.name("the type of the variable").text
            if of == "discrete":
                states = self._states()
            else:
                self.others.setdefault(of, []).append(name)
                self.words.skip_to(";")
        if name.text in self.variables:
            line = self.variables[name.text][0].line
            self.problems.append(
                problem("B101.duplicate_node", name.place, draft=name.text, line=line)
            )
            return
        self.variables[name.text] = (name.place, states)

    def _states(self) -> tuple[Named, ...]:
        self.words.mark("[")
        announced = self.words.next
        number = self.words.name("the number of states")
        self.words.mark("]")
        self.words.mark("{")
        states = self._names_of_states("the name of a state", "}")
        self.words.mark(";")
        if number.text != str(len(states)):
            raise self.words.fault(
                "B201.states", announced, announced=number.text, actual=len(states)
            )
        return tuple(states)

    def _names_of_states(self, what: str, end: str) -> list[Named]:
        """Return the names up to a mark; an interval such as ``(0.5,1.5]`` is one name."""
        found: list[Named] = []
        while not self.words.skip_mark(end):
            if not self.words.is_mark("(", "["):
                found.append(self.words.name(f"{what} or `{end}`"))
                continue
            first, inner = self.words.take(), ""
            while not self.words.is_mark(")", "]"):
                inner += f"{',' if inner else ''}{self.words.name('an end of an interval').text}"
            found.append(
                Named(f"{first.text}{inner}{self.words.take().text}", self.words.place(first))
            )
        return found

    def _table(self) -> None:
        self.words.mark("(")
        name = self.words.name("the name of a variable")
        self.words.skip_mark("|")  # JavaBayes leaves it out
        parents = self.words.names("the name of a parent", ")")
        table = _Table(name.place, tuple(parents))
        self.words.mark("{")
        while not self.words.skip_mark("}"):
            self._entry(name.text, table)
        if name.text in self.tables:
            line = self.tables[name.text].place.line
            self.problems.append(defined_twice(name.text, line, name.place))
        self.tables.setdefault(name.text, table)

    def _entry(self, name: str, table: _Table) -> None:
        word = self.words.next
        if self.words.skip_mark("("):
            self._row(name, table, word)
        elif word.text in ("table", "default"):
            if (
                table.table
                or getattr(table, word.text)
                or (word.text == "table" and (table.rows or table.default))
            ):
                raise self.words.fault("B201.two_tables", word, name=name)
            self.words.take()
            setattr(table, word.text, self.words.values())
        else:
            self._property("`table`, `default`, `(`, `property` or `}`")

    def _row(self, name: str, table: _Table, word: Word) -> None:
        if table.table is not None:
            raise self.words.fault("B201.two_tables", word, name=name)
        states = tuple(s.text for s in self._names_of_states("the state of a parent", ")"))
        place = self.words.place(word)
        if states in table.rows:
            line = table.rows[states][1].line
            self.problems.append(
                problem("B110.duplicate_row", place, row=", ".join(states), name=name, line=line)
            )
        table.rows[states] = self.words.values(), place

    def draft(self, name: str, variable: tuple[Place, tuple[Named, ...]]) -> Draft:
        """Return a variable with its table in the order of all tables."""
        place, states = variable
        table = self.tables.get(name)
        if table is None:
            return Draft(name, name, states, (), None, place, place)
        before = len(self.problems)
        shapes = [self.variables.get(parent.text, (place, ()))[1] for parent in table.parents]
        parents = [[state.text for state in shape] for shape in shapes]
        values: tuple[str, ...] | None = None
        rows: tuple[Place, ...] = ()
        broken = any(len(set(of)) < max(1, len(of)) for of in parents)  # reported there
        if table.table is not None:
            values = _transposed(table.table, len(states))
        elif not broken and (table.rows or table.default is not None):
            values, rows = self._filled(name, table, parents, len(states))
        broken = broken or has_errors(self.problems[before:])
        return Draft(
            *(name, name, states, table.parents, values, place, table.place),
            rows=rows,
            broken=broken,
        )

    def _filled(
        self, name: str, table: _Table, parents: list[list[str]], own: int
    ) -> tuple[tuple[str, ...], tuple[Place, ...]]:
        """Return the numbers of all rows with their places; empty after an error."""
        before = len(self.problems)
        names = [parent.text for parent in table.parents]
        count = math.prod(len(of) for of in parents)
        known = [(set(of), SimilarNames(of)) for of in parents]
        for states, (numbers, place) in table.rows.items():
            if len(states) != len(names):
                counts = f"{len(states)} states, it has {len(names)} parents"
                self.problems.append(problem("B110.row_parents", place, name=name, listed=counts))
            for parent, state, (of, near) in zip(names, states, known, strict=False):
                if state not in of:
                    self.problems.append(
                        problem(
                            "B205.unknown_parent_state",
                            place,
                            hint=near.hint(state),
                            state=state,
                            parent=parent,
                        )
                    )
            self._check_width(name, numbers, own, place)
        if table.default is not None:
            self._check_width(name, table.default, own, table.place)
            if count * own > LARGEST:
                size = in_digits(count * own)
                self.problems.append(
                    problem(
                        "B110.table_too_large", table.place, name=name, size=size, limit=LARGEST
                    )
                )
        elif not has_errors(self.problems[before:]):
            lacking, shown = first_missing(names, parents, set(table.rows))
            if lacking:
                rows = "row" if lacking == 1 else "rows"
                more = ", ..." if lacking > len(shown) else ""
                self.problems.append(
                    problem(
                        "B110.missing_rows",
                        table.place,
                        name=name,
                        number=lacking,
                        rows=rows,
                        shown="; ".join(shown),
                        rest=more,
                    )
                )
        if has_errors(self.problems[before:]):
            return (), ()
        default = (table.default or (), table.place)
        found = [table.rows.get(states, default) for states in product(*parents)]
        return tuple(n for numbers, _ in found for n in numbers), tuple(p for _, p in found)

    def _check_width(self, name: str, numbers: tuple[str, ...], own: int, place: Place) -> None:
        if len(numbers) != own:
            self.problems.append(
                problem("B110.row_length", place, name=name, actual=len(numbers), expected=own)
            )


def _transposed(table: tuple[str, ...], own: int) -> tuple[str, ...]:
    """Return the numbers of ``table`` row by row, if there is a number for each place."""
    rows = len(table) // own if own else 0
    if rows * own != len(table):
        return table
    return tuple(value for row in range(rows) for value in table[row::rows])
