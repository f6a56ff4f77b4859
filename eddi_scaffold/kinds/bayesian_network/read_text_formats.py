"""Bayesian networks from BIF text (Cozman, "The Interchange Format ..." 0.15)."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.bayesian_network.checks import check_network, unsupported
from eddi_scaffold.kinds.bayesian_network.network import Draft, Named, Network, Row

_CONTROL = re.compile(r"[\0-\x08\x0e-\x1f\x7f]")
_TOKENS = re.compile(
    r"""[\s,]+|//[^\n]*|/\*.*?\*/|"([^"]*)"|([{}()\[\]|;])|"""
    r"""((?:[^\s,{}()\[\]|;"/]+|/(?![/*]))+)|(/\*|.)""",
    re.DOTALL,
)
"""Blanks and comments; a text in quotes, a mark, a word, what is none of them.

The format ignores commas; a comment may follow a word without a blank.
"""


class _Token(NamedTuple):
    """A word or a text in quotes, without them; a mark; empty at the end of the file."""

    text: str
    position: int
    is_name: bool


@dataclass
class _Table:
    """What ``probability`` gives for one variable."""

    place: Place
    parents: tuple[Named, ...]
    # all numbers; the states of the variable itself vary slowest
    table: tuple[str, ...] | None = None
    rows: dict[tuple[str, ...], Row] = field(default_factory=dict)  # by the states of the parents
    default: tuple[str, ...] | None = None  # the numbers of all other rows


def read_bif(source: Source) -> tuple[Network | None, list[Problem]]:
    """Read the network of a BIF file."""
    try:
        reader = _BifReader(source)
    except EddiError as fault:
        return None, list(fault.problems)
    if reader.others:
        return None, unsupported(reader.others, {}, "write it as a discrete variable")
    drafts = reader.drafts()
    network, problems = check_network(reader.name or source.stem, drafts, Place(source.name, 1))
    return (None if reader.problems else network), [*reader.problems, *problems]


