"""Merge what is outside the regions of a file, definition by definition, element by element."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from . import cmake_tree, xml_tree
from .formatting import framed, same_meaning
from .items import Block, Item, Leaf, aligned
from .lines import merge_lines
from .marked_file import placeholder_id
from .markers import indent_of
from .python_text import parse_python, parse_shallow
from .python_tree import is_named, split, split_function


@dataclass(frozen=True)
class Reject:
    """An outside edit that has no place in the new text.

    Attributes:
        where: ``Class.method`` or the statement's text.
        before: the generated lines that the person changed.
        after: the person's lines.
    """

    where: str
    before: tuple[str, ...]
    after: tuple[str, ...]


_LEAVES = ("return", "raise")


@dataclass(frozen=True)
class Language:
    """How the texts of a file are taken apart.

    Attributes:
        split: returns the items of a text; raises SyntaxError.
        parses: whether the lines of an item, or of the head of one, are whole.
        same: whether two items differ in their layout only.
        lead: how many lines of an item are comments above it.
    """

    split: Callable[[Sequence[str]], Sequence[Item]]
    parses: Callable[[Sequence[str]], bool]
    same: Callable[[Sequence[str], Sequence[str]], bool]
    lead: Callable[[Sequence[str]], int]


@dataclass
class _Merge:
    language: Language
    both: bool = False  # two branches: regions and definitions come and go on either side
    rejects: list[Reject] = field(default_factory=list)


def merge_items(
    language: Language,
    base: Sequence[str],
    mine: Sequence[str],
    theirs: Sequence[str],
    changed: Collection[str] = (),
    *,
    both: bool = False,
) -> tuple[list[str], list[Reject]]:
    """Merge three skeletons; never moves a line into another definition, element or command.

    Args:
        language: of the file.
        base: the rendering that ``mine`` was made from.
        mine: the person's lines.
        theirs: the new rendering.
        changed: regions that are another element's in ``theirs``, and so are their functions.
        both: the two are branches: definitions with regions come and go on either side.

    Returns:
        The merged skeleton, and the person's edits that did not fit in.

    Raises:
        SyntaxError: one of the three does not parse.
    """
    merge = _Merge(language, both)
    if _stays(merge, base, mine, theirs):
        return list(mine), []
    before, own = (_without_heirs(language.split(lines), changed) for lines in (base, mine))
    lines = _block(merge, before, own, language.split(theirs), "")
    return lines, merge.rejects


def _without_heirs(items: Sequence[Item], changed: Collection[str]) -> tuple[Item, ...]:
    """Rename the functions of regions that belong to other elements now: none is their heir."""
    return tuple(
        Block(item.key, item.header, _without_heirs(item.items, changed))
        if isinstance(item, Block)
        else Leaf(f"{item.key} (before it was renamed)", item.lines)
        if any(name in changed for name in regions_in(item.lines))
        else item
        for item in items
    )


def regions_in(lines: Sequence[str]) -> list[str]:
    """Return the ids of the regions whose placeholders are in these lines, in order."""
    return [found for line in lines if (found := placeholder_id(line)) is not None]


def _block(
    merge: _Merge,
    base: Sequence[Item],
    mine: Sequence[Item],
    theirs: Sequence[Item],
    scope: str,
    *,
    steps: bool = False,
) -> list[str]:
    """Merge the members of a block; ``steps`` marks them as a function's statements."""
    if merge.language is not PYTHON:
        mine, theirs = aligned(mine, base, "own"), aligned(theirs, base, "new")
    old, own, new = _by_key(base), _by_key(mine), _by_key(theirs)
    chosen: dict[str, list[str]] = {}
    for key, item in new.items():
        was, person = old.get(key), own.get(key)
        if person is not None:
            chosen[key] = _both(merge, was, person, item, _name(scope, key))
        elif (
            was is None
            or (regions_in(item.lines) and not merge.both)
            or not same_lines(was.lines, item.lines)
        ):
            chosen[key] = list(item.lines)
        # else: the person removed what the generator left as it was
    order = _Order(chosen)
    anchor: str | None = None
    # Steps that a person put behind all others stay behind all others.
    last = _added_last(own, old, new) if steps and not order.end.startswith("return") else set()
    replaced = _replaced(own, old, new)
    for key, person in own.items():
        if key not in new:
            was = old.get(key)
            lost = replaced.get(key)
            if lost is not None:
                merge.rejects.append(Reject(_name(scope, lost.key), lost.lines, person.lines))
            elif was is None and (merge.both or not regions_in(person.lines)):
                order.insert(key, order.end if key in last else anchor or "")
                chosen[key] = list(person.lines)
            elif was is None or not same_lines(was.lines, person.lines):
                _reject_removed(merge, was, person, _name(scope, key))
        if key in chosen:
            anchor = key
    return [line for key in order for line in _terminated(chosen[key])]


