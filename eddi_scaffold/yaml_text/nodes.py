"""YAML as nodes with positions: the only module of the generator that imports ``yaml``.

A scalar stays the text that was written, together with the fact whether it was quoted; what a
plain scalar *means* is decided here: text, number or Boolean as YAML 1.2 has it
(:func:`as_text` and its neighbours), or the value of YAML 1.1 (:func:`value_11`), which ROS and
``eddi_config.yml`` follow. Documents are read event by event without recursion, so that alias
bombs, recursive aliases and deep nesting are a message like any other mistake.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field
from decimal import Decimal
from typing import TYPE_CHECKING, Any

import yaml

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.yaml_text.scalars import (
    MAX_DIGITS,
    Items,
    Map,
    Node,
    Number,
    Scalar,
    as_bool,
    as_integer,
    as_number,
    as_text,
    describe,
    is_null,
    shown,
    value_12,
)
from eddi_scaffold.yaml_text.spans import yaml_lines
from eddi_scaffold.yaml_text.writer import Verbatim, dump_plain, quoted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from eddi_scaffold.common.files import Source


__all__ = [
    "Items",
    "Map",
    "Node",
    "Number",
    "Scalar",
    "Verbatim",
    "as_bool",
    "as_integer",
    "as_number",
    "as_text",
    "describe",
    "differs_between_versions",
    "dump_11",
    "dump_plain",
    "is_null",
    "number_for_11",
    "quoted",
    "read_document",
    "read_map",
    "shown",
    "value_11",
    "value_12",
]

MAX_BYTES = 16 * 1024 * 1024
MAX_VISITS = 1_000_000
MAX_DEPTH = 32

_FAST_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_IS_SLOW = _FAST_LOADER is yaml.SafeLoader
_LARGE = 100_000
_CORE_TYPES = ("str", "int", "float", "bool", "null", "seq", "map")
_CORE_TAGS = frozenset({"!", *(f"tag:yaml.org,2002:{name}" for name in _CORE_TYPES)})


def read_document(source: Source, code: str) -> tuple[Node | None, list[Problem]]:
    """Read the one document of a YAML file.

    Args:
        source: the file, UTF-8.
        code: code of all problems of this step (``C001`` for a ConSert).

    Returns:
        The root node and the problems; the node is ``None`` where the document cannot be
        understood at all, and present when only keys are repeated (which is an error too).
    """
    if len(source.data) > MAX_BYTES:
        reason = f"the file has {len(source.data)} bytes, more than the limit of {MAX_BYTES}"
        return None, [problem(f"{code}.yaml", Place(source.name), reason=reason)]
    try:
        text = source.text(code)
    except EddiError as refused:
        return None, list(refused.problems)
    node, problems = _Composer(source.name, code, text).compose()
    if _IS_SLOW and len(source.data) > _LARGE:
        problems.append(problem("F003.slow_yaml", Place(source.name)))
    return node, problems


def read_map(source: Source, code: str) -> tuple[Map | None, list[Problem]]:
    """Read the one document of a YAML file whose top level must be a map."""
    node, problems = read_document(source, code)
    if node is not None and not isinstance(node, Map):
        reason = f"the top level must be a map, not {describe(node)}"
        return None, [*problems, problem(f"{code}.yaml", node.place, reason=reason)]
    return node, problems


def items_of(node: Node | None) -> tuple[Node, ...]:
    """Return the items of a list, none of anything else."""
    return node.items if isinstance(node, Items) else ()


def value_11(node: Node) -> Any:
    """Return the plain value of a node as YAML 1.1 has it, with dates and binary data as text.

    Keys of maps are always text, and numbers of more than :data:`MAX_DIGITS` characters too. What
    no construction exists for (a plain ``=``) is text too. Depth is bounded by :data:`MAX_DEPTH`.
    """
    if isinstance(node, Items):
        return [value_11(item) for item in node.items]
    if isinstance(node, Map):
        return {key.text: value_11(value) for key, value in node.entries}
    return _scalar_11(node.text) if node.plain else node.text


def dump_11(data: dict[str, str]) -> str:
    """Write a flat map as Copier's filter ``to_nice_yaml`` writes it into an answers file."""
    text = yaml.safe_dump(data, indent=4, allow_unicode=True, default_flow_style=False)
    return str(text)


