"""Places of the parts of a YAML text, to the character, so that one part can be replaced.

Marks of PyYAML end a block at the next token, behind blank lines and comments that belong to what
follows; here a part ends with its last scalar.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

from eddi_scaffold.problems import EddiError, Place, error

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
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        place = Place(name) if mark is None else Place(name, mark.line + 1, mark.column + 1)
        message = f"not every reader of YAML accepts this: {problem.problem}"
        raise EddiError(error("K001", message, place, "put the text in quotes")) from None
    except yaml.reader.ReaderError as problem:
        before = text[: problem.position].split("\n")
        place = Place(name, len(before), len(before[-1]) + 1)
        message = f"the character {chr(problem.character)!r} cannot stand in YAML"
        raise EddiError(error("K001", message, place, "remove it")) from None


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