class _Order:
    """Keys in an order that grows at any place; the key before the first one is empty."""

    def __init__(self, keys: Iterable[str]) -> None:
        first = ["", *keys]
        self.end = first[-1]
        self._next = dict(itertools.pairwise(first))

    def insert(self, key: str, behind: str) -> None:
        if behind == self.end:
            self.end = key
        else:
            self._next[key] = self._next[behind]
        self._next[behind] = key

    def __iter__(self) -> Iterator[str]:
        key = ""
        while key != self.end:
            key = self._next[key]
            yield key


def _replaced(
    own: dict[str, Item], old: dict[str, Item], new: dict[str, Item]
) -> dict[str, Item | None]:
    """Return for nameless statements of a person the one each replaced, which theirs changed too.

    That is the first nameless one of those that are gone behind the last known statement.
    """
    names = list(old)
    place = {key: number for number, key in enumerate(names, 1)}
    start = 0
    by_start: dict[int, Item | None] = {}
    found: dict[str, Item | None] = {}
    for key in own:
        if key in old:
            start = place[key]
        elif not is_named(key):
            if start not in by_start:
                behind = (names[k] for k in range(start, len(names)))
                gone = itertools.takewhile(lambda k: k not in own, behind)
                by_start[start] = next(
                    (old[k] for k in gone if k not in new and not is_named(k)), None
                )
            found[key] = by_start[start]
    return found


def _added_last(own: dict[str, Item], old: Mapping[str, Item], new: Mapping[str, Item]) -> set[str]:
    return set(itertools.takewhile(lambda key: key not in old and key not in new, reversed(own)))


def _reject_removed(merge: _Merge, was: Item | None, person: Item, where: str) -> None:
    if isinstance(was, Block) and isinstance(person, Block):
        if not same_lines(was.header, person.header):
            merge.rejects.append(Reject(where, was.header, person.header))
        old = _by_key(was.items)
        for key, item in _by_key(person.items).items():
            before = old.get(key)
            if before is None or not same_lines(before.lines, item.lines):
                _reject_removed(merge, before, item, _name(where, key))
        return
    merge.rejects.append(Reject(where, was.lines if was else (), person.lines))


def _both(merge: _Merge, was: Item | None, person: Item, item: Item, where: str) -> list[str]:
    before = was.lines if was is not None else None
    if before is not None and _stays(merge, before, person.lines, item.lines):
        return list(person.lines)
    if isinstance(person, Block) and isinstance(item, Block):
        return _groups(merge, was, person, item, where)
    merged = _leaf(merge, before, person.lines, item.lines)
    if merged is None and before is not None:
        merged = _by_parts(merge, before, person.lines, item.lines, where)
    if merged is not None:
        return merged
    if item.key.startswith("from "):
        united = _united(before or (), person.lines, item.lines)
        if united is not None:
            return united
    merge.rejects.append(Reject(where, before if before is not None else item.lines, person.lines))
    return list(item.lines)


def _by_parts(
    merge: _Merge, before: Sequence[str], person: Sequence[str], item: Sequence[str], where: str
) -> list[str] | None:
    """Merge the comments above an item and the rest; of a function, its statements."""
    texts = (before, person, item)
    cuts = [merge.language.lead(lines) for lines in texts]
    lead = _leaf(merge, *(lines[:cut] for lines, cut in zip(texts, cuts, strict=True)))
    was, own, new = (lines[cut:] for lines, cut in zip(texts, cuts, strict=True))
    if lead is None:
        return None
    rest = _leaf(merge, was, own, new)
    if rest is None and merge.language is PYTHON:
        rest = _by_statements(was, own, new, where)
    return lead + rest if rest is not None else None


def _by_statements(
    before: Sequence[str], person: Sequence[str], item: Sequence[str], where: str
) -> list[str] | None:
    """Merge the statements of a function where the person only added some."""
    old, own, new = (split_function(lines) for lines in (before, person, item))
    if old is None or own is None or new is None:
        return None
    keys = [step.key for step in own.items]
    added = [key for key in keys if key not in _by_key(old.items)]
    if len(keys) - len(added) < len(old.items) or any(key.startswith(_LEAVES) for key in added):
        return None
    trial = _Merge(PYTHON)
    lines = _groups(trial, old, own, new, where, steps=True)
    good = not trial.rejects and regions_in(lines) == regions_in(item) and _parses(lines)
    return lines if good else None


