"""YAML as nodes with positions, and what their scalars mean.

A scalar stays the text that was written, together with the fact whether it was quoted; what a
plain scalar *means* is decided here: text, number or Boolean as YAML 1.2 has it
(:func:`as_text` and its neighbours), or the value of YAML 1.1 (:func:`value_11`), which ROS and
``eddi_config.yml`` follow. Documents are read event by event without recursion, so that alias
bombs and deep nesting are a message like any other mistake.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import yaml

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.yaml_text.writer import Verbatim, dump_plain, quoted

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

__all__ = ["Verbatim", "dump_plain", "quoted"]

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
MAX_BYTES = 16 * 1024 * 1024
MAX_ALIASED = 1_000_000  # nodes
MAX_DEPTH = 32
MAX_DIGITS = 64
_CORE_TYPES = ("str", "int", "float", "bool", "null", "seq", "map")
_CORE_TAGS = frozenset({"!", *(f"tag:yaml.org,2002:{name}" for name in _CORE_TYPES)})
_BOOLEANS = {word: word[0] in "tT" for word in ("true", "True", "TRUE", "false", "False", "FALSE")}
NOT_YAML = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_DECIMAL = re.compile(r"[-+]?(?!0[0-9])(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]{0,17})")
_NULLS = frozenset({"", "~", "null", "Null", "NULL"})
_OTHER_BASE = re.compile(r"0x[0-9a-fA-F]+|0o[0-7]+")
_SPECIAL = re.compile(r"(?P<sign>[-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


@dataclass(frozen=True)
class Scalar:
    """A text in a document."""

    text: str  # content without quotes and escapes
    plain: bool  # written without quotes, so that its form may determine its type
    place: Place = field(default=Place(), compare=False)
    start: int = field(default=0, compare=False)  # offset of its first character
    end: int = field(default=0, compare=False)  # offset behind it


@dataclass(frozen=True)
class Items:
    """A list."""

    items: tuple[Node, ...]
    place: Place = field(default=Place(), compare=False)
    start: int = field(default=0, compare=False)  # offset of its first character
    # offset behind its last scalar or its bracket: marks of PyYAML end a block at the next token
    end: int = field(default=0, compare=False)
    is_flow: bool = field(default=False, compare=False)  # written with brackets


@dataclass(frozen=True)
class Map:
    """A map; of a repeated key the first entry is kept."""

    entries: tuple[tuple[Scalar, Node], ...]  # key and value in the order of the file
    place: Place = field(default=Place(), compare=False)
    start: int = field(default=0, compare=False)  # as of a list
    end: int = field(default=0, compare=False)
    is_flow: bool = field(default=False, compare=False)  # written with braces

    def get(self, key: str) -> Node | None:
        """Return the value of a key, ``None`` when it is absent."""
        return self._values.get(key)

    @cached_property
    def _values(self) -> dict[str, Node]:
        return {name.text: value for name, value in reversed(self.entries)}

    def keys(self) -> list[str]:
        """Return the keys in the order of the file."""
        return [name.text for name, _ in self.entries]


Node = Scalar | Items | Map


@dataclass(frozen=True)
class Number:
    """A number as written, with its double: comparisons stay exact."""

    text: str
    value: float


def describe(node: Node) -> str:
    """Describe the kind of a node, for messages."""
    if isinstance(node, Items):
        return "a list"
    if isinstance(node, Map):
        return "a map"
    if is_null(node):
        return "nothing (null)"
    if not node.plain:
        return f"the quoted text {shown(node.text)}"
    if as_number(node) is not None or as_bool(node) is not None:
        return node.text
    return f"the text {shown(node.text)}"


def shown(text: str) -> str:
    """Return a text in quotes for a message, shortened where it is long."""
    return repr(text if len(text) <= 60 else f"{text[:57]}...")


def is_null(node: Node) -> bool:
    """Return whether a node is a plain ``null`` or empty."""
    return isinstance(node, Scalar) and node.plain and node.text in _NULLS


def as_text(node: Node) -> str | None:
    """Return the text of a scalar other than null, ``None`` for anything else."""
    return node.text if isinstance(node, Scalar) and not is_null(node) else None


def text_of(node: Node | None, key: str) -> str | None:
    """Return the text of a key of a map, ``None`` where there is none."""
    value = node.get(key) if isinstance(node, Map) else None
    return None if value is None else as_text(value)


def as_number(node: Node) -> Number | None:
    """Return the number that a plain scalar is in YAML 1.2 (may be NaN).

    ``None`` for anything else, and for numbers that no double can hold or that have more than
    :data:`MAX_DIGITS` characters: exact arithmetic with ``1e999999999`` would not end.
    """
    if not isinstance(node, Scalar) or not node.plain or len(node.text) > MAX_DIGITS:
        return None
    text, special = node.text, _SPECIAL.fullmatch(node.text)
    if special is not None:
        sign = special["sign"]
        text = "nan" if sign is None else f"{sign.replace('+', '')}inf"
        return Number(text, float(text))
    text = str(int(text, 0)) if _OTHER_BASE.fullmatch(text) else text
    if not _DECIMAL.fullmatch(text):
        return None
    value = float(text)
    too_small = value == 0.0 and re.search("[1-9]", re.split("[eE]", text)[0])
    return None if abs(value) == float("inf") or too_small else Number(text, value)


def as_bool(node: Node) -> bool | None:
    """Return the Boolean that a plain scalar is in YAML 1.2, ``None`` for others."""
    return _BOOLEANS.get(node.text) if isinstance(node, Scalar) and node.plain else None


def as_integer(node: Node) -> int | None:
    """Return the decimal integer (up to 18 digits) that a plain scalar is, ``None`` for others."""
    if not isinstance(node, Scalar) or not node.plain or not _INTEGER.fullmatch(node.text):
        return None
    return int(node.text)


def read_document(source: Source, code: str) -> tuple[Node | None, list[Problem]]:
    """Read the one document of a YAML file; ``code`` is that of all problems.

    Returns:
        The root node and the problems; the node is ``None`` where the document cannot be
        understood at all, and present when only keys are repeated (which is an error too).
    """
    roots, problems = _documents(source, code)
    return roots[0] if roots else None, problems


def read_map(source: Source, code: str) -> tuple[Map | None, list[Problem]]:
    """Read the one document of a YAML file whose top level must be a map."""
    maps, problems = read_maps(source, code, has_many=False)
    return maps[0] if maps else None, problems


def read_maps(
    source: Source, code: str, *, has_many: bool = True
) -> tuple[list[Map], list[Problem]]:
    """Read all documents of a YAML file; the top level of each must be a map."""
    roots, problems = _documents(source, code, has_many=has_many)
    maps = [root for root in roots if isinstance(root, Map)]
    for root in roots:
        if not isinstance(root, Map):
            reason = f"the top level must be a map, not {describe(root)}"
            problems.append(problem(f"{code}.yaml", root.place, reason=reason))
    return maps, problems


def _documents(
    source: Source, code: str, *, has_many: bool = False
) -> tuple[list[Node], list[Problem]]:
    composer = _Composer(source.name, code, has_many=has_many)
    try:
        composer.compose(source)
    except EddiError as refused:
        return [], [*composer.problems, *refused.problems]
    return composer.roots, composer.problems


def map_of(place: Place, nodes: Mapping[str, Node | str | None]) -> Map:
    """Return a map of the nodes that are there; a text becomes a scalar at the place."""
    entries: list[tuple[Scalar, Node]] = []
    for key, node in nodes.items():
        if node is not None:
            value = Scalar(node, plain=True, place=place) if isinstance(node, str) else node
            entries.append((Scalar(key, plain=True, place=place), value))
    return Map(tuple(entries), place)


def items_of(node: Node | None) -> tuple[Node, ...]:
    """Return the items of a list, none of anything else."""
    return node.items if isinstance(node, Items) else ()


def scalars_of(node: Node | None) -> Iterator[Scalar]:
    """Yield each text below a node, those of keys as well."""
    if isinstance(node, Scalar):
        yield node
    elif isinstance(node, Items):
        for item in node.items:
            yield from scalars_of(item)
    elif node is not None:
        for key, value in node.entries:
            yield key
            yield from scalars_of(value)


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


_RESOLVING = yaml.SafeLoader("")  # PyYAML's own idea of plain scalars, without a document
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


_TOO_DEEP = f"nested deeper than the limit of {MAX_DEPTH}"
_QUOTE = "put a text with `: # % & * ! | > [ ] { } ,` in quotes, and indent with blanks"
_RESOLVE = "keep what is right of both sides, and delete the lines `<<<<<<<`, `=======`, `>>>>>>>`"


@dataclass
class _Open:  # a list or map that is still being read
    event: Any  # with which it begins
    children: list[Node] = field(default_factory=list)


class _Composer:
    """Builds the node graphs of the documents from the events of the parser."""

    def __init__(self, name: str, code: str, *, has_many: bool = False) -> None:
        self.name, self.code, self.has_many = name, code, has_many
        self.problems: list[Problem] = []
        self.open: list[_Open] = []
        self.anchors: dict[str, Node] = {}
        self.aliased = 0  # nodes in all that aliases stand for
        self.measures: dict[int, tuple[int, int]] = {}  # id of what is in a node -> see `_measured`
        self.roots: list[Node] = []

    def compose(self, source: Source) -> None:
        if len(source.data) > MAX_BYTES:
            reason = f"the file has {len(source.data)} bytes, more than the limit of {MAX_BYTES}"
            raise self._fault(reason, Place(source.name))
        text = source.text(self.code)
        try:
            for event in yaml.parse(text, Loader=LOADER):
                self._take(event)
        except yaml.MarkedYAMLError as failure:
            raise self._not_yaml(failure, text) from None
        except yaml.reader.ReaderError:
            bad = NOT_YAML.search(text)
            lines = (text[: bad.start()] if bad else "").split("\n")
            shown = f" U+{ord(bad.group()):04X}" if bad else ""
            message = f"this is not YAML: the character{shown} is not allowed"
            raise self._fault(message, Place(self.name, len(lines), len(lines[-1]) + 1)) from None
        if not self.roots:
            raise self._fault("the file contains no document", Place(self.name, 1, 1))

    def _fault(self, reason: str, place: Place, hint: str | None = None) -> EddiError:
        return EddiError(problem(f"{self.code}.yaml", place, hint=hint, reason=reason))

    def _place(self, mark: Any) -> Place:
        return Place(self.name, mark.line + 1, mark.column + 1)

    def _not_yaml(self, failure: yaml.MarkedYAMLError, text: str) -> EddiError:
        what, mark = failure.problem or "", failure.problem_mark or failure.context_mark
        place = Place(self.name) if mark is None else self._place(mark)
        if "maximum nesting depth" in what:  # the parser's own, 1000
            return self._fault(_TOO_DEEP, place)
        lines = LINE_END.split(text)[: mark.line + 1] if mark else [""]
        for number, line in enumerate(lines, 1):
            if line.startswith("<<<<<<< "):
                message = "a merge conflict that nobody has resolved begins here"
                return self._fault(message, Place(self.name, number, 1), _RESOLVE)
        reason = ": ".join(part for part in (failure.context, what) if part)
        return self._fault(f"this is not YAML: {reason}", place, _QUOTE)

    def _take(self, event: Any) -> None:
        place, start, end = (
            self._place(event.start_mark),
            event.start_mark.index,
            event.end_mark.index,
        )
        if getattr(event, "tag", None) is not None and event.tag not in _CORE_TAGS:
            raise self._fault(f"the tag {event.tag!r} is not supported here", place, _QUOTE)
        if isinstance(event, yaml.ScalarEvent):
            plain = event.style in (None, "") and event.tag is None
            self._add(Scalar(event.value, plain, place, start, end), event.anchor)
        elif isinstance(event, yaml.CollectionStartEvent):
            if len(self.open) >= MAX_DEPTH:
                raise self._fault(_TOO_DEEP, place)
            self.anchors.pop(str(event.anchor), None)  # an alias to what is still open has none
            self.open.append(_Open(event))
        elif isinstance(event, yaml.CollectionEndEvent):
            done = self.open.pop()
            self._add(self._collection(done, end), done.event.anchor)
        elif isinstance(event, yaml.AliasEvent):
            if event.anchor not in self.anchors:
                raise self._fault(
                    f"no node before has the anchor of *{event.anchor}", place, _QUOTE
                )
            count, levels = self._measured(self.anchors[event.anchor])
            self.aliased += count
            if self.aliased > MAX_ALIASED:
                reason = f"aliases stand for more nodes than the limit of {MAX_ALIASED}"
                raise self._fault(reason, place)
            if len(self.open) + levels > MAX_DEPTH + 1:
                raise self._fault(_TOO_DEEP, place)
            self._add(replace(self.anchors[event.anchor], start=start, end=end), None)
        elif isinstance(event, yaml.DocumentStartEvent):
            if self.roots and not self.has_many:
                raise self._fault("the file contains more than one document", place)
            self.anchors.clear()

    def _measured(self, node: Node) -> tuple[int, int]:  # nodes and levels
        if isinstance(node, Scalar):
            return 1, 1
        parts = node.items if isinstance(node, Items) else node.entries
        if id(parts) not in self.measures:
            values = (part[1] if isinstance(part, tuple) else part for part in parts)
            measures = [self._measured(value) for value in values]
            count, levels = sum(n for n, _ in measures), max((n for _, n in measures), default=0)
            self.measures[id(parts)] = 1 + count, 1 + levels
        return self.measures[id(parts)]

    def _add(self, node: Node, anchor: str | None) -> None:
        if anchor is not None:
            self.anchors[anchor] = node
        (self.open[-1].children if self.open else self.roots).append(node)

    def _collection(self, done: _Open, end: int) -> Node:
        place, start = self._place(done.event.start_mark), done.event.start_mark.index
        is_flow = bool(done.event.flow_style)
        if not is_flow:  # an empty part, marked at the next token, moves no end
            end = max((each.end for each in done.children if each.end > each.start), default=start)
        if isinstance(done.event, yaml.SequenceStartEvent):
            return Items(tuple(done.children), place, start, end, is_flow)
        entries: dict[str, tuple[Scalar, Node]] = {}
        for key, value in zip(done.children[::2], done.children[1::2], strict=True):
            if not isinstance(key, Scalar):
                raise self._fault(f"a key must be text, not {describe(key)}", key.place)
            first = entries.setdefault(key.text, (key, value))[0]
            if first is not key:
                message = f"the key {shown(key.text)} is repeated, first in line {first.place.line}"
                self.problems += self._fault(message, key.place).problems
        return Map(tuple(entries.values()), place, start, end, is_flow)
