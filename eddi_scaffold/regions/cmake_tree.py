"""CMake text as a tree of commands with their lines."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from .items import Item, Leaf, Piece, items_of, numbered
from .marked_file import placeholder_id

_DEEPEST = 40
_BRACKET = re.compile(r"\[(=*)\[")
_SPACE = re.compile(r"[ \t\r\n]+")
_COMMAND = re.compile(r"([A-Za-z_]\w*)[ \t]*\(")
_QUOTED = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"', re.DOTALL)
_PLAIN = re.compile(r'(?:[^\s()"#\\\[]|\\.)+|\[', re.DOTALL)
_BLOCKS = frozenset(["if", "foreach", "while", "function", "macro", "block"])
_ONCE = frozenset(["project", "cmake_minimum_required"])


@dataclass
class _Command:
    name: str
    first: str
    start: int
    stop: int

    @property
    def key(self) -> str:
        if self.name == "region":
            return f"region {self.first}"
        return f"<{self.name if self.name in _ONCE else f'{self.name} {self.first}'.rstrip()}>"


def split(lines: Sequence[str]) -> tuple[Item, ...]:
    """Return the commands of a file; their lines joined give the input again.

    Raises:
        SyntaxError: it is not CMake, or nested too deeply.
    """
    top = Piece("", -1, -1)
    open_: list[Piece] = [top]
    for one in _commands(lines):
        around = open_[-1]
        if one.name.startswith("end") and around.key[1:].startswith(
            (f"{one.name[3:]} ", f"{one.name[3:]}>")
        ):
            around.closes, around.stop = one.start, one.stop
            open_.pop()
        elif one.name in _BLOCKS:
            open_.append(Piece(one.key, one.start, one.stop, one.stop, one.stop))
            around.inner.append(open_[-1])
        else:
            around.inner.append(Piece(one.key, one.start, one.stop, one.stop, one.stop))
        if len(open_) > _DEEPEST:
            raise SyntaxError("nested too deeply")
    if len(open_) > 1:
        raise SyntaxError("a block without an end")
    found = list(numbered(items_of(top.inner, lines, 0, _DEEPEST)))
    done = sum(len(item.lines) for item in found)
    return (*found, *([Leaf("<tail>", tuple(lines[done:]))] if done < len(lines) else []))


def parses(lines: Sequence[str]) -> bool:
    """Return whether lines are whole commands."""
    try:
        _commands(lines)
    except SyntaxError:
        return False
    return True


def lead(lines: Sequence[str]) -> int:
    """Return how many comments and blank lines are above the first other line."""
    plain = (n for n, line in enumerate(lines) if line.strip() and line.lstrip()[0] != "#")
    return next(plain, 0)


def _commands(lines: Sequence[str]) -> list[_Command]:
    text = "".join(lines)
    found: list[_Command] = []
    at = line = 0
    while at < len(text):
        begin, start = at, line
        space, command = _SPACE.match(text, at), _COMMAND.match(text, at)
        region = placeholder_id(lines[line]) if text[at] == "'" else None
        if space is not None:
            at = space.end()
        elif text[at] == "#":
            at = _behind_comment(text, at)
        elif region is not None:
            found.append(_Command("region", region, line, line))
            at += len(lines[line].strip())
        elif command is not None:
            at, first = _behind_arguments(text, command.end())
            found.append(_Command(command[1].lower(), first, start, start))
        else:
            raise SyntaxError("no command")
        line += text.count("\n", begin, at)
        if found and found[-1].stop == start and space is None:
            found[-1].stop = line  # a comment that begins behind a command belongs to it
    return found


def _behind_comment(text: str, at: int) -> int:
    bracket = _BRACKET.match(text, at + 1)
    if bracket is not None:
        return _behind_bracket(text, bracket)
    end = text.find("\n", at)
    return len(text) if end < 0 else end


def _behind_bracket(text: str, bracket: re.Match[str]) -> int:
    close = f"]{bracket[1]}]"
    end = text.find(close, bracket.end())
    if end < 0:
        raise SyntaxError("a bracket without an end")
    return end + len(close)


def _behind_arguments(text: str, at: int) -> tuple[int, str]:
    """Return the place behind the closing parenthesis, and the first argument."""
    depth, first = 1, ""
    while depth:
        bracket = _BRACKET.match(text, at)
        word = _QUOTED.match(text, at) or _PLAIN.match(text, at)
        begin, sign = at, text[at : at + 1]
        if bracket is not None:
            at = _behind_bracket(text, bracket)
        elif word is not None:
            at = word.end()
        elif sign == "#":
            at = _behind_comment(text, at)
        elif sign in {"(", ")"}:
            depth, at = depth + (1 if sign == "(" else -1), at + 1
        elif sign.isspace():
            at += 1
        else:
            raise SyntaxError("a command without an end")
        if not first and (bracket or word):
            first = text[begin:at]
    return at, first
