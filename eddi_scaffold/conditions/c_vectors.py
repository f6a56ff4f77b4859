"""Test vectors of events for their monitor in C99: a table, and a main program that runs it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from string import Template
from typing import Any

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.conditions.definition import Value, sample_of
from eddi_scaffold.conditions.samples import Drawing, Run, in_turn
from eddi_scaffold.program.c_step import int64
from eddi_scaffold.program.instructions import Read
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor

_MOST_STEPS = 5000
_TEXT = Template("""\
/* Test vectors of the conditions, $header.
 *
 * main returns the number of failures, at most 100. Compile it with ${name}_event.c. */
#include "${name}_event.h"

#include <math.h>
#include <stdio.h>

static const char *const runs[] = {
$runs};

static const struct {
    int run;
    int64_t t;
$fields    int event;
    double expected; /* of truth values 0, 1, 2; NAN is an UNKNOWN number */
} steps[] = {
$steps};

static ${name}_t monitor;

int main(void)
{
    const size_t count = sizeof steps / sizeof steps[0];
    int failures = 0;
    for (size_t k = 0; k < count; k++) {
        if (k == 0 || steps[k].run != steps[k - 1].run) {
            ${name}_reset(&monitor);
        }
        (void)${name}_step(&monitor, steps[k].t$arguments);
        const double got = $got, expected = steps[k].expected;
        const bool unknown = isnan(got) && isnan(expected);
        if (!unknown && !(fabs(got - expected) <= 1e-9 * fabs(expected))) {
            printf("%s, at %lld ns: expected %.17g, got %.17g\\n", runs[steps[k].run],
                   (long long)steps[k].t, expected, got);
            failures++;
        }
    }
    return failures < 100 ? failures : 100;
}
""")


def vectors_file(model: StandaloneMonitor) -> dict[str, str]:
    """Return the name and the text of the file."""
    fields, arguments = "", ""
    for name, read in zip(model.variables, model.program.reads, strict=True):
        fields += f"    {'double' if read.type == 'number' else 'int'} v_{name};\n"
        fields += f"    int64_t v_{name}_stamp;\n" if read.stamped else ""
        arguments += f", steps[k].v_{name}" + (f", steps[k].v_{name}_stamp" if read.stamped else "")
    runs, steps = "", ""
    for number, (event, run) in enumerate(_drawn(model)):
        runs += f"    {json.dumps(c_comment(run.shows))},\n"
        for given, result in zip(run.steps, run.results, strict=True):
            cells = [str(number), int64(given.t)]
            for read in model.program.reads:
                cells.append(_argument(read, given.raws))
                if read.stamped:
                    cells.append(int64(given.t - given.ages.get(read.name, 0)))
            cells += [str(event), _value("number" if model.numeric else "bool", result)]
            steps += f"    {{{', '.join(cells)}}},\n"
    got = "value" if model.numeric else "events[steps[k].event].verdict"
    text = _TEXT.substitute(
        name=model.name,
        header=HEADER,
        fields=fields,
        arguments=arguments,
        got=f"(double)monitor.{got}",
        runs=runs,
        steps=steps,
    )
    return {f"{model.name}_vectors.c": text}


def _drawn(model: StandaloneMonitor) -> Iterator[tuple[int, Run]]:
    drawings = [Drawing(model.program, k) for k in range(len(model.program.results))]
    left = _MOST_STEPS
    for event, run in in_turn(drawings):
        left -= len(run.steps)
        if left < 0:
            return
        yield event, run


def _argument(read: Read, raws: Any) -> str:
    """Return what a host gives for a value, which has no wrong types."""
    return _value(read.type, sample_of(read._replace(range=None, infinite=True), raws))


def _value(type_: str, value: Value) -> str:
    if type_ == "bool":
        return {False: "0", None: "1", True: "2"}[value]
    if type_ == "enum":
        return "-1" if value is None else str(value)
    if value is None:
        return "NAN"
    return repr(value) if math.isfinite(value) else f"{'-' * (value < 0)}INFINITY"
