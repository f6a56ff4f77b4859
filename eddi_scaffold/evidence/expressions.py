"""Test vectors of inputs that an expression computes; the values of messages are given by field."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.definition import History, Sample
from eddi_scaffold.conditions.samples import Drawing, Run
from eddi_scaffold.evidence.vectors import MOST_BYTES, run_row, text

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

_THERE = " is there"  # of a message


def expression_rows(inputs: Sequence[BoundInput]) -> dict[str, Any]:
    """Return rows ``[input id, fields, runs]``, and whether nothing is left out.

    ``fields``: name -> what is asked for, ``[word, path, *checks]``; the answer is a value.
    """
    rows, complete, size = [], True, 0
    for input_ in inputs:
        if input_.expression is not None:
            expression, runs = _Expression(input_), list[object]()
            for run in expression.runs():
                runs.append(run_row(run, lambda value: {"value": value}))
                size += len(text(runs[-1]).encode())
                if size > MOST_BYTES // 3:
                    break
            complete &= all(drawing.complete for drawing in expression.drawings)
            rows.append([input_.id, expression.fields, runs])
    return {"expressions": rows, "complete": complete} if rows else {}


class _Expression:
    def __init__(self, input_: BoundInput) -> None:
        assert input_.expression is not None
        self.document = input_.expression
        limit = input_.max_age
        self.limit = limit if isinstance(limit, int | float) else math.inf
        faulty = {}
        if self.limit < 1e9:
            age = round(self.limit * 1e9)
            faulty = {f"max_age {n:+}": (partial(self.see, more=n), age) for n in (-1, 1)}
        self.programs = [part["program"] for part in self.document["parts"]]
        self.drawings = [Drawing(each, 0, see=self.see, faulty=faulty) for each in self.programs]
        pools = {name: pool for drawing in self.drawings for name, pool in drawing.pools.items()}
        self.heads = {name: head_of(name) for name in pools}
        names = self.document["names"].items()
        self.sources = {head: id_ for head, (kind, id_) in names if kind == "message"}
        pools |= {id_ + _THERE: ([True] * 9 + [False], [False]) for id_ in self.sources.values()}
        for drawing in self.drawings:
            drawing.pools, drawing.aged = pools, [*self.sources.values()]
        paths, checks = (self.document.get(key, {}) for key in ("paths", "checks"))
        self.fields = {
            name: [head, paths.get(name) or path_of(name), *checks.get(name, ())]
            for name, head in self.heads.items()
        }

    def see(self, given: Sample, more: int = 0) -> Sample:
        """Return what the expression sees; messages may be some nanoseconds older."""
        hidden = self._hidden(given, more)
        values = {
            name: None if head in hidden else given.values[name]
            for name, head in self.heads.items()
        }
        ages = {head: given.ages[id_] for head, id_ in self.sources.items()}
        late = {name: ages.get(head, 0) for name, head in self.heads.items()}
        return Sample(given.t, values, late)

    def _hidden(self, given: Sample, more: int = 0) -> list[str]:
        """Return words of messages that are missing or too old, and of inputs without a value."""
        late = [
            head
            for head, id_ in self.sources.items()
            if not given.values[id_ + _THERE] or (given.ages[id_] - more) / 1e9 > self.limit
        ]
        inputs = self.document["names"].keys() - self.sources
        return late + [head for head in sorted(inputs) if given.values[head] is None]

    def runs(self) -> Iterator[Run]:
        """Yield runs with the values of the input."""
        for run in (run for drawing in self.drawings for run in drawing.runs()):
            samples = [*map(self.see, run.steps)]
            histories = [History(program, samples) for program in self.programs]
            rows = zip(*(history.results() for history in histories), strict=True)
            results = [self._value([value for (value,) in row]) for row in rows]
            for k, given in enumerate(run.steps):
                if k and given.t == run.steps[k - 1].t and self._hidden(given):
                    results[k] = None  # where a clock stands, silence shows
            end = min(drawing.certain(run.steps) for drawing in self.drawings)
            yield Run(run.shows, run.steps[:end], results[:end])

    def _value(self, values: Sequence[Any]) -> Any:
        """Return what the input is, of one value, or of a truth for each state."""
        type_ = self.document["type"]
        if type_ == "state":
            is_single = values.count(True) == 1 and None not in values
            return self.document["parts"][values.index(True)]["state"] if is_single else None
        if type_ == "bool" and values[0] is None:
            return True if self.document["polarity"] == "HAZARD" else None
        return round(values[0]) if type_ == "int" and values[0] is not None else values[0]


def head_of(name: str) -> str:
    """Return the first word of a name."""
    return name.partition(".")[0].partition("[")[0]


def path_of(name: str) -> list[str | int]:
    """Return the path behind the first word of a name."""
    words = name.replace("[", ".[").split(".")[1:]
    return [int(word[1:-1]) if word.startswith("[") else word for word in words]
