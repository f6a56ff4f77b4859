"""Places of the parts of a YAML text, to the character, so that one part can be replaced.

Marks of PyYAML end a block at the next token, behind blank lines and comments that belong to what
follows; here a part ends with its last scalar.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import Any

import yaml

from eddi_scaffold.common.problems import EddiError, Place, problem

_COMMENT = re.compile(r"(?:^|(?<=\s))#")


@dataclass
class Span:
    """One node and its text."""

    start: int  # offset of its first character
    end: int  # offset behind its last scalar or closing bracket; `start` for an empty one
    line: int
    text: str | None = None  # of a scalar, else `None`
    is_map: bool = False  # a mapping, whose children are keys and values in turn
    is_flow: bool = False  # written with brackets or braces
    children: list[Span] = field(default_factory=list)
    anchors: dict[str, int] = field(default_factory=dict)  # names that are given inside -> line
    aliases: dict[str, int] = field(default_factory=dict)  # names that are used inside -> line
    scalars: list[tuple[int, int]] = field(default_factory=list)

    def entries(self) -> Iterator[tuple[Span, Span]]:
        """Return keys with values of a mapping."""
        return zip(self.children[::2], self.children[1::2], strict=True)

    def get(self, key: str) -> Span | None:
        """Return the value of a key of a mapping."""
        return next((value for name, value in self.entries() if name.text == key), None)


def spans(text: str, name: str) -> Span | None:
    """Return the root of a text that was read without a problem.

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
    stack: list[Span] = []
    # the Python parser, whose marks count characters; a configuration is small
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        start: Any = event.start_mark
        end: Any = event.end_mark
        span = Span(start.index, start.index, start.line + 1)
        anchor: str | None = getattr(event, "anchor", None)
        if anchor is not None:
            names = span.aliases if isinstance(event, yaml.AliasEvent) else span.anchors
            names[anchor] = span.line
        if isinstance(event, yaml.CollectionStartEvent):
            span.is_map = isinstance(event, yaml.MappingStartEvent)
            span.is_flow = bool(event.flow_style)
            stack.append(span)
            continue
        if isinstance(event, yaml.CollectionEndEvent):
            span = stack.pop()
            span.end = end.index if span.is_flow else span.end
        elif isinstance(event, (yaml.ScalarEvent, yaml.AliasEvent)):
            span.end = end.index
            if isinstance(event, yaml.ScalarEvent):
                span.text = event.value
                span.scalars += [(span.start, span.end)] if span.end > span.start else []
        else:
            continue
        if not stack:
            return span
        parent = stack[-1]
        parent.children.append(span)
        if span.end > span.start:  # an empty one, marked at the next token, moves no end
            parent.end = max(parent.end, span.end)
        parent.anchors |= span.anchors
        parent.aliases |= span.aliases
        parent.scalars += span.scalars
    return None


def comments(text: str, span: Span, start: int, end: int) -> list[int]:
    """Return the lines between two offsets that hold a comment (counted from 1)."""
    lines = (text.count("\n", 0, at) + 1 for at in _comment_starts(text, span, start, end))
    return list(dict.fromkeys(lines))


def comment_texts(text: str, span: Span, start: int, end: int) -> list[str]:
    """Return the comments between two offsets, each to the end of its line."""
    texts: list[str] = []
    done = start
    for at in _comment_starts(text, span, start, end):
        if at >= done:  # not a "#" inside of a comment
            texts.append(text[at:].partition("\n")[0].rstrip())
            done = at + len(texts[-1])
    return texts


def _comment_starts(text: str, span: Span, start: int, end: int) -> Iterator[int]:
    inside = sorted(span.scalars)
    for match in _COMMENT.finditer(text, start, end):
        if not any(first <= match.start() < last for first, last in inside):
            yield match.start()