def _python_lead(lines: Sequence[str]) -> int:
    code = (i for i, line in enumerate(lines) if line.strip() and line.lstrip()[0] != "#")
    return next(code, 0)


def _groups(
    merge: _Merge,
    was: Item | None,
    person: Block,
    item: Block,
    where: str,
    *,
    steps: bool = False,
) -> list[str]:
    old = was if isinstance(was, Block) else None
    header = _leaf(merge, old.header if old else None, person.header, item.header)
    if header is None and old is not None:
        header = _by_parts(merge, old.header, person.header, item.header, where)
    if header is None:
        merge.rejects.append(Reject(where, (old or item).header, person.header))
        header = list(item.header)
    before = old.items if old else ()
    return header + _block(merge, before, person.items, item.items, where, steps=steps)


def _stays(
    merge: _Merge, before: Sequence[str], person: Sequence[str], item: Sequence[str]
) -> bool:
    """Return whether a person's lines stay in their own order, because nothing else changes."""
    plain = merge.language is not PYTHON and regions_in(person) == regions_in(item)
    return plain and same_lines(before, item) and merge.language.parses(person)


def _leaf(
    merge: _Merge, was: Sequence[str] | None, person: Sequence[str], item: Sequence[str]
) -> list[str] | None:
    """Return the lines with both changes, ``None`` when they cannot be united."""
    if was is None:
        return list(item) if same_lines(person, item) else None
    kept = same_lines(was, item)  # then in the person's layout: a formatter would make it again
    if not kept and (same_lines(person, item) or _untouched(merge, was, person)):
        return list(item)
    merged = list(person) if kept else merge_lines(was, person, item)
    if (
        merged is None
        or regions_in(merged) != regions_in(item)
        or not merge.language.parses(merged)
    ):
        return None
    return merged


def _untouched(merge: _Merge, was: Sequence[str], person: Sequence[str]) -> bool:
    same = same_lines(was, person) or merge.language.same(was, person)
    return same and regions_in(was) == regions_in(person)


def _united(was: Sequence[str], person: Sequence[str], item: Sequence[str]) -> list[str] | None:
    """Return a ``from`` import and a second one with the names that the person added."""
    before, own, new = (_imported(block) for block in (was, person, item))
    if before is None or own is None or new is None or _comments(person) - _comments(was):
        return None
    extra = [alias for alias in own if alias not in before and alias not in new]
    module = next(line for line in item if line.startswith("from ")).split(" import")[0]
    return [*_terminated(list(item)), *([f"{module} import {', '.join(extra)}\n"] if extra else [])]


def _comments(lines: Sequence[str]) -> set[str]:
    return {line.strip() for line in lines if "#" in line}


def _imported(lines: Sequence[str]) -> dict[str, None] | None:
    try:
        body = parse_shallow("".join(lines)).body
    except SyntaxError:
        return None
    if len(body) > 1 or not all(isinstance(node, ast.ImportFrom) for node in body):
        return None
    return {ast.unparse(alias): None for node in body for alias in getattr(node, "names", ())}


def _parses(lines: Sequence[str]) -> bool:
    code = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    indent = indent_of(code[0]) if code else ""
    text = framed(_terminated(list(lines)))
    return not code or any(_valid(text + end) for end in ("", f"{indent}    pass\n"))


def _valid(text: str) -> bool:
    try:
        parse_python(text)
    except SyntaxError:
        return False
    return True


def same_lines(one: Sequence[str], other: Sequence[str]) -> bool:
    """Return whether two blocks are the same but for line ends and blank lines around them."""
    return one == other or _plain(one) == _plain(other)


def _plain(lines: Sequence[str]) -> list[str]:
    plain = [line.strip() if placeholder_id(line) is not None else line.rstrip() for line in lines]
    while plain and not plain[-1]:
        plain.pop()
    return plain[next((i for i, line in enumerate(plain) if line), 0) :]


def _by_key(items: Sequence[Item]) -> dict[str, Item]:
    return {item.key: item for item in items}


def _name(scope: str, key: str) -> str:
    name = key.removeprefix("def ").removeprefix("class ")
    return f"{scope}.{name}" if scope else name


def _terminated(lines: list[str]) -> list[str]:
    if lines and not lines[-1].endswith("\n"):
        return [*lines[:-1], lines[-1] + "\n"]
    return lines


def _never_same(_one: Sequence[str], _other: Sequence[str]) -> bool:
    return False


PYTHON = Language(split, _parses, same_meaning, _python_lead)
XML = Language(xml_tree.split, xml_tree.parses, _never_same, xml_tree.lead)
CMAKE = Language(cmake_tree.split, cmake_tree.parses, _never_same, cmake_tree.lead)
