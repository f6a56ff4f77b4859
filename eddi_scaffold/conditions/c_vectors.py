"""Test vectors of events for their monitor in C99: a table, and a main program that runs it."""

from __future__ import annotations

import json
import math
from itertools import takewhile

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.conditions.definition import Value, sample_of
from eddi_scaffold.conditions.samples import Drawing, in_turn
from eddi_scaffold.program.c_files import filled
from eddi_scaffold.program.c_step import int64
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor

_MOST_CHARACTERS = 1 << 19


def vectors_file(model: StandaloneMonitor) -> dict[str, str]:
    """Return the name and the text of the file."""
    program, fields, arguments = model.program, "", ""
    for name, read in zip(model.variables, program.reads, strict=True):
        for field in (f"v_{name}", f"v_{name}_stamp")[: 1 + read.stamped]:
            kind = (
                "int64_t" if field != f"v_{name}" else "double" if read.type == "number" else "int"
            )
            fields += f"    {kind} {field};\n"
            arguments += f", steps[k].{field}"
    runs, steps = "", ""
    drawings = (Drawing(program, k) for k in range(len(program.results)))
    drawn = takewhile(lambda _: len(steps) < _MOST_CHARACTERS, in_turn(drawings))
    for number, (event, run) in enumerate(drawn):
        runs += f"    {json.dumps(c_comment(run.shows))},\n"
        for given, result in zip(run.steps, run.results, strict=True):
            cells = [str(number), int64(given.t)]
            for read in program.reads:  # of a wrong type there is nothing in C
                value = sample_of(read._replace(range=None, infinite=True), given.values)
                cells.append(_literal(read.type, value))
                cells += [int64(given.t - given.ages.get(read.name, 0))] if read.stamped else []
            cells += [str(event), _literal("number" if model.numeric else "bool", result)]
            steps += f"    {{{', '.join(cells)}}},\n"
    got = "value" if model.numeric else "events[steps[k].event].verdict"
    texts = {"fields": fields, "arguments": arguments, "runs": runs, "steps": steps, "got": got}
    text = filled("vectors.c", name=model.name, header=HEADER, **texts)
    return {f"{model.name}_vectors.c": text}


def _literal(type_: str, value: Value) -> str:
    if type_ == "bool":
        return {False: "0", None: "1", True: "2"}[value]
    if value is None:
        return "-1" if type_ == "enum" else "NAN"
    return repr(value) if math.isfinite(value) else f"{'-' * (value < 0)}INFINITY"