def differs_between_versions(node: Node) -> bool:
    """Return whether YAML 1.1 and 1.2 read a plain scalar differently (``on``, ``1e3``)."""
    if not isinstance(node, Scalar) or not node.plain:
        return False
    old, new = _scalar_11(node.text), value_12(node)
    return repr(old) != repr(new)  # by text, since NaN differs from itself


_SHORT = 10
"""Characters of a number up to which it is written without an exponent."""
_DECIMAL = re.compile(
    r"(?P<minus>[-+]?)(?P<whole>[0-9]*)(?:\.(?P<rest>[0-9]*))?(?:[eE](?P<sign>[-+]?)(?P<power>[0-9]+))?",
    re.ASCII,
)


def number_for_11(node: Node) -> str | None:
    """Return how to write a number so that YAML 1.1, too, reads it: ``0.001`` for ``1e-3``.

    Where that would be long, with an exponent: ``1.0e-9`` for ``1e-9``.
    """
    if not isinstance(node, Scalar) or not node.plain:
        return None
    match = _DECIMAL.fullmatch(node.text)
    if match is None:
        return None
    power = match["power"] and f"e{match['sign'] or '+'}{match['power']}"
    text = f"{match['minus']}{match['whole'] or '0'}.{match['rest'] or '0'}{power or ''}"
    value = value_12(node)
    if not isinstance(value, int | float) or _scalar_11(text) != value:
        return None
    digits = format(Decimal(text).normalize(), "f") if abs(int(match["power"] or 0)) < 10 else ""
    return digits if 0 < len(digits) <= _SHORT and _scalar_11(digits) == value else text


