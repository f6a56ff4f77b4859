"""Monitors in C99 without heap, recursion or globals; SESAME D7.2's four parts in three files.

``<name>_event.h`` holds the types, ``<name>_event.c`` the functions, ``<name>_main.c`` the
variables (stubs in which a person writes) and the main program.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib.resources import files
from string import Template

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.program.c_step import CStep, int64
from eddi_scaffold.program.instructions import MAX_NS, Read
from eddi_scaffold.program.standalone import HEADER, StandaloneMonitor, region

_TYPES = {"number": "double ", "text": "const char *"}
_UNKNOWN = {"number": "NAN", "bool": "EVENT_UNKNOWN", "enum": "-1", "text": "NULL"}
_CALLED = re.compile(r"\b([a-z_]\w*)\(")
_NAME = re.compile(r"(?m)^static \w+ (\w+)\(")


def c_files(model: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of the monitor in C99 (EddiError, E026: lists, numbers in texts)."""
    reads = [(read, model.sampling.uses[k]) for k, read in enumerate(model.program.reads)]
    used = {use for read, uses in reads if read.reduction is not None or read.text for use in uses}
    inputs = [model.sampling.inputs[k] for k in sorted(used)]
    lists = [input_.name for input_ in inputs if input_.list or input_.type == "text"]
    if lists:
        raise EddiError(problem("E026.lists", lists=", ".join(lists)))
    texts = {
        f"{model.name}_{model.kind}.h": _header(model),
        f"{model.name}_{model.kind}.c": _implementation(model),
        f"{model.name}_main.c": _main(model),
    }
    return {
        file: "".join(f"{line.rstrip()}\n" for line in text.rstrip("\n").split("\n"))
        for file, text in texts.items()
    }


def library() -> dict[str, str]:
    """Return the name and the text of each function that monitors may call."""
    _, *texts = _read("functions.c").split("\n\n")
    folds = [text for text in texts if "FOLD_" in text]
    named: dict[str, str] = {}
    for text in (text.rstrip("\n") for text in texts if text not in folds):
        name = _NAME.findall(text)[0]
        named[name] = text
        for fold in folds if name.endswith("_gather") else ():
            function = fold.replace("FOLD_", name.removesuffix("gather")).rstrip("\n")
            named[_NAME.findall(function)[0]] = function
    return named


def types() -> str:
    """Return the types that begin each header."""
    return _read("types.h")


def functions(body: str) -> str:
    """Return the static functions that a text calls, and those that they call."""
    needed, parts = set(_CALLED.findall(body)), []
    for name, function in reversed(library().items()):
        if name in needed:
            needed.update(_CALLED.findall(function))
            parts.append(function)
    return "".join(f"{function}\n\n" for function in reversed(parts))


def _read(file: str) -> str:
    return files(__package__).joinpath(file).read_text("utf-8")


def filled(file: str, **texts: str) -> str:
    """Return the text of a file of this package with names replaced."""
    return Template(_read(file)).substitute(texts)


def _block(lines: Iterable[str], blanks: int = 4) -> str:
    return "".join(f"{' ' * blanks}{line}\n" for line in lines)


def _banner(model: StandaloneMonitor, what: str) -> str:
    source = (f" *     {line}\n" for line in model.source[:200])
    return f"/* {what}, {HEADER}.\n *\n{''.join(source)} */"


def _declared(read: Read, name: str) -> str:
    """Return the declaration of what holds or returns a value."""
    return f"{_TYPES.get(read.type, 'int ')}{name}"


def _result(model: StandaloneMonitor) -> str:
    if model.numeric:
        return "double"
    return "event_kleene" if len(model.events) == 1 else "void"


def _signature(model: StandaloneMonitor) -> str:
    parameters = ["int64_t t_ns"]
    for name, read in zip(model.variables, model.program.reads, strict=True):
        parameters.append(_declared(read, f"v_{name}"))
        if read.stamped:
            parameters.append(f"int64_t v_{name}_stamp")
    return f"{_result(model)} {model.name}_step({model.name}_t *m, {', '.join(parameters)})"


def _header(model: StandaloneMonitor) -> str:
    name, guard = model.name, f"{model.name}_{model.kind}_H".upper()
    enums = ""
    for enum, literals in model.literals.items():
        prefix = f"{name}_{enum}".upper()
        words = (f"    {prefix}_{word} = {k}" for k, word in enumerate(literals))
        rows = ",\n".join(words)
        enums += f"/* {enum}, -1 is UNKNOWN */\nenum {{\n{rows}\n}};\n\n"
    if not model.numeric:
        events = (f"{name.upper()}_{event.upper()}_{k}," for k, event in enumerate(model.events))
        enums += f"enum {{\n{_block([*events, f'{name.upper()}_EVENTS'])}}};\n\n"
    results = f"event_output events[{max(1, len(model.events))}];"
    period = model.program.period
    rate = f"Call it every {period} ns. " if period else ""
    variables = (
        f"* v_{word}: {model.describe(k)}; {_UNKNOWN[model.program.reads[k].type]} is UNKNOWN"
        for k, word in enumerate(model.variables)
    )
    return filled(
        "monitor.h",
        banner=_banner(model, "3. Types: do not edit"),
        guard=guard,
        types=types(),
        enums=enums,
        name=name,
        results="double value;" if model.numeric else results,
        fields=_block(CStep(model).fields()),
        rate=rate,
        variables=_block(variables, 1),
        signature=_signature(model),
    )


