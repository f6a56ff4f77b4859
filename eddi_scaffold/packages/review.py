"""What is doubtful in a hand-written body: names that nothing else knows, and certain mistakes."""

from __future__ import annotations

import ast
import re
from bisect import bisect_left
from collections.abc import Iterable, Iterator
from pathlib import Path

from eddi_scaffold.files import read_regular
from eddi_scaffold.packages.mistakes import Inputs, Messages
from eddi_scaffold.python_text import parse_python
from eddi_scaffold.regions.marked_file import Region

NO_MESSAGES = Messages()
_BASE = "EDDIInputBase"
_INHERITED = (
    *("begin_processing", "begin_step", "bind", "end_step", "expression", "look_again"),
    *("processed", "processing", "received", "setup", "states"),
    *("update", "update_each", "update_expression"),
    *dir(object),
)
_OF_D72 = re.compile(r"^class EDDIInput\s*(\(\s*(object)?\s*\))?\s*:", re.MULTILINE)
ADOPT = (
    "this file is of the D7.2 tools: it runs as it is, and no regeneration fits it to the model;"
    " `eddi-scaffold adopt OLD_PACKAGE` puts its bodies into regions"
)
_SETTERS = {"__dict__", "setattr", "vars"}


def doubtful_names(
    text: str, regions: Iterable[Region], messages: Messages = NO_MESSAGES
) -> dict[str, tuple[str, ...]]:
    """Return for each region what its body assigns in vain, or reads though nothing sets it.

    ``self.x`` that neither the class outside of this region assigns nor anything in it reads,
    ``self.x`` of an ``EDDIInput`` that nothing in the class sets, local names that the function
    never reads, and of the body of an input what cannot be meant (:mod:`.mistakes`). Empty for a
    file that does not parse.

    Args:
        text: the file.
        regions: its hand-written regions.
        messages: what is known of the messages that the methods of inputs are given.
    """
    text = text.removeprefix("\ufeff")
    try:
        tree = parse_python(text)
    except SyntaxError:
        return {}
    inputs = Inputs(text, tree, _BASE)
    nodes = list(ast.walk(tree))
    classes = _Scopes([n for n in nodes if isinstance(n, ast.ClassDef)])
    functions = _Scopes([n for n in nodes if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)])
    found = {}
    for region in regions:
        if not region.id.startswith(("process_", "node_")):
            continue
        lines = range(region.line + 1, region.line + region.body.count("\n") + 1)
        owner, function = classes.around(lines), functions.around(lines)
        notes = [
            *(_attributes(owner, lines) if owner else ()),
            *(_unset(owner, lines) if owner else ()),
            *(_locals(function, lines) if function else ()),
        ]
        if region.id.startswith("process_"):
            notes += inputs.mistakes(f"EDDIInput.{region.id}", lines, messages)
            notes += () if notes else inputs.sets_nothing(f"EDDIInput.{region.id}", lines)
        if notes:
            found[region.id] = tuple(dict.fromkeys(notes))
    return found


def is_of_d72(file: Path) -> bool:
    """Return whether a file has an ``EDDIInput`` as the D7.2 tools wrote it."""
    try:
        return _OF_D72.search(read_regular(file).decode("utf-8", "replace")) is not None
    except OSError:  # a FIFO as well, which would be waited for
        return False


class _Scope:
    """A class or function, with what is known of its names after one walk."""

    def __init__(self, node: ast.stmt) -> None:
        self.last = node.end_lineno or 0
        inside = list(ast.walk(node))
        self.attributes = _Uses(
            (one.lineno, one.attr, _reads(one))
            for one in inside
            if isinstance(one, ast.Attribute)
            and isinstance(one.value, ast.Name)
            and one.value.id == "self"
        )
        known = _known(node, inside) if isinstance(node, ast.ClassDef) else None
        read_only = self.attributes.read - self.attributes.written
        self.unset: set[str] = set() if known is None else read_only - known
        self.names = _Uses(
            (one.lineno, one.id, _reads(one)) for one in inside if isinstance(one, ast.Name)
        )


class _Uses:
    """Places of names, and which are read."""

    def __init__(self, uses: Iterable[tuple[int, str, bool]]) -> None:
        found = list(uses)
        self.places = sorted((line, number, name) for number, (line, name, _) in enumerate(found))
        self.read = {name for _, name, reads in found if reads}
        self.written = {name for _, name, reads in found if not reads}
        self.first: dict[str, int] = {}
        self.last: dict[str, int] = {}
        for line, _, name in self.places:
            self.first.setdefault(name, line)
            self.last[name] = line

    def within(self, lines: range) -> list[str]:
        """Return the names in some lines, in the order of the walk."""
        start = bisect_left(self.places, (lines.start,))
        stop = bisect_left(self.places, (lines.stop,))
        return [name for _, name in sorted(place[1:] for place in self.places[start:stop])]


class _Scopes:
    """The classes, or the functions, of a file by line."""

    def __init__(self, nodes: Iterable[ast.stmt]) -> None:
        self._at: dict[int, ast.stmt] = {}
        self._known: dict[ast.stmt, _Scope] = {}
        for node in sorted(nodes, key=lambda one: one.lineno):
            self._at |= dict.fromkeys(range(node.lineno + 1, (node.end_lineno or 0) + 1), node)

    def around(self, lines: range) -> _Scope | None:
        """Return the innermost one around some lines."""
        node = self._at.get(lines.start - 1)
        if node is None:
            return None
        if node not in self._known:
            self._known[node] = _Scope(node)
        return self._known[node] if self._known[node].last >= lines.stop - 1 else None


def _attributes(owner: _Scope, lines: range) -> Iterator[str]:
    uses = owner.attributes
    for name in uses.within(lines):
        inside = lines.start <= uses.first[name] and uses.last[name] < lines.stop
        if inside and name not in uses.read:
            yield f"'self.{name}' is assigned, but nothing else in the class knows it"


def _unset(owner: _Scope, lines: range) -> Iterator[str]:
    for name in owner.attributes.within(lines):
        if name in owner.unset:
            yield f"'self.{name}' is read, but nothing in the class sets it"


def _known(owner: ast.ClassDef, inside: Iterable[ast.AST]) -> set[str] | None:
    """Return what an ``EDDIInput`` has without an assignment; None where nobody can tell."""
    own = [base.id for base in owner.bases if isinstance(base, ast.Name)] == [_BASE]
    names = {getattr(one, "id", getattr(one, "attr", None)) for one in inside}
    methods = {one.name for one in owner.body if isinstance(one, ast.FunctionDef)}
    if len(owner.bases) != 1 or not own or names & _SETTERS or "__getattr__" in methods:
        return None
    assigned = {
        one.id
        for line in owner.body
        if isinstance(line, ast.Assign | ast.AnnAssign)
        for one in ast.walk(line)
        if isinstance(one, ast.Name)
    }
    return {*methods, *assigned, *_INHERITED}


def _locals(function: _Scope, lines: range) -> Iterator[str]:
    for name in function.names.within(lines):
        if name not in function.names.read and name[0] != "_":
            yield f"{name!r} is assigned, but nothing in the function uses it"


def _reads(node: ast.Attribute | ast.Name) -> bool:
    return isinstance(node.ctx, ast.Load)
