"""A ConSert in C99: the verdicts of its Python monitor, whatever is unknown or too old."""

import itertools
import json
import math
import random
import subprocess
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import Place
from eddi_scaffold.conditions.analysis import ExpressionText, compile_input
from eddi_scaffold.conditions.c_vectors import vectors_of_consert
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    CategoricalDimension,
    NumericDimension,
)
from eddi_scaffold.program.c_files import c_files
from eddi_scaffold.program.standalone import keep_in_folder, named
from runtime_lib.tests.conserts import binary, categorical, consert, give, numeric
from tests.conditions.c_program import SANITIZE, compile_c
from tests.data_files import write_files

TEXTS = ["low", "mid", 'é ??/ "\\', "a\0b"]
VALUES = {
    "numeric": [math.nan, math.inf, -math.inf, 0.0, -0.0, 4.999, 5.0, 7.0, 1.0, 2.0, 6.0, 3, None],
    "categorical": [*TEXTS[:3], "a", "", "lo", None],
    "binary": [True, True, False, None],
}
SETTINGS = ({}, {}, {"filtered": ("debounce", 2)}, {"filtered": ("majority", 3)})
KINDS = {
    BinaryDimension: "binary",
    NumericDimension: "numeric",
    CategoricalDimension: "categorical",
}
PERIOD = 10**8
OLD = 0.25
"""Seconds that the first three inputs may be old."""


def random_consert(rng, settings):
    """Return a ConSert and the kinds of its inputs; each gate reads two to four before it."""
    dimensions = [
        binary(),
        numeric("[0, 5)", "[7, inf]"),
        categorical(*TEXTS),
        numeric("[3, 6]"),
        numeric(),
    ]
    evidence = [(f"in {k}", rng.choice(dimensions)) for k in range(10)]
    ids = [name for name, _ in evidence] + ["d0", "d1"]
    specs = {name: {"attribute": f"a{k}"} for k, name in enumerate(ids)}
    specs.update({name: {**specs[name], "max_age": OLD} for name in ids[:3]})
    gates, edges = [], []
    for k in range(12):
        before = [*ids, *(f"g{i}" for i in range(k))]
        edges += [(one, f"g{k}") for one in rng.sample(before, rng.randint(1, 4))]
        gates.append(f"g{k}{rng.choice('&|')}")
    edges += [("g11", "G"), ("g10", "H"), ("g9", "H"), (ids[0], "I")]
    guarantees = ["G", "H", "I", {"id": "default", "default": True}]
    made = consert(evidence, ["d0", "d1"], gates, guarantees, edges, specs=specs, **settings)
    return made, [KINDS[type(of)] for _, of in evidence] + ["binary"] * 2


def in_c(value, kind):
    if value is None:
        return {"binary": "1", "numeric": "NAN", "categorical": "NULL"}[kind]
    if isinstance(value, str):
        return '"' + "".join(f"\\{one:03o}" for one in value.encode()) + '"'
    if isinstance(value, bool):
        return "2" if value else "0"
    special = {math.inf: "(double)INFINITY", -math.inf: "-(double)INFINITY"}
    return "NAN" if math.isnan(value) else special.get(value, float(value).hex())