def _implementation(model: StandaloneMonitor) -> str:
    name, operations = model.name, model.program.operations
    step, forget = CStep(model), CStep(model).resets()
    body = _step(model, step)
    texts = (
        "#include <string.h>\n"
        if any(operation.op == "is_covered" for operation in operations)
        else ""
    )
    called = "\n".join([*forget, body, *([] if model.numeric else ["publish("])])
    reset = ["m->value = NAN;"] if model.numeric else []
    for k, hazard in enumerate(() if model.numeric else _hazards(model)):
        reset += [f"m->events[{k}].verdict = EVENT_UNKNOWN;"]
        reset += [f"publish(&m->events[{k}], 1, {hazard});"]
    for k, operation in enumerate(operations):
        reset += [f"m->w{k}.overflows = 0u;"] if operation.capacity else []
        reset += [f"m->c{k}.overflows = 0u;"] if operation.coverage is not None else []
    return filled(
        "monitor.c",
        banner=_banner(model, "2. Functions: do not edit"),
        name=name,
        kind=model.kind,
        texts=texts,
        functions=functions(called),
        forget=_block(forget or ["(void)m;"]),
        reset=_block(reset),
        signature=_signature(model),
        body=body,
    )


def _hazards(model: StandaloneMonitor) -> list[str]:
    return ["true" if result.hazard else "false" for result in model.program.results]


def _step(model: StandaloneMonitor, step: CStep) -> str:
    period = model.program.period
    windows = any(operation.window for operation in model.program.operations)
    last = {"double": "return m->value;", "event_kleene": "return m->events[0].verdict;"}
    back = last.get(_result(model), "return;")
    quiet = [
        f"m->events[{k}].{flag} = false;"
        for k in range(0 if model.numeric else len(model.events))
        for flag in ("raised", "cleared")
    ]
    limit = int64(MAX_NS)
    lines = ["const int64_t t = t_ns;", *(["int64_t age, start;"] if windows else [])]
    lines += [*step.declarations(), ""]
    lines += [f"if (t > {limit} || t < -{limit} || (m->started && t == m->last)) {{"]
    lines += [*(f"    {line}" for line in (*quiet, back)), "}"]
    lines += ["if (!m->started || t < m->last) {", "    forget(m);", "    m->started = true;"]
    lines += ["    m->since = t;"]
    if period:
        lines += [f"}} else if (t - m->last > {int64(5 * period // 2)}) {{"]
        lines += ["    m->since = t; /* a gap: windows fill again */"]
    lines += ["}", "m->last = t;", *(["age = t - m->since;"] if windows else [])]
    lines += [*step.statements(), ""]
    for k, (result, hazard) in enumerate(zip(model.program.results, _hazards(model), strict=True)):
        value = step.value(result.operation)
        about = f" /* {c_comment(result.about)} */" if result.about else ""
        published = f"publish(&m->events[{k}], {value}, {hazard});{about}"
        lines += [f"m->value = {value};" if model.numeric else published]
    return _block([*lines, *([] if back == "return;" else [back])])


def _main(model: StandaloneMonitor) -> str:
    name, period = model.name, model.program.period or 10**9
    stubs, declared, read, arguments = "", [], [], ["t"]
    for k, (word, variable) in enumerate(zip(model.variables, model.program.reads, strict=True)):
        unknown, stamped = _UNKNOWN[variable.type], variable.stamped
        # The unused stamp stands outside of the region: a body need not use it.
        unused = ["    (void)stamp; /* set *stamp when the sample is not from now */"]
        parameter = "int64_t *stamp" if stamped else "void"
        lines = [
            f"/* {model.describe(k)}; {unknown} is UNKNOWN. */",
            f"static {_declared(variable, f'read_{word}')}({parameter})",
            *("{", *(unused if stamped else [])),
            *region(f"variable:{variable.name}", [f"    return {unknown};"], c=True, indent="    "),
        ]
        stubs += _block([*lines, "}", ""], 0)
        declared += [f"int64_t stamp_{word};"] if stamped else []
        declared += [f"{_declared(variable, f'v_{word}')};"]
        read += [f"stamp_{word} = t;"] if stamped else []
        read += [f"v_{word} = read_{word}({f'&stamp_{word}' if stamped else ''});"]
        arguments += [f"v_{word}", *([f"stamp_{word}"] if stamped else [])]
    results = ['printf("%.17g\\n", monitor.value);'] if model.numeric else []
    pairs = zip(model.events, model.program.results, strict=True)
    for k, (event, result) in enumerate(() if model.numeric else pairs):
        for what in ("raised", "cleared"):
            body = region(f"{what}:{result.id}", ["    (void)t_ns;"], c=True, indent="    ")
            head = [f"static void on_{what}_{event}(int64_t t_ns)", "{"]
            stubs += _block([*head, *body, "}", ""], 0)
            results += [f"if (monitor.events[{k}].{what}) {{ on_{what}_{event}(t); }}"]
        results += [f'printf("{event} %d\\n", (int)monitor.events[{k}].verdict);']
    clock = [
        "    /* A real program waits for its monotonic clock here. */",
        f"    *t_ns += {int64(period)};",
        f"    return *t_ns < {int64(10 * period)};",
    ]
    return filled(
        "main.c",
        banner=_banner(model, "1. Variables, 4. Main: edit between the markers only"),
        name=name,
        kind=model.kind,
        stubs=stubs,
        next_step=_block(region("main:next_step", clock, c=True, indent="    "), 0),
        declared=_block(declared),
        read=_block(read, 8),
        arguments=", ".join(arguments),
        results=_block(results, 8),
    )
