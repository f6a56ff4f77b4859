"""Whether a file was made of the rendering that its base says. Pure.

A merge of branches that takes a file from one side and its base from the other leaves generated
code of another version, which would pass as a person's.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from .marked_file import MarkedFile, scopes
from .outside import same_lines
from .python_text import parse_python

_ALL = "*"
_ENOUGH = 2
"""Lines in which a file must agree with another rendering: a person may well remove one."""


def missing_parts(base: MarkedFile, mine: MarkedFile, *, python: bool) -> dict[str, str]:
    """Return what the rendering has and the file has not: regions, and calls of their functions."""
    if same_lines(base.skeleton, mine.skeleton):
        return {}
    gone = [key for key in base.regions if key not in mine.regions]
    found = {key: f"region {key!r} of the newest rendering is not in the file" for key in gone}
    if python:
        wanted = {r.function.rpartition(".")[2]: None for r in base.regions.values() if r.function}
        before, now = (_mentioned(one.skeleton) for one in (base, mine))
        if now is not None:
            lost = [name for name in wanted if name in (before or ()) and name not in now]
            found |= {
                name: f"{name!r} is called by the newest rendering, not by the file"
                for name in lost
            }
    return found


def made_of(base: MarkedFile, mine: MarkedFile, former: Mapping[str, MarkedFile]) -> str | None:
    """Return which former rendering the file, or a definition in it, has in place of its base.

    It has the lines that the former rendering has and the base has not, and lacks the others.
    """
    if same_lines(base.skeleton, mine.skeleton):
        return None
    new, own = _chunks(base.skeleton), _chunks(mine.skeleton)
    for name, rendering in former.items():
        old = _chunks(rendering.skeleton)
        if any(
            _is_of(new[key], own[key], old[key]) for key in new.keys() & own.keys() & old.keys()
        ):
            return name
    return None


def _is_of(base: Counter[str], mine: Counter[str], former: Counter[str]) -> bool:
    more, less = former - base, base - former
    enough = more.total() + less.total() >= _ENOUGH
    return enough and more <= mine - base and less <= base - mine


def _chunks(lines: Sequence[str]) -> dict[str, Counter[str]]:
    """Return the lines by the definition that begins above them, and all lines."""
    starts = {scope.line: scope.qualified for scope in scopes(lines)}
    everything: Counter[str] = Counter()
    found = {_ALL: everything}
    name = ""
    for number, line in enumerate(lines, 1):
        name = starts.get(number, name)
        if line.strip():
            found.setdefault(name, Counter())[line.strip()] += 1
            everything[line.strip()] += 1
    return found


def _mentioned(lines: Iterable[str]) -> set[str] | None:
    try:
        return set(_names(parse_python("".join(lines))))
    except SyntaxError:
        return None


def _names(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Name):
            yield node.id
