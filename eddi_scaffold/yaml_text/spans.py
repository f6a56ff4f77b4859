"""Places of the parts of a YAML text, to the character, so that one part can be replaced.

Marks of PyYAML end a block at the next token, behind blank lines and comments that belong to what
follows; here a part ends with its last scalar.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import Any

import yaml

from eddi_scaffold.common.problems import EddiError, Place, problem

_COMMENT = re.compile(r"(?:^|(?<=\s))#")


@dataclass
class Span:
    """One node and its text.

    Attributes:
        start: offset of its first character.
        end: offset behind its last scalar or closing bracket; ``start`` for an empty one.
        text: of a scalar, else ``None``.
        is_map: a mapping, whose children are keys and values in turn.
        is_flow: written with brackets or braces.
        anchors: names that are given inside -> line.
        aliases: names that are used inside -> line.
    """

    start: int
    end: int
    line: int
    text: str | None = None
    is_map: bool = False
    is_flow: bool = False
    children: list[Span] = field(default_factory=list)
    anchors: dict[str, int] = field(default_factory=dict)
    aliases: dict[str, int] = field(default_factory=dict)
    scalars: list[tuple[int, int]] = field(default_factory=list)

    def entries(self) -> Iterator[tuple[Span, Span]]:
        """Return keys with values of a mapping."""
        return zip(self.children[::2], self.children[1::2], strict=True)

    def get(self, key: str) -> Span | None:
        """Return the value of a key of a mapping."""
        return next((value for name, value in self.entries() if name.text == key), None)


def spans(text: str, name: str) -> Span | None:
    """Return the root of a text that was read without a problem.

    Args:
        text: of the file.
        name: of the file, for messages.

    Returns:
        ``None`` for a text that holds no document.

    Raises:
        EddiError: the Python parser of YAML takes less than the one that read it first (K001).
    """
    try:
        return _root(text)
    except yaml.MarkedYAMLError as failure:
        mark = failure.problem_mark or failure.context_mark
        place = Place(name) if mark is None else Place(name, mark.line + 1, mark.column + 1)
        raise EddiError(problem("K001.readers", place, reason=failure.problem)) from None
    except yaml.reader.ReaderError as failure:
        before = text[: failure.position].split("\n")
        place = Place(name, len(before), len(before[-1]) + 1)
        raise EddiError(
            problem("K001.character", place, character=chr(failure.character))
        ) from None


def _root(text: str) -> Span | None:
    # the Python parser, whose marks count characters; a configuration is small
    parser = yaml.parse(text, Loader=yaml.SafeLoader)
    stack: list[Span] = []
    for event in parser:
        if isinstance(event, yaml.CollectionStartEvent):
            stack.append(_opened(event))
        elif isinstance(event, yaml.CollectionEndEvent):
            done = stack.pop()
            if done.is_flow:
                done.end = _offset(event.end_mark)
            if not stack:
                return done
            _add(stack[-1], done)
        elif isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)):
            leaf = _leaf(event)
            if not stack:
                return leaf
            _add(stack[-1], leaf)
    return None


def comments(text: str, span: Span, start: int, end: int) -> list[int]:
    """Return the lines between two offsets that hold a comment (counted from 1)."""
    found = (text.count("\n", 0, at) + 1 for at in _comment_starts(text, span, start, end))
    return list(dict.fromkeys(found))


def comment_texts(text: str, span: Span, start: int, end: int) -> list[str]:
    """Return the comments between two offsets, each to the end of its line."""
    found: list[str] = []
    done = start
    for at in _comment_starts(text, span, start, end):
        if at >= done:  # not a "#" inside of a comment
            found.append(text[at:].partition("\n")[0].rstrip())
            done = at + len(found[-1])
    return found


def _comment_starts(text: str, span: Span, start: int, end: int) -> Iterator[int]:
    inside = sorted(span.scalars)
    for found in _COMMENT.finditer(text, start, end):
        if not any(first <= found.start() < last for first, last in inside):
            yield found.start()


def _offset(mark: Any) -> int:
    return int(mark.index)


def _opened(event: Any) -> Span:
    start = event.start_mark
    is_map = isinstance(event, yaml.MappingStartEvent)
    span = Span(
        start.index, start.index, start.line + 1, is_map=is_map, is_flow=bool(event.flow_style)
    )
    if event.anchor:
        span.anchors[event.anchor] = span.line
    return span


def _leaf(event: Any) -> Span:
    start: Any = event.start_mark
    end: Any = event.end_mark
    span = Span(start.index, end.index, start.line + 1)
    if isinstance(event, yaml.AliasEvent):
        span.aliases[str(event.anchor)] = span.line
        return span
    span.text = event.value
    if event.anchor:
        span.anchors[event.anchor] = span.line
    if span.end > span.start:
        span.scalars.append((span.start, span.end))
    return span


def _add(parent: Span, child: Span) -> None:
    """Put a node into the one around it; an empty one, marked at the next token, moves no end."""
    parent.children.append(child)
    if child.end > child.start:
        parent.end = max(parent.end, child.end)
    parent.anchors |= child.anchors
    parent.aliases |= child.aliases
    parent.scalars += child.scalars


_LONG_ESCAPES = {"x": 4, "u": 6, "U": 10}
_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_BLOCK = re.compile(r"(?P<style>[|>])[-+]?(?P<indent>[1-9])?")

_Spot = tuple[int, int]
"""Line and column, both from 0."""


def inside_scalar(text: str, start: Place) -> Callable[[int], Place]:
    """Return offset in a scalar's value -> place in the file.

    Args:
        text: of the file.
        start: where the scalar begins; quotes, escapes, folded and literal blocks are followed
            (YAML 1.2, chapters 7 and 8).
    """
    if start.line is None or start.col is None or not text:
        return lambda _: start
    lines = yaml_lines(text)
    if start.line > len(lines):
        return lambda _: start
    found = list(_characters(lines, start.line - 1, start.col - 1))

    def of(offset: int) -> Place:
        line, col = found[min(offset, len(found) - 1)] if found else (0, 0)
        return replace(start, line=line + 1, col=col + 1)

    return of


def yaml_lines(text: str) -> list[str]:
    """Return the lines of a text as libyaml counts them, without their ends."""
    return _LINE_END.split(text)


def _characters(lines: Sequence[str], line: int, col: int) -> Iterator[_Spot]:
    """Yield the place of each character of the value, then that behind it."""
    block = _BLOCK.match(lines[line], col)
    if block is not None:
        parent = _indent_of_parent(lines[line], col)
        return _block(lines, line + 1, parent, block["indent"], folded=block["style"] == ">")
    first = lines[line][col : col + 1]
    return _flow(lines, line, col, first if first in ("'", '"') else "")


def _flow(lines: Sequence[str], line: int, col: int, quote: str) -> Iterator[_Spot]:
    """Yield the characters of a plain or quoted scalar."""
    col += len(quote)
    while line < len(lines):
        text = lines[line]
        blanks = len(text[col:]) - len(text[col:].lstrip(" \t"))
        if col + blanks == len(text):  # blanks at the end of a line are not part of the value
            empty = _blank_lines(lines, line + 1)
            yield line, col  # a blank, or the first of several line ends
            yield from ((line + 1 + one, 0) for one in range(empty - 1))
            line += 1 + empty
            col = _indent(lines[line]) if line < len(lines) else 0
            continue
        yield from ((line, one) for one in range(col, col + blanks))
        col += blanks
        if quote == '"' and text[col:] == "\\":  # an escaped line end is not part of it either
            empty = _blank_lines(lines, line + 1)
            yield from ((line + 1 + one, 0) for one in range(empty))
            line += 1 + empty
            col = _indent(lines[line]) if line < len(lines) else 0
            continue
        yield line, col
        if quote == '"' and text[col] == "\\":
            col += _LONG_ESCAPES.get(text[col + 1], 2)
        elif quote == "'" and text[col : col + 2] == "''":
            col += 2
        elif text[col] == quote:
            return
        else:
            col += 1


def _block(
    lines: Sequence[str], line: int, parent: int, indicator: str | None, *, folded: bool
) -> Iterator[_Spot]:
    """Yield the characters of a literal or folded block scalar, with every line end at its end."""
    if indicator is not None:
        indent = parent + int(indicator)
    else:
        leading = list(takewhile(lambda one: not one.strip(" "), lines[line:]))
        first = lines[line + len(leading) : line + len(leading) + 1]
        indent = max([parent + 1, *map(len, leading), *map(_spaces, first)])
    while line < len(lines) and _is_empty(lines[line], indent):
        yield line, len(lines[line])
        line += 1
    while line < len(lines) and _spaces(lines[line]) >= indent:
        text = lines[line]
        yield from ((line, one) for one in range(indent, len(text)))
        empty = sum(1 for _ in takewhile(lambda one: _is_empty(one, indent), lines[line + 1 :]))
        behind = lines[line + 1 + empty] if line + 1 + empty < len(lines) else ""
        goes_on = _spaces(behind) >= indent and len(behind) > indent
        folds = folded and goes_on and text[indent] not in " \t" and behind[indent] not in " \t"
        if not (folds and empty):
            yield line, len(text)
        yield from ((line + 1 + one, len(lines[line + 1 + one])) for one in range(empty))
        line += 1 + empty


def _indent_of_parent(text: str, col: int) -> int:
    """Return the column of the node that holds a block scalar, which begins at a column."""
    at = _indent(text)
    while text[at : at + 1] == "-" and at + 1 + _indent(text[at + 1 :]) < col:
        at += 1 + _indent(text[at + 1 :])
    return at if at < col else -1


def _blank_lines(lines: Sequence[str], line: int) -> int:
    return sum(1 for _ in takewhile(lambda one: not one.strip(" \t"), lines[line:]))


def _is_empty(text: str, indent: int) -> bool:
    return len(text) <= indent and not text.strip(" ")


def _indent(text: str) -> int:
    return len(text) - len(text.lstrip(" \t"))


def _spaces(text: str) -> int:
    return len(text) - len(text.lstrip(" "))
