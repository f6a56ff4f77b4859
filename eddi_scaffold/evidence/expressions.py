"""Test vectors of inputs that an expression computes, run with messages of their own."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.definition import History, Sample
from eddi_scaffold.conditions.samples import Drawing, Given, Run
from eddi_scaffold.evidence.runs import rows_of
from eddi_scaffold.evidence.vectors import MOST_BYTES, text

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

_THERE = " is there"
Place = tuple[str, tuple[Any, ...]]  # first word of a name, and the path in its message


def expression_rows(inputs: Sequence[BoundInput]) -> dict[str, Any]:
    """Return rows ``[input id, runs]``, and whether nothing is left out."""
    rows, complete, size = [], True, 0
    for input_ in inputs:
        if input_.expression is None:
            continue
        runs: list[object] = []
        expression = _Expression(input_)
        for run in expression.runs():
            row = [run.shows, rows_of(run, lambda value: {"value": value})]
            size += len(text(row).encode()) + 5
            if size > MOST_BYTES // 3:
                break
            runs.append(row)
        complete &= expression.complete
        rows.append([input_.id, runs])
    return {"expressions": rows, "complete": complete} if rows else {}


class _Expression:
    def __init__(self, input_: BoundInput) -> None:
        assert input_.expression is not None
        self.document = input_.expression
        self.limit = input_.max_age if isinstance(input_.max_age, int | float) else math.inf
        self.programs = [part["program"] for part in self.document["parts"]]
        self.complete = False
        faulty = {}
        if self.limit < 1e9:
            age = round(self.limit * 1e9)
            faulty = {f"max_age {n:+}": (partial(self.see, later=n), age) for n in (-1, 1)}
        self.drawings = [
            Drawing(program, 0, see=self.see, faulty=faulty) for program in self.programs
        ]
        kinds = self.document["names"]
        self.sources = {head: id_ for head, (kind, id_) in kinds.items() if kind == "message"}
        pools = {name: pool for drawing in self.drawings for name, pool in drawing.pools.items()}
        self.places: dict[Place, str] = {self._place(name): name for name in pools}
        for name, checks in self.document.get("checks", {}).items():
            for path, good, bad in _fields(checks):
                place = self._place(name)[0], _tuple(path)
                if place not in self.places:
                    self.places[place] = f"{name} {path}"
                    pools[f"{name} {path}"] = good, bad
        pools |= {head + _THERE: ([True] * 9 + [False], [False]) for head in self.sources}
        for drawing in self.drawings:
            drawing.pools, drawing.aged = pools, [*self.sources]

    def _place(self, name: str) -> Place:
        head = name.partition(".")[0].partition("[")[0]
        path = self.document.get("paths", {}).get(name)
        if path is None:
            words = name.replace("[", ".[").split(".")[1:]
            path = [int(word[1:-1]) if word.startswith("[") else word for word in words]
        return head, _tuple(path)

    def see(self, given: Given, later: int = 0) -> Sample:
        """Return what the expression sees of messages that are given."""
        values, stamps = {}, {}
        for (head, _), name in self.places.items():
            checks = self.document.get("checks", {}).get(name, ())
            is_known = not self._is_hidden(given, head, later)
            raw = given.raws[name]
            for check in checks:
                raw = self._checked(given, head, check, raw)
            values[name] = raw if is_known else None
            stamps[name] = given.t - given.ages.get(head, 0)
        return Sample(given.t, values, stamps)

    def _is_hidden(self, given: Given, head: str, later: int = 0) -> bool:
        """Return whether a message is missing or too old."""
        if head not in self.sources:
            return given.raws[head] is None
        return (given.ages[head] - later) / 1e9 > self.limit or not given.raws[head + _THERE]

    def _checked(self, given: Given, head: str, check: Sequence[Any], raw: Any) -> Any:
        """Return a value, ``None`` where its message says that it is none."""

        def at(path: Any) -> Any:
            return given.raws[self.places[head, _tuple(path)]]

        if check[0] == "unless":
            return None if at(check[1]) == check[2] else raw
        if check[0] == "within":
            low, high = map(at, check[1:])
            is_number = isinstance(raw, int | float)
            return (
                raw
                if is_number
                and (math.isinf(raw) or (None not in (low, high) and low <= raw <= high))
                else None
            )
        if isinstance(raw, list):
            return [each if each in check[1:] else None for each in raw]
        pairs = (
            (at(key[0]), key[1:]) if isinstance(key, list | tuple) else (raw, [key])
            for key in check[1:]
        )
        return raw if any(value in wanted for value, wanted in pairs) else None

    def runs(self) -> Iterator[Run]:
        """Yield runs whose values are messages, and whose results are those of the input."""
        for drawing in self.drawings:
            for run in drawing.runs():
                histories = [
                    History(program, [*map(self.see, run.steps)]) for program in self.programs
                ]
                rows = zip(*(history.results() for history in histories), strict=True)
                results = [self._value([row[0] for row in values]) for values in rows]
                for k, (before, now) in enumerate(zip(run.steps, run.steps[1:], strict=False), 1):
                    if before.t == now.t and any(
                        self._is_hidden(now, head) for head in self.document["names"]
                    ):
                        results[k] = None  # where a clock stands, silence shows
                end = min(history.unsure for history in histories)
                steps = [*self._messages(run.steps[:end])]
                yield Run(run.shows, steps, results[:end])
        self.complete = all(drawing.complete for drawing in self.drawings)

    def _value(self, truths: Sequence[Any]) -> Any:
        """Return what the input is."""
        type_ = self.document["type"]
        if type_ == "state":
            states = [part["state"] for part in self.document["parts"]]
            is_single = truths.count(True) == 1 and None not in truths
            return states[truths.index(True)] if is_single else None
        (value,) = truths
        if type_ == "bool" and value is None and self.document["polarity"] == "HAZARD":
            return True
        return (
            round(value) if type_ == "int" and value is not None and math.isfinite(value) else value
        )

    def _messages(self, steps: Sequence[Given]) -> Iterator[Given]:
        """Yield steps with messages in the place of single values."""
        trees: dict[tuple[int, ...], Any] = {}
        for given in steps:
            messages: dict[str, Any] = {}
            for head, (kind, id_) in self.document["names"].items():
                fields = {
                    path: given.raws[name] for (of, path), name in self.places.items() if of == head
                }
                key = (hash(head), *map(id, fields.values()))
                tree: Any = trees.get(key)
                for path, raw in fields.items() if tree is None else ():
                    tree = _grown(tree, path, raw)
                trees[key] = tree
                messages[id_] = tree if kind == "input" or given.raws[head + _THERE] else None
            ages = {id_: given.ages[head] for head, id_ in self.sources.items()}
            yield Given(given.t, messages, ages)


def _tuple(path: Any) -> Any:
    return tuple(map(_tuple, path)) if isinstance(path, list | tuple) else path


def _fields(checks: Sequence[Sequence[Any]]) -> Iterator[tuple[Any, list[Any], list[Any]]]:
    """Yield the fields that say whether a value is one: path, values by which it is, and others."""
    for check in checks:
        if check[0] == "unless":
            wrong = check[2]
            other = (
                not wrong
                if isinstance(wrong, bool)
                else wrong + ("-" if isinstance(wrong, str) else 1)
            )
            yield check[1], [other], [wrong]
        elif check[0] == "within":
            yield check[1], [-math.inf], [math.inf, None]
            yield check[2], [math.inf], [-math.inf, None]
        else:
            for path, *wanted in (key for key in check[1:] if isinstance(key, list | tuple)):
                others = ("-", True, False, *range(9))
                yield path, wanted, [next(other for other in others if other not in wanted)]


def _grown(tree: Any, path: Sequence[Any], raw: Any) -> Any:
    """Return a message with a value at the end of a path."""
    if not path:
        return raw
    step, *rest = path
    if isinstance(step, str):
        return {**(tree or {}), step: _grown((tree or {}).get(step), rest, raw)}
    items = [*(tree or [])]
    if isinstance(step, int):
        items += [None] * (step + 1 - len(items))
        items[step] = _grown(items[step], rest, raw)
    elif step[0] == "*":
        if not isinstance(raw, list):
            return raw
        first = int(step[1]) if len(step) > 1 else 0
        items += [None] * (first + len(raw) - len(items))
        for k, each in enumerate(raw, first):
            items[k] = _grown(items[k], rest, each)
    elif len(step) == 2:
        key, wanted = step[0].split("."), step[1]
        at = next((k for k, item in enumerate(items) if _followed(item, key) == wanted), len(items))
        items += [_grown(None, key, wanted)] if at == len(items) else []
        items[at] = _grown(items[at], rest, raw)
    else:
        values, names, wanted = step
        message = {names: [], values: [], **(tree or {})}
        if wanted not in message[names]:
            message[names], message[values] = [*message[names], wanted], [*message[values], None]
        at = message[names].index(wanted)
        message[values] = [*message[values]]
        message[values][at] = _grown(message[values][at], rest, raw)
        return message
    return items


def _followed(item: Any, path: Sequence[str]) -> Any:
    for word in path:
        item = item.get(word) if isinstance(item, dict) else None
    return item
