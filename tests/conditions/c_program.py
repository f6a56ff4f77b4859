"""Generated C, compiled with everything that the compiler can complain of, and run on steps."""

import math
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from eddi_runtime import expressions

from eddi_scaffold.program.c_files import c_files
from eddi_scaffold.program.instructions import Program, Read
from eddi_scaffold.program.standalone import StandaloneMonitor
from tests.conditions.formulas import Step
from tests.data_files import write_files

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wshadow")
FLAGS = ["-std=c99", "-pedantic", *WARNINGS, "-ffp-contract=off"]
SANITIZE = ["-fsanitize=undefined,address", "-fno-sanitize-recover=all", "-g"]


def compiler() -> str:
    result = shutil.which("gcc") or shutil.which("cc")
    if result is None:
        pytest.skip("there is no C compiler on this machine")
    return result


def build(model: StandaloneMonitor, folder: Path, *options: str) -> Path:
    """Compile a monitor with a main program that reads steps; return the program."""
    write_files(folder, {**c_files(model), "harness.c": harness(model)})
    program = folder / "program"
    sources = [folder / f"{model.name}_event.c", folder / "harness.c"]
    compile_c([*options, *map(str, sources), "-o", str(program), "-lm"])
    return program


def compile_c(arguments: Sequence[str]) -> None:
    done = subprocess.run(
        [compiler(), *FLAGS, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[:4000]


def harness(model: StandaloneMonitor) -> str:
    arguments, reads = ["t"], []
    for k, variable in enumerate(model.program.reads):
        kind, form = ("double", "%la") if variable.type == "number" else ("int", "%d")
        reads.append((f"    {kind} v{k};", f'scanf("{form}", &v{k}) == 1'))
        arguments.append(f"v{k}")
        if variable.stamped:
            reads.append((f"    int64_t s{k};", f'scanf("%" SCNd64, &s{k}) == 1'))
            arguments.append(f"s{k}")
    n = model.name
    shown = [
        f'        printf("%d ", (int)m.events[{k}].verdict);' for k in range(len(model.events))
    ]
    if model.numeric:
        shown = ['        printf("%a", m.value);']
    condition = " && ".join(['scanf("%" SCNd64, &t) == 1', *(read for _, read in reads)])
    return "\n".join(
        [
            f'#include "{n}_event.h"',
            "#include <inttypes.h>",
            "#include <stdio.h>",
            f"static {n}_t m;",
            "int main(void)",
            "{",
            "    int64_t t;",
            *(declared for declared, _ in reads),
            f"    {n}_reset(&m);",
            f"    while ({condition}) {{",
            f"        (void){n}_step(&m, {', '.join(arguments)});",
            *shown,
            '        printf("\\n");',
            "    }",
            "    return 0;",
            "}",
            "",
        ]
    )


def clean(form: Program, step: Step) -> list[object]:
    """Return the arguments of ``evaluate`` behind the time."""
    result: list[object] = []
    for variable in form.reads:
        result.append(_converted(variable, step.values.get(variable.name)))
        if variable.stamped:
            result.append(step.stamps.get(variable.name, step.t))
    return result


def run(program: Path, form: Program, steps: Sequence[Step]) -> list[str]:
    """Return the line that the program prints for each step."""
    lines = []
    for step in steps:
        cells = [
            value.hex() if isinstance(value, float) else str(value) for value in clean(form, step)
        ]
        lines.append(" ".join([str(step.t), *cells]))
    done = subprocess.run(
        [str(program)], input="\n".join(lines) + "\n", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[:4000]
    return [line.strip() for line in done.stdout.split("\n")[:-1]]


def as_number(text: str) -> float:
    return math.nan if "nan" in text else float.fromhex(text)


def _converted(variable: Read, raw: object) -> float | int:
    """Return what the text of a package makes of a raw value."""
    if variable.type == "enum":
        return expressions.literal(raw, variable.literals)
    return expressions.truth(raw) if variable.type == "bool" else expressions.number(raw)