def verdicts_in_c(folder, played):
    """Return what a program prints that calls the steps of models with arguments."""
    main, calls, sources = [], [], [folder / "main.c"]
    for model, steps in played:
        write_files(folder, c_files(model))
        sources.append(folder / f"{model.name}_consert.c")
        monitor = f"s_{model.name}"
        main += [f'#include "{model.name}_consert.h"', f"static {model.name}_t {monitor};"]
        calls += [f"{model.name}_reset(&{monitor});"]
        for arguments in steps:
            calls += [f"(void){model.name}_step(&{monitor}, {', '.join(arguments)});"]
            for k in range(len(model.events)):
                calls += [f'printf("%d ", (int){monitor}.events[{k}].verdict);']
            calls += ['printf("\\n");']
    main += ["#include <math.h>", "#include <stdio.h>"]
    main += ["int main(void)", "{", *calls, "return 0;", "}", ""]
    sources[0].write_text("\n".join(main))
    compile_c([*SANITIZE, *map(str, sources), "-o", str(folder / "program"), "-lm"])
    done = subprocess.run([str(folder / "program")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    return [list(map(int, line.split())) for line in done.stdout.splitlines()]


def verdicts_of(monitor, values):
    monitor.execute_step(give(**values))
    return [("FALSE", "UNKNOWN", "TRUE").index(one) for one in monitor.verdicts().values()]


def test_c_agrees_with_the_compiled_python(tmp_path: Path) -> None:
    rng = random.Random(1)
    played, wanted = [], []
    for number, settings in enumerate(SETTINGS):
        made, kinds = random_consert(rng, settings)
        program = made.compiled().program
        monitor, steps = made.monitor(), []
        for step in range(200):
            t = step * PERIOD
            values = [rng.choice(VALUES[kind]) for kind in kinds]
            stamps = [t - rng.choice([0, PERIOD, 2 * PERIOD, 3 * PERIOD]) for _ in range(3)]
            ages = itertools.chain((t - one for one in stamps), itertools.repeat(0))
            known = [v if age <= OLD * 1e9 else None for v, age in zip(values, ages)]  # noqa: B905
            wanted.append(verdicts_of(monitor, {f"a{k}": one for k, one in enumerate(known)}))
            arguments = [str(t)]
            for k, (value, kind) in enumerate(zip(values, kinds, strict=True)):
                arguments += [in_c(value, kind), *([str(stamps[k])] if k < 3 else [])]
            steps.append(arguments)
        played.append((named(program, f"m{number}", ["a ConSert"], kind="consert"), steps))
    assert verdicts_in_c(tmp_path, played) == wanted
    assert {verdict for row in wanted for verdict in row} == {0, 1, 2}


@pytest.mark.parametrize("settings", SETTINGS[1:])
def test_vectors_tell_a_changed_consert(settings, tmp_path: Path) -> None:
    made = consert(
        evidence=["a", ("b", binary(good=False)), ("n", numeric("[0, 10]", "[20, 30)"))],
        demands=["d"],
        gates=["and1&", "or1|"],
        guarantees=["G"],
        edges=["a>and1", "b>and1", "n>and1", "and1>or1", "d>or1", "or1>G"],
        specs={"a": {"max_age": OLD, "requires": ["a"]}},
        **settings,
    )
    model = named(made.compiled().program, "demo", ["a ConSert"], kind="consert")
    files = c_files(model) | vectors_of_consert(
        model, json.loads(made.model.vectors(made.declaration.inputs, {}))
    )
    steps = dict([settings["filtered"]] if settings else [])
    changes = {
        "": "",
        " = least(r": " = greatest(r",
        " = greatest(r": " = least(r",
        "2 - v_b": "v_b",
        "INT64_C(250000000)": "INT64_C(250000001)",
        "v_n < 30.0": "v_n <= 30.0",
        "20.0 <= v_n": "20.000000000000004 <= v_n",
        "isnan(v_n)": "v_n > 1e300",
    }
    changes |= {f" {n}u": f" {n + 1}u" for n in steps.values()}
    for before, after in changes.items():
        head, body = files["demo_consert.c"].split("demo_step(", 1)
        assert before in body, before
        changed = f"{head}demo_step({body.replace(before, after)}"
        write_files(tmp_path, files | {"demo_consert.c": changed})
        sources = [str(tmp_path / name) for name in ("demo_consert.c", "demo_vectors.c")]
        compile_c([*sources, "-Wno-unused-function", "-o", str(tmp_path / "demo"), "-lm"])
        done = subprocess.run([str(tmp_path / "demo")], capture_output=True, text=True, check=False)
        assert (done.returncode == 0) == (before == ""), (before, done.stdout[:500])


def test_expressions_of_inputs_are_part_of_the_program(tmp_path: Path) -> None:
    words = ("motor", "pump")
    texts = {
        "evidence": ("bool", "EVIDENCE", "ONCE(motor.data > 3, 300ms) AND pump.ok"),
        "hazard": ("bool", "HAZARD", "TIME(pump.ok, 200ms)"),
        "number": ("float", "EVIDENCE", "AVERAGE(motor.data, 300ms) - motor.data"),
    }
    specs = {}
    for name, (kind, polarity, text) in texts.items():
        one = ExpressionText(text, lambda _: Place())
        found, _ = compile_input([one], kind, rate=10, variables=None, polarity=polarity)
        expression = {**found.document, "names": {word: ["message", word] for word in words}}
        specs[name] = {"expression": expression, "requires": [*words], "max_age": OLD}
    evidence = [("evidence", binary()), ("hazard", binary()), ("number", numeric("[0, 1]"))]
    ids = [name for name, _ in evidence]
    made = consert(evidence, guarantees=list("GHI"), edges=zip(ids, "GHI"), specs=specs)  # noqa: B905
    program = made.compiled().program
    assert [one.name for one in program.reads] == ["motor.data", "pump.ok"]
    monitor = made.monitor()
    expressions = [spec.expression() for spec in monitor.inputs]
    rng = random.Random(2)
    messages, sent, steps, wanted = {}, {}, [], []
    for step in range(400):
        t = step * PERIOD
        for word in words:
            if rng.random() < 0.6 or word not in sent:
                value = {"data": rng.choice([*VALUES["numeric"][:1], 2.5, 3.5, 4.0])}
                messages[word] = give(ok=rng.random() < 0.9, **value)
                sent[word] = t - rng.choice([0, PERIOD])
        ages = {word: (t - sent[word]) / 1e9 for word in words}
        fresh = {word: messages[word] for word in words if ages[word] <= OLD}
        values = [one.value(t, fresh, ages) for one in expressions]
        wanted.append(verdicts_of(monitor, dict(zip(ids, values, strict=True))))
        motor = [in_c(messages["motor"].data, "numeric"), str(sent["motor"])]
        steps.append([str(t), *motor, in_c(messages["pump"].ok, "binary"), str(sent["pump"])])
    model = named(program, "whole", ["a ConSert"], kind="consert")
    assert verdicts_in_c(tmp_path, [(model, steps)]) == wanted
    assert [{row[k] for row in wanted} for k in range(3)] == [{0, 1, 2}, {0, 2}, {0, 1, 2}]


def test_no_text_of_a_model_is_code_or_a_marker(tmp_path: Path) -> None:
    ids = [
        *TEXTS,
        "*/ int x;",
        "??/",
        "\\",
        "a\nb",
        "%d",
        "",
        "int",
        "// -----Manual edit end-----",
    ]
    made = consert(
        [(one, categorical(*ids)) for one in ids],
        guarantees=[f"G {one}" for one in ids],
        edges=[(one, f"G {one}") for one in ids],
        specs={one: {"attribute": f"a{k}"} for k, one in enumerate(ids)},
    )
    model = named(made.compiled().program, "odd", ids, kind="consert")
    files = c_files(model)
    write_files(tmp_path, files)
    assert keep_in_folder(files, tmp_path) == (files, [])
    sources = [str(tmp_path / name) for name in files if name.endswith(".c")]
    compile_c([*sources, "-o", str(tmp_path / "odd"), "-lm"])