class _BifReader:
    """Reads all blocks.

    Raises:
        EddiError: the text does not have the form of the format (B201).
    """

    def __init__(self, source: Source) -> None:
        self.name = ""
        self.variables: dict[str, tuple[Place, tuple[Named, ...]]] = {}
        self.tables: dict[str, _Table] = {}
        self.others: list[tuple[str, Named]] = []
        self.problems: list[Problem] = []
        self._file, self._text = source.name, source.text("B201")
        self._lines = [0, *(match.end() for match in re.finditer("\n", self._text))]
        control = _CONTROL.search(self._text)
        if control is not None:
            token = _Token(control[0], control.start(), is_name=False)
            raise self._fault("B201.character", token, character=control[0])
        self._tokens = self._tokenised()
        self._next = next(self._tokens)
        blocks = {"network": self._network, "variable": self._variable, "probability": self._table}
        while not self._is_at_end():
            block = blocks.get(self._next.text)
            if block is None:
                raise self._expected("`network`, `variable` or `probability`")
            self._take()
            block()

    def _tokenised(self) -> Iterator[_Token]:
        for match in _TOKENS.finditer(self._text):
            group = match.lastindex
            if group is not None:
                token = _Token(match[group], match.start(), group in (1, 3))
                if group == 4:
                    raise self._fault("B201.unfinished", token, text=token.text)
                yield token
        while True:
            yield _Token("", len(self._text), is_name=False)

    def _is_at_end(self) -> bool:
        return self._next.position == len(self._text)

    def _take(self) -> _Token:
        token, self._next = self._next, next(self._tokens)
        return token

    def _is_mark(self, *marks: str) -> bool:
        return not self._next.is_name and self._next.text in marks

    def _skip(self, mark: str) -> bool:
        """Return whether this mark is next, and go behind it."""
        is_next = self._is_mark(mark)
        if is_next:
            self._take()
        return is_next

    def _mark(self, mark: str) -> None:
        if not self._skip(mark):
            raise self._expected(f"`{mark}`")

    def _named(self, what: str) -> Named:
        """Return the next token, which must be a name or a number."""
        if not self._next.is_name:
            raise self._expected(what)
        token = self._take()
        return Named(token.text, self._place(token))

    def _numbers(self) -> tuple[str, ...]:
        """Return the texts up to a semicolon."""
        numbers = []
        while self._next.is_name:
            numbers.append(self._take().text)
        self._mark(";")
        return tuple(numbers)

    def _states_until(self, end: str, what: str) -> tuple[Named, ...]:
        """Return the names up to a mark; an interval such as ``(0.5,1.5]`` is one name."""
        states: list[Named] = []
        while not self._skip(end):
            if not self._is_mark("(", "["):
                states.append(self._named(f"{what} or `{end}`"))
                continue
            first, limits = self._take(), []
            while not self._is_mark(")", "]"):
                limits.append(self._named("an end of an interval").text)
            text = f"{first.text}{','.join(limits)}{self._take().text}"
            states.append(Named(text, self._place(first)))
        return tuple(states)

    def _skip_statement(self, expected: str = "") -> None:
        """Skip all up to a semicolon: of a property, where something else is expected."""
        if expected and self._next.text != "property":
            raise self._expected(expected)
        while not self._skip(";"):
            if self._is_at_end():
                raise self._expected("`;`")
            self._take()

    def _place(self, token: _Token) -> Place:
        line = bisect_right(self._lines, token.position)
        return Place(self._file, line, token.position - self._lines[line - 1] + 1)

    def _expected(self, what: str) -> EddiError:
        actual = "the end of the file" if self._is_at_end() else repr(self._next.text)
        return self._fault("B201.expected", self._next, expected=what, actual=actual)

    def _fault(self, case: str, token: _Token, /, **fields: Any) -> EddiError:
        return EddiError(problem(case, self._place(token), **fields))

    def _report(self, case: str, place: Place, /, **fields: Any) -> None:
        self.problems.append(problem(case, place, **fields))

    def _network(self) -> None:
        self.name = self._named("the name of the network").text
        self._mark("{")
        while not self._skip("}"):
            self._skip_statement("`property`")

    def _variable(self) -> None:
        name = self._named("the name of a variable")
        states: tuple[Named, ...] = ()
        type_ = ""
        self._mark("{")
        while not self._skip("}"):
            if self._next.text != "type":
                self._skip_statement("`type`, `property` or `}`")
                continue
            if type_:
                raise self._fault("B201.two_types", self._next, name=name.text)
            self._take()
            type_ = self._named("the type of the variable").text
            if type_ == "discrete":
                self._mark("[")
                announced, number = self._next, self._named("the number of states").text
                self._mark("]")
                self._mark("{")
                states = self._states_until("}", "the name of a state")
                self._mark(";")
                if number != str(len(states)):
                    fields = {"announced": number, "actual": len(states)}
                    raise self._fault("B201.states", announced, **fields)
            else:
                self.others.append((type_, name))
                self._skip_statement()
        if name.text in self.variables:
            line = self.variables[name.text][0].line
            self._report("B101.duplicate_node", name.place, draft=name.text, line=line)
        else:
            self.variables[name.text] = (name.place, states)

    def _table(self) -> None:
        self._mark("(")
        name = self._named("the name of a variable")
        self._skip("|")  # JavaBayes leaves it out
        parents = []
        while not self._skip(")"):
            parents.append(self._named("the name of a parent or `)`"))
        table = _Table(name.place, tuple(parents))
        self._mark("{")
        while not self._skip("}"):
            self._entry(name.text, table)
        if name.text in self.tables:
            line = self.tables[name.text].place.line
            self._report("B110.duplicate_definition", name.place, name=name.text, line=line)
        self.tables.setdefault(name.text, table)

    def _entry(self, name: str, table: _Table) -> None:
        token = self._next
        is_table, is_default = token.text == "table", token.text == "default"
        if not is_table and not is_default and not self._is_mark("("):
            self._skip_statement("`table`, `default`, `(`, `property` or `}`")
            return
        is_second_default = is_default and table.default is not None
        is_second = table.table is not None or is_second_default
        if is_second or (is_table and (table.rows or table.default is not None)):
            raise self._fault("B201.two_tables", token, name=name)
        self._take()
        if is_table:
            table.table = self._numbers()
        elif is_default:
            table.default = self._numbers()
        else:
            states = tuple(s.text for s in self._states_until(")", "the state of a parent"))
            place = self._place(token)
            if states in table.rows:
                row, line = ", ".join(states), table.rows[states][1].line
                self._report("B110.duplicate_row", place, row=row, name=name, line=line)
            table.rows[states] = self._numbers(), place

    def drafts(self) -> list[Draft]:
        """Return the variables with what is known of their tables."""
        similar, drafts = SimilarNames(self.variables), []
        for name, table in self.tables.items():
            if name not in self.variables:
                hint = similar.hint(name)
                self._report("B205.unknown_variable", table.place, hint=hint, name=name)
        for name, (place, states) in self.variables.items():
            table = self.tables.get(name) or _Table(place, ())
            values, width = table.table, len(states)
            count = len(values or ()) // width if width else 0
            if values and count * width == len(values):  # row by row
                values = tuple(value for row in range(count) for value in values[row::count])
            rows = table.rows if table.rows or table.default is not None else None
            default = None if table.default is None else (table.default, table.place)
            drafts.append(
                Draft(
                    *(name, name, states, table.parents, values, place, table.place),
                    rows=rows,
                    default=default,
                )
            )
        return drafts
