"""Target ``c``: C99 without heap, recursion or globals; SESAME D7.2's four parts in three files.

``<name>_event.h`` holds the types, ``<name>_event.c`` the functions, ``<name>_main.c`` the
variables (stubs in which a person writes) and the main program.
"""

from __future__ import annotations

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.program import c_step
from eddi_scaffold.program.c_functions import TYPES, functions
from eddi_scaffold.program.instructions import Read
from eddi_scaffold.program.kept_bodies import HEADER, region
from eddi_scaffold.program.standalone import StandaloneMonitor, describe, unique_names

_KLEENE = """\
#ifndef EDDI_EVENT_TYPES
#define EDDI_EVENT_TYPES
typedef enum { EVENT_FALSE = 0, EVENT_UNKNOWN = 1, EVENT_TRUE = 2 } event_kleene;

typedef struct {
    event_kleene verdict;
    bool active;  /* EVIDENCE: TRUE; HAZARD: TRUE or UNKNOWN */
    bool raised;  /* the verdict became TRUE in this step */
    bool cleared; /* the verdict was TRUE and is no longer */
} event_output;

"""
_TYPES = {"number": "double ", "text": "const char *"}
_UNKNOWN = {"number": "NAN", "bool": "EVENT_UNKNOWN", "enum": "-1", "text": "NULL"}
_PUBLISH = """\
static void publish(event_output *event, int verdict, bool hazard)
{
    bool before = event->verdict == EVENT_TRUE;
    event->verdict = (event_kleene)verdict;
    event->raised = verdict == 2 && !before;
    event->cleared = verdict != 2 && before;
    event->active = verdict == 2 || (hazard && verdict == 1);
}
"""


