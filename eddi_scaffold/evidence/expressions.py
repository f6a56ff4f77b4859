"""Test vectors of inputs that an expression computes; the values of messages are given by field."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.definition import Sample
from eddi_scaffold.conditions.samples import Drawing, Run
from eddi_scaffold.evidence.vectors import MOST_BYTES, run_row, text

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput


def expression_rows(inputs: Sequence[BoundInput]) -> dict[str, Any]:
    """Return rows ``[input id, fields, runs]``, and whether nothing is left out.

    ``fields``: name -> what is asked for, ``[word, path, *checks]``; the answer is a value.
    """
    rows, complete, size = [], True, 0
    for expression in (_Expression(of) for of in inputs if of.expression is not None):
        runs = list[object]()
        for run in expression.runs():
            runs.append(run_row(run, lambda value: {"value": value}))
            size += len(text(runs[-1]).encode())
            if size > MOST_BYTES // 3:
                break
        complete &= not any(drawing.missed for drawing in expression.drawings)
        rows.append([expression.id, expression.fields, runs])
    return {"expressions": rows, "complete": complete} if rows else {}


class _Expression:
    def __init__(self, input_: BoundInput) -> None:
        assert input_.expression is not None
        self.id, self.document, limit = input_.id, input_.expression, input_.max_age
        most = limit * 1e9 if isinstance(limit, int | float) else math.inf
        names, paths, checks = (self.document.get(key, {}) for key in ("names", "paths", "checks"))
        parts = self.document["parts"]
        self.drawings = [Drawing(part["program"], 0, see=self.see) for part in parts]
        pools = {name: pool for drawing in self.drawings for name, pool in drawing.pools.items()}
        heads = {name: head_of(name) for name in pools}
        self.fields = {
            name: [head, paths.get(name) or path_of(name), *checks.get(name, ())]
            for name, head in heads.items()
        }
        ids = {head: id_ for head, (kind, id_) in names.items() if kind == "message"}
        self.sources = {name: ids[head] for name, head in heads.items() if head in ids}
        for drawing in self.drawings:
            drawing.pools, drawing.aged = pools, sorted({*ids.values()})
            drawing.ages = [age for age in drawing.ages if age <= most]  # others give no value

    def see(self, given: Sample) -> Sample:
        """Return what the expression sees: all of a message is of one age."""
        ages = {name: given.ages[id_] for name, id_ in self.sources.items()}
        return given._replace(ages=ages)

    def runs(self) -> Iterator[Run]:
        """Yield runs with the values of the input."""
        for run in (run for drawing in self.drawings for run in drawing.runs()):
            histories = [drawing.history(run.steps) for drawing in self.drawings]
            rows = zip(*(history.results() for history in histories), strict=True)
            end = min(map(Drawing.certain, self.drawings, histories))
            results = [self._value([value for (value,) in row]) for row in rows]
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