class TextEditor:
    """Changes of a text, each of them lines in place of what is between two offsets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.newline = "\r\n" if "\r\n" in text else "\n"
        self._edits: list[tuple[int, int, int, str]] = []

    def line_start(self, offset: int) -> int:
        """Return where the line of an offset begins."""
        return self.text.rfind("\n", 0, offset) + 1

    def line_end(self, offset: int) -> int:
        """Return the offset behind the line of an offset."""
        return self.text.find("\n", offset) + 1 or len(self.text)

    def column(self, offset: int) -> int:
        """Return how many characters of its line are in front of an offset."""
        return offset - self.line_start(offset)

    def replace(self, start: int, end: int, lines: Sequence[str], column: int = 0) -> None:
        """Replace what is between two offsets by lines."""
        new = "".join(f"{' ' * column}{line}{self.newline}" for line in lines)
        if self.text[start:end] != new:
            self._edits.append((start, len(self._edits), end, new))

    def result(self) -> str:
        """Return the text with all changes; those at one offset in the order they came."""
        text, done = "", 0
        for start, _, end, new in sorted(self._edits):
            text += self.text[done:start]
            text += self.newline + new if new and text and not text.endswith("\n") else new
            done = max(done, end)
        return text + self.text[done:]


_LONG_ESCAPES = {"x": 4, "u": 6, "U": 10}
_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_FOLD = re.compile("(?:[ \t]*(?:\r\n|[\n\r\x85\u2028\u2029]))+[ \t]*")
_BLOCK = re.compile(r"(?P<style>[|>])[-+]?(?P<indent>[1-9])?")


def inside_scalar(text: str, start: Place) -> Callable[[int], Place]:
    """Return offset in a scalar's value -> place in the file.

    Quotes, escapes, folded and literal blocks are followed (YAML 1.2, chapters 7 and 8).
    """
    if start.line is None or start.col is None or not text:
        return lambda _: start
    begins = [0, *(match.end() for match in _LINE_END.finditer(text))]
    if start.line > len(begins):
        return lambda _: start
    places = list(_characters(text, begins[start.line - 1], start.col - 1))

    def of(offset: int) -> Place:
        place = places[min(offset, len(places) - 1)] if places else 0
        line = bisect_right(begins, place)
        return replace(start, line=line, col=place - begins[line - 1] + 1)

    return of


def yaml_lines(text: str) -> list[str]:
    """Return the lines of a text as libyaml counts them, without their ends."""
    return _LINE_END.split(text)


def _characters(text: str, begin: int, col: int) -> Iterator[int]:
    """Yield the offset of each character of the value, then that behind it."""
    block = _BLOCK.match(text, begin + col)
    if block is None:
        quote = text[begin + col : begin + col + 1]
        return _flow(text, begin + col, quote if quote in ("'", '"') else "")
    line = text[begin : begin + col]
    parent = len(line) - len(line.lstrip(" \t"))
    while dash := re.match(r"-[ \t]+(?=\S)", line[parent:]):  # the entries that hold it
        parent += dash.end()
    parent = parent if parent < col else -1
    indent = parent + int(block["indent"]) if block["indent"] else None
    end = _LINE_END.search(text, block.end())
    first = end.end() if end is not None else len(text)
    return _block(text, first, parent + 1, indent, folded=block["style"] == ">")


def _flow(text: str, at: int, quote: str) -> Iterator[int]:
    """Yield the characters of a plain or quoted scalar."""
    at += len(quote)
    while at < len(text):
        is_escape = quote == '"' and text[at] == "\\"
        fold = _FOLD.match(text, at + is_escape)
        if fold is not None:  # one line end is a blank, or nothing behind an escape
            ends = [end.start() for end in _LINE_END.finditer(text, at, fold.end())]
            yield from ends[1:] if is_escape or len(ends) > 1 else [at]
            at = fold.end()
            continue
        yield at
        if is_escape:
            at += _LONG_ESCAPES.get(text[at + 1 : at + 2], 2)
        elif quote == "'" and text.startswith("''", at):
            at += 2
        elif text[at] == quote:
            return
        else:
            at += 1


def _block(text: str, begin: int, least: int, indent: int | None, *, folded: bool) -> Iterator[int]:
    """Yield the characters of a literal or folded block scalar, with every line end at its end."""
    lines, at = yaml_lines(text[begin:]), begin
    if indent is None:
        blank = list(takewhile(lambda line: not line.strip(" "), lines))
        first = lines[len(blank) : len(blank) + 1]
        indent = max([least, *map(len, blank), *map(_spaces, first)])
    empty = [len(line) <= indent and not line.strip(" ") for line in lines]
    below = [""] * len(lines)  # for each line the next one that is not empty
    for number in range(len(lines) - 1, 0, -1):
        below[number - 1] = below[number] if empty[number] else lines[number]
    for number, line in enumerate(lines):
        if not empty[number] and _spaces(line) < indent:
            return
        if not empty[number]:
            yield from range(at + indent, at + len(line))
        behind = below[number]
        goes_on = folded and _spaces(behind) >= indent and len(behind) > indent
        is_folded = goes_on and not empty[number] and not {line[indent], behind[indent]} & {*" \t"}
        if not (is_folded and empty[number + 1]):
            yield at + len(line)
        end = _LINE_END.match(text, at + len(line))
        at = end.end() if end is not None else len(text)


def _spaces(text: str) -> int:
    return len(text) - len(text.lstrip(" "))
