"""Test vectors of events for their monitor in C99: a table, and a main program that runs it."""

from __future__ import annotations

import json
import math

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.conditions.definition import TRUTHS, Value, sample_of
from eddi_scaffold.conditions.samples import Drawing, in_turn
from eddi_scaffold.program.c_files import filled
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor

_MOST_STEPS = 5000


def vectors_file(model: StandaloneMonitor) -> dict[str, str]:
    """Return the name and the text of the file."""
    program, runs, steps = model.program, list[str](), list[str]()
    types = [
        type_
        for read in program.reads
        for type_ in ("double" if read.type == "number" else "int", "int64_t")[: 1 + read.stamped]
    ]
    for number, run in in_turn(Drawing(program, k) for k in range(len(program.results))):
        for given, result in zip(run.steps, run.results, strict=True):
            row = [
                len(runs),
                given.t,
                number,
                _double("number" if model.numeric else "bool", result),
            ]
            for read in program.reads:  # of a wrong type there is nothing in C
                value = sample_of(read._replace(range=None, infinite=True), given.values)
                row += [_double(read.type, value), given.t - given.ages.get(read.name, 0)][
                    : 1 + read.stamped
                ]
            steps.append(f"    {{{', '.join(map(str, row))}}},\n")
        runs.append(f"    {json.dumps(c_comment(run.shows))},\n")
        if len(steps) > _MOST_STEPS:
            break
    texts = {"runs": "".join(runs), "steps": "".join(steps), "columns": str(4 + len(types))}
    texts["arguments"] = "".join(f", ({type_})s[{n}]" for n, type_ in enumerate(types, 4))
    texts["got"] = "value" if model.numeric else "events[(int)s[2]].verdict"
    text = filled("vectors.c", name=model.name, header=HEADER, **texts)
    return {f"{model.name}_vectors.c": text}


def _double(type_: str, value: Value) -> str:
    if type_ == "bool":
        return str(TRUTHS.index(value))
    if value is None:
        return "-1" if type_ == "enum" else "NAN"
    return repr(value) if math.isfinite(value) else f"{'-' * (value < 0)}INFINITY"