def c_files(model: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of the monitor in C99.

    Raises:
        EddiError: C has no lists or numbers in texts yet (E026).
    """
    given = [(read, model.sampling.uses[k]) for k, read in enumerate(model.program.reads)]
    used = {use for read, uses in given if read.reduction is not None or read.text for use in uses}
    inputs = [model.sampling.inputs[k] for k in sorted(used)]
    lists = [input_.name for input_ in inputs if input_.list or input_.type == "text"]
    if lists:
        raise EddiError(problem("E026.lists", lists=", ".join(lists)))
    return {
        f"{model.name}_{model.kind}.h": _text(_header(model)),
        f"{model.name}_{model.kind}.c": _text(_implementation(model)),
        f"{model.name}_main.c": _text(_main(model)),
    }


def _text(lines: list[str]) -> str:
    return "\n".join(line.rstrip() for line in lines) + "\n"


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def _banner(model: StandaloneMonitor, what: str) -> list[str]:
    lines = [f"/* {what}, {HEADER}.", " *"]
    lines += [f" *     {line}" for line in model.source[:200]]
    return [*lines, " */"]


def _declared(read: Read, name: str) -> str:
    """Return the declaration of what holds or returns a value."""
    return f"{_TYPES.get(read.type, 'int ')}{name}"


def _parameters(model: StandaloneMonitor) -> str:
    found = ["int64_t t_ns"]
    for k, variable in enumerate(model.program.reads):
        found.append(f"{_declared(variable, 'v_' + model.variables[k])}")
        if variable.stamped:
            found.append(f"int64_t v_{model.variables[k]}_stamp")
    return ", ".join(found)


def _result(model: StandaloneMonitor) -> str:
    if model.numeric:
        return "double"
    return "event_kleene" if len(model.events) == 1 else "void"


def _signature(model: StandaloneMonitor) -> str:
    return f"{_result(model)} {model.name}_step({model.name}_t *m, {_parameters(model)})"


def _header(model: StandaloneMonitor) -> list[str]:
    name, guard = model.name, f"{model.name}_{model.kind}_H".upper()
    lines = [*_banner(model, "3. Types: do not edit"), f"#ifndef {guard}", f"#define {guard}", ""]
    lines += ["#include <stdbool.h>", "#include <stdint.h>", ""]
    lines += [*_KLEENE.split("\n")[:-1], *TYPES.split("\n")[:-1], "#endif", ""]
    for enum, literals in _enums(model).items():
        prefix = f"{name}_{enum}".upper()
        lines += [f"/* {enum}, -1 is UNKNOWN */", "enum {"]
        words = unique_names(literals)
        lines += [f"    {prefix}_{word} = {k}," for k, word in enumerate(words)]
        lines[-1] = lines[-1].rstrip(",")
        lines += ["};", ""]
    if not model.numeric:
        lines += ["enum {"]
        lines += [
            f"    {name.upper()}_{event.upper()}_{k}," for k, event in enumerate(model.events)
        ]
        lines += [f"    {name.upper()}_EVENTS", "};", ""]
    lines += [
        "typedef struct {",
        "    bool started;",
        "    int64_t last;  /* time of the last step */",
    ]
    lines += ["    int64_t since; /* time of the first sample of full windows */"]
    events = f"    event_output events[{max(1, len(model.events))}];"
    lines += ["    double value;" if model.numeric else events]
    lines += [*_indented(c_step.fields(model)), f"}} {name}_t;", ""]
    lines += ["/* Forget everything. Call it before the first step. */"]
    lines += [
        f"void {name}_reset({name}_t *m);",
        "",
        *_contract(model),
        f"{_signature(model)};",
        "",
    ]
    return [*lines, "#endif"]


def _contract(model: StandaloneMonitor) -> list[str]:
    period = model.program.period
    rate = f"Call it every {period} ns. " if period else ""
    lines = [f"/* One step. {rate}t_ns: any clock, within +-2^62; the same time again is ignored,"]
    lines += [" * an earlier one: the clock went back, all is forgotten first.", " *"]
    for k, name in enumerate(model.variables):
        kind = model.program.reads[k].type
        lines.append(f" * v_{name}: {describe(model, k)}; {_UNKNOWN[kind]} is UNKNOWN")
    return [*lines, " *", " * Compile with -ffp-contract=off and without -ffast-math. */"]


def _enums(model: StandaloneMonitor) -> dict[str, tuple[str, ...]]:
    pairs = zip(model.enums, model.program.reads, strict=True)
    return {enum: variable.literals for enum, variable in sorted(pairs) if enum}


def _implementation(model: StandaloneMonitor) -> list[str]:
    name = model.name
    forget, step, done = c_step.resets(model), _step(model), model.program.operations
    lines = [*_banner(model, "2. Functions: do not edit"), f'#include "{name}_{model.kind}.h"', ""]
    texts = ["#include <string.h>"] if any(one.op == "is_covered" for one in done) else []
    lines += ["#include <math.h>", *texts, "", "#ifdef __FAST_MATH__"]
    lines += ['#error "-ffast-math has no NaN: compile without it"', "#endif", ""]
    lines += functions("\n".join([*forget, *step])).split("\n")[:-1]
    lines += _PUBLISH.split("\n") if model.events and not model.numeric else []
    lines += [f"static void forget({name}_t *m)", "{", *_indented(forget or ["(void)m;"]), "}", ""]
    lines += [f"void {name}_reset({name}_t *m)", "{", "    m->started = false;"]
    lines += ["    m->last = 0;", "    m->since = 0;"]
    if model.numeric:
        lines += ["    m->value = NAN;"]
    else:
        for k in range(len(model.events)):
            lines += [f"    m->events[{k}].verdict = EVENT_UNKNOWN;"]
            lines += [f"    publish(&m->events[{k}], 1, {_hazard(model, k)});"]
    for k, node in enumerate(model.program.operations):
        if node.capacity:
            lines += [f"    m->w{k}.overflows = 0u;"]
        if node.coverage is not None:
            lines += [f"    m->c{k}.overflows = 0u;"]
    lines += ["    forget(m);", "}", "", _signature(model), "{", *step, "}"]
    return lines


def _hazard(model: StandaloneMonitor, k: int) -> str:
    return "true" if model.program.results[k].hazard else "false"


def _step(model: StandaloneMonitor) -> list[str]:
    period = model.program.period
    windows = any(node.window for node in model.program.operations)
    lines = ["const int64_t t = t_ns;"]
    lines += ["int64_t age, start;"] if windows else []
    lines += c_step.declarations(model)
    last = {"double": "return m->value;", "event_kleene": "return m->events[0].verdict;"}
    back = last.get(_result(model), "return;")
    quiet = []
    for k in range(len(model.events) if not model.numeric else 0):
        quiet += [f"m->events[{k}].raised = false;", f"m->events[{k}].cleared = false;"]
    limit = c_step.int64(1 << 62)
    lines += ["", f"if (t > {limit} || t < -{limit} || (m->started && t == m->last)) {{"]
    lines += [*_indented([*quiet, back]), "}"]
    lines += ["if (!m->started || t < m->last) {", "    forget(m);", "    m->started = true;"]
    lines += ["    m->since = t;"]
    if period:
        lines += [f"}} else if (2 * (t - m->last) > {c_step.int64(5 * period)}) {{"]
        lines += ["    m->since = t; /* a gap: windows fill again */"]
    lines += ["}", "m->last = t;"]
    lines += ["age = t - m->since;"] if windows else []
    lines += [*c_step.statements(model), ""]
    for k, output in enumerate(model.program.results):
        found = c_step.value(model, output.operation)
        if model.numeric:
            lines += [f"m->value = {found};"]
        else:
            about = f" /* {c_comment(output.about)} */" if output.about else ""
            lines += [f"publish(&m->events[{k}], {found}, {_hazard(model, k)});{about}"]
    return _indented([line for line in (*lines, back) if line != "return;"])


def _main(model: StandaloneMonitor) -> list[str]:
    name = model.name
    lines = [*_banner(model, "1. Variables, 4. Main: edit between the markers only")]
    lines += [
        f'#include "{name}_{model.kind}.h"',
        "",
        "#include <math.h>",
        "#include <stdio.h>",
        "",
    ]
    lines += [
        "/* ---- 1. Variables: where the values come from; each is read once in a step ---- */",
        "",
    ]
    for k, variable in enumerate(model.program.reads):
        unknown = _UNKNOWN[variable.type]
        stamp = "int64_t *stamp" if variable.stamped else "void"
        lines += [f"/* {describe(model, k)}; {unknown} is UNKNOWN. */"]
        function = _declared(variable, f"read_{model.variables[k]}")
        lines += [f"static {function}({stamp})", "{"]
        if variable.stamped:  # outside of the region: a body need not use it
            lines += ["    (void)stamp; /* set *stamp when the sample is not from now */"]
        body = [f"    return {unknown};"]
        lines += [*region(f"variable:{variable.name}", body, c=True, indent="    "), "}", ""]
    for k, output in enumerate(model.program.results if not model.numeric else ()):
        for what in ("raised", "cleared"):
            lines += [f"static void on_{what}_{model.events[k]}(int64_t t_ns)", "{"]
            lines += region(f"{what}:{output.id}", ["    (void)t_ns;"], c=True, indent="    ")
            lines += ["}", ""]
    return [*lines, *_loop(model)]


def _loop(model: StandaloneMonitor) -> list[str]:
    name, period = model.name, model.program.period or 10**9
    lines = [
        "/* ---- 4. Main ---- */",
        "",
        "/* Wait for the next step and return its time; ends the",
    ]
    lines += [" * program by returning false. */", "static bool next_step(int64_t *t_ns)", "{"]
    body = ["    /* A real program waits for its monotonic clock here. */"]
    body += [
        f"    *t_ns += {c_step.int64(period)};",
        f"    return *t_ns < {c_step.int64(10 * period)};",
    ]
    lines += [*region("main:next_step", body, c=True, indent="    "), "}", ""]
    lines += [f"static {name}_t monitor; /* too large for some stacks */", ""]
    lines += ["int main(void)", "{", "    int64_t t = 0;"]
    arguments = ["t"]
    for k, variable in enumerate(model.program.reads):
        word = model.variables[k]
        if variable.stamped:
            lines += [f"    int64_t stamp_{word};"]
        lines += [f"    {_declared(variable, 'v_' + word)};"]
        arguments += [f"v_{word}", *([f"stamp_{word}"] if variable.stamped else [])]
    lines += ["", f"    {name}_reset(&monitor);", "    while (next_step(&t)) {"]
    for k, variable in enumerate(model.program.reads):
        word = model.variables[k]
        if variable.stamped:
            lines += [f"        stamp_{word} = t;"]
        lines += [
            f"        v_{word} = read_{word}({f'&stamp_{word}' if variable.stamped else ''});"
        ]
    lines += [f"        (void){name}_step(&monitor, {', '.join(arguments)});"]
    if model.numeric:
        lines += ['        printf("%.17g\\n", monitor.value);']
    for k, event in enumerate(model.events if not model.numeric else ()):
        lines += [f"        if (monitor.events[{k}].raised) {{ on_raised_{event}(t); }}"]
        lines += [f"        if (monitor.events[{k}].cleared) {{ on_cleared_{event}(t); }}"]
        number = f"(int)monitor.events[{k}].verdict"
        lines += [f'        printf("{event} %d\\n", {number});']
    return [*lines, "    }", "    return 0;", "}"]
