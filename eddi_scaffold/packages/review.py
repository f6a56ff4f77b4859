"""What is doubtful in a hand-written body: names that nothing else knows, and certain mistakes."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from eddi_scaffold.common.escaping import parse_python
from eddi_scaffold.common.files import read_regular
from eddi_scaffold.common.identifiers import INPUT_MEMBERS
from eddi_scaffold.packages.mistakes import Inputs, Messages, is_self
from eddi_scaffold.regions.marked_file import Region

NO_MESSAGES = Messages()
_BASE = "EDDIInputBase"
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
    ``self.x`` of an ``EDDIInput`` that nothing in the class sets, and of the body of an input what
    cannot be meant (:mod:`.mistakes`). Empty for a file that does not parse.

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
    owners = [_Owner(node) for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    owners.sort(key=lambda owner: owner.lines.start, reverse=True)
    found = {}
    for region in regions:
        if not region.id.startswith(("process_", "node_")):
            continue
        lines = range(region.line + 1, region.line + region.body.count("\n") + 1)
        around = (one for one in owners if lines.start in one.lines and lines.stop in one.lines)
        owner = next(around, None)
        notes = [*owner.doubts(lines)] if owner is not None else []
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


class _Owner:
    """A class, with what is known of its attributes after one walk."""

    def __init__(self, node: ast.ClassDef) -> None:
        self.lines = range(node.lineno, (node.end_lineno or 0) + 1)
        inside = list(ast.walk(node))
        self._in_line: dict[int, list[str]] = {}
        self._uses: dict[str, tuple[int, int]] = {}  # first and last line
        self._read: set[str] = set()
        written: set[str] = set()
        for one in inside:
            if isinstance(one, ast.Attribute) and is_self(one.value):
                name, line = one.attr, one.lineno
                self._in_line.setdefault(line, []).append(name)
                first, last = self._uses.get(name, (line, line))
                self._uses[name] = min(first, line), max(last, line)
                (self._read if isinstance(one.ctx, ast.Load) else written).add(name)
        known = _known(node, inside)
        self._unset = set() if known is None else self._read - written - known

    def doubts(self, lines: range) -> Iterator[str]:
        """Yield what is doubtful in some lines."""
        names = [name for line in lines for name in self._in_line.get(line, ())]
        for name in names:
            first, last = self._uses[name]
            if name not in self._read and first in lines and last in lines:
                yield f"'self.{name}' is assigned, but nothing else in the class knows it"
        for name in names:
            if name in self._unset:
                yield f"'self.{name}' is read, but nothing in the class sets it"


def _known(owner: ast.ClassDef, inside: Iterable[ast.AST]) -> set[str] | None:
    """Return what an ``EDDIInput`` has without an assignment; None where nobody can tell."""
    own = [base.id for base in owner.bases if isinstance(base, ast.Name)] == [_BASE]
    names = {getattr(one, "id", getattr(one, "attr", None)) for one in inside}
    methods = {one.name for one in owner.body if isinstance(one, ast.FunctionDef)}
    if len(owner.bases) != 1 or not own or names & _SETTERS or "__getattr__" in methods:
        return None
    assigned = {
        node.id
        for line in owner.body
        if isinstance(line, ast.Assign | ast.AnnAssign)
        for node in ast.walk(line)
        if isinstance(node, ast.Name)
    }
    return {*methods, *assigned, *INPUT_MEMBERS, *dir(object)}