class _Resolving(yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
    """PyYAML's own idea of plain scalars, without a document around it."""

    def __init__(self) -> None:
        yaml.constructor.SafeConstructor.__init__(self)
        yaml.resolver.Resolver.__init__(self)


_RESOLVING = _Resolving()
_AS_TEXT_11 = ("timestamp", "merge", "value", "str")
_NUMBERS_11 = ("int", "float")  # in base 2, 8, 16 and 60 also longer than Python can write


def _scalar_11(text: str) -> Any:
    resolve: Callable[..., str] = _RESOLVING.resolve
    tag = resolve(yaml.ScalarNode, text, (True, False))
    kind = tag.rpartition(":")[2]
    if kind in _AS_TEXT_11 or (kind in _NUMBERS_11 and len(text) > MAX_DIGITS):
        return text
    try:
        construct = getattr(_RESOLVING, f"construct_yaml_{kind}")
        return construct(yaml.ScalarNode(tag, text))
    except (ValueError, yaml.YAMLError):  # such as the plain scalar 0b_
        return text


"""Lines above the one that the parser stops at, in which the cause is looked for."""
_TOO_DEEP = f"nested deeper than the limit of {MAX_DEPTH}"
_NOT = "put the text in quotes, and write NOT for `!`"
_NO_COLON = "could not find expected ':'"
_HINTS = {
    _NO_COLON: "put a colon and a blank after the key",
    "mapping values are not allowed": (
        "indent the keys of one map alike; put a text with a colon in quotes"
    ),
    "did not find expected ',' or": "close it, or put a text with brackets or a comma in quotes",
}
"""What the parser says -> what to do."""
_RESOLVE = (
    "keep what is right of both sides, and delete the lines of `<<<<<<<`, `=======`, `>>>>>>>`"
)


@dataclass
class _Open:
    """A list or map that is still being read."""

    place: Place
    is_map: bool
    anchor: str | None
    children: list[Node] = field(default_factory=list)
    visits: int = 1
    depth: int = 0


class _Stop(Exception):  # noqa: N818 - control flow inside this module
    """The document cannot be understood beyond this place."""

    def __init__(self, message: str, place: Place, hint: str | None = None) -> None:
        super().__init__(message)
        self.message, self.place, self.hint = message, place, hint


def _hint(problem: str) -> str | None:
    return next((hint for words, hint in _HINTS.items() if words in problem), None)


class _Composer:
    """Builds the node graph of one document from the events of the parser."""

    def __init__(self, name: str, code: str, text: str) -> None:
        self.name, self.code, self.text = name, code, text
        self.problems: list[Problem] = []
        self.open: list[_Open] = []
        self.anchors: dict[str, tuple[Node, int, int] | None] = {}
        self.roots: list[Node] = []
        self.visits = 0

    def compose(self) -> tuple[Node | None, list[Problem]]:
        try:
            for event in self._events():
                self._take(event)
        except _Stop as stop:
            self._report(stop.message, stop.place, stop.hint)
            return None, self.problems
        if not self.roots:
            self._report("the file contains no document", Place(self.name, 1, 1))
            return None, self.problems
        return self.roots[0], self.problems

    def _report(self, reason: str, place: Place, hint: str | None = None) -> None:
        self.problems.append(problem(f"{self.code}.yaml", place, hint=hint, reason=reason))

    def _events(self) -> Iterator[Any]:
        try:
            yield from yaml.parse(self.text, Loader=_FAST_LOADER)
        except yaml.MarkedYAMLError as failure:
            mark = failure.problem_mark or failure.context_mark
            place = Place(self.name) if mark is None else self._place(mark)
            if "maximum nesting depth" in (failure.problem or ""):  # the parser's own, 1000
                raise _Stop(_TOO_DEEP, place) from None
            conflict = self._conflict(mark.line) if mark is not None else None
            if conflict is not None:
                message = "a merge conflict that nobody has resolved begins here"
                raise _Stop(message, Place(self.name, conflict + 1, 1), _RESOLVE) from None
            if mark is not None and self._has_tab(mark.line):
                message = "this is not YAML: a tab indents this line"
                raise _Stop(message, place, "indent with spaces") from None
            parts = [part for part in (failure.context, failure.problem) if part]
            hint = None if mark is None else self._quotes(failure.context or "", mark.line)
            if failure.problem == _NO_COLON and failure.context_mark:
                place = self._place(failure.context_mark)  # of the key; the other is below it
            hint = hint or _hint(failure.problem or "")
            raise _Stop(f"this is not YAML: {': '.join(parts)}", place, hint) from None
        except yaml.reader.ReaderError as failure:
            raise _Stop(*self._unreadable(failure)) from None

    def _has_tab(self, line: int) -> bool:
        """Return whether a line, counted from 0, is indented with a tab."""
        text = self._line(line)
        return "\t" in text[: len(text) - len(text.lstrip(" \t"))]

    def _conflict(self, last: int) -> int | None:
        """Return the first line up to ``last``, from 0, that git put before both sides."""
        numbered = enumerate(itertools.islice(yaml_lines(self.text), last + 1))
        return next((at for at, text in numbered if text.startswith("<<<<<<< ")), None)

    def _quotes(self, context: str, line: int) -> str | None:
        """Return the hint for an operator of expressions that YAML takes for its own."""
        if "alias" in context:
            return "put the text with `*` in quotes"
        if re.search(r"[:,\[-]\s+%", self._line(line)):
            return "write `percent`, or put the text in quotes"
        return _NOT if re.search(r"[:,\[-]\s+!", self._line(line)) else None

    def _line(self, number: int) -> str:
        return next(itertools.islice(yaml_lines(self.text), number, None), "")

    def _unreadable(self, problem: yaml.reader.ReaderError) -> tuple[str, Place]:
        bad = re.search(
            "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", self.text
        )
        before = self.text[: bad.start()] if bad else ""
        shown = f" U+{ord(bad.group()):04X}" if bad else ""
        return f"this is not YAML: the character{shown} is not allowed", _place_after(
            self.name, before
        )

    def _place(self, mark: Any) -> Place:
        return Place(self.name, mark.line + 1, mark.column + 1)

    def _take(self, event: Any) -> None:
        if isinstance(event, yaml.ScalarEvent):
            self._scalar(event)
        elif isinstance(event, yaml.CollectionStartEvent):
            self._begin(event)
        elif isinstance(event, yaml.CollectionEndEvent):
            self._end()
        elif isinstance(event, yaml.AliasEvent):
            self._alias(event)
        elif isinstance(event, yaml.DocumentStartEvent) and self.roots:
            raise _Stop("the file contains more than one document", self._place(event.start_mark))

    def _check_tag(self, event: Any) -> None:
        if event.tag is not None and event.tag not in _CORE_TAGS:
            place = self._place(event.start_mark)
            hint = _NOT if event.tag.startswith("!") else None
            raise _Stop(f"the tag {event.tag!r} is not supported here", place, hint)

    def _scalar(self, event: Any) -> None:
        if event.tag is not None:
            self._check_tag(event)
        plain = event.style in (None, "") and event.tag is None
        node = Scalar(event.value, plain, self._place(event.start_mark))
        self._add(node, event.anchor, 1, 0)

    def _begin(self, event: Any) -> None:
        self._check_tag(event)
        place = self._place(event.start_mark)
        if len(self.open) >= MAX_DEPTH:
            raise _Stop(_TOO_DEEP, place)
        if event.anchor is not None:
            self.anchors[event.anchor] = None  # an alias to what is still open is recursive
        is_map = isinstance(event, yaml.MappingStartEvent)
        self.open.append(_Open(place, is_map, event.anchor))

    def _end(self) -> None:
        done = self.open.pop()
        node: Node = self._map(done) if done.is_map else Items(tuple(done.children), done.place)
        self._add(node, done.anchor, done.visits, done.depth + 1)

    def _alias(self, event: Any) -> None:
        place = self._place(event.start_mark)
        if event.anchor not in self.anchors:
            raise _Stop(f"the alias *{event.anchor} has no anchor", place)
        found = self.anchors[event.anchor]
        if found is None:
            raise _Stop(f"the alias *{event.anchor} is inside the node that it refers to", place)
        node, visits, depth = found
        if len(self.open) + depth > MAX_DEPTH:
            raise _Stop(_TOO_DEEP, place)
        self._add(node, None, visits, depth)

    def _add(self, node: Node, anchor: str | None, visits: int, depth: int) -> None:
        if anchor is not None:
            self.anchors[anchor] = (node, visits, depth)
        if not self.open:
            self.roots.append(node)
            return
        parent = self.open[-1]
        parent.children.append(node)
        parent.visits += visits
        parent.depth = max(parent.depth, depth)
        if parent.visits > MAX_VISITS:
            limit = f"the document has more nodes than the limit of {MAX_VISITS}"
            raise _Stop(limit, node.place, "aliases count each time that they are used")

    def _map(self, done: _Open) -> Map:
        entries: dict[str, tuple[Scalar, Node]] = {}
        for key, value in zip(done.children[::2], done.children[1::2], strict=True):
            if not isinstance(key, Scalar):
                raise _Stop(f"a key must be text, not {describe(key)}", key.place)
            first = entries.setdefault(key.text, (key, value))[0]
            if first is not key:
                message = f"the key {shown(key.text)} is repeated, first in line {first.place.line}"
                self._report(message, key.place)
        return Map(tuple(entries.values()), done.place)


def _place_after(name: str, before: str) -> Place:
    line = before.count("\n") + 1
    return Place(name, line, len(before) - (before.rfind("\n") + 1) + 1)
