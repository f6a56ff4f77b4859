"""The oracle file: every entry, for the runtime types, the engine, the Python and the C target."""

import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER, Variable
from eddi_scaffold.conditions.standalone import monitor_model
from eddi_scaffold.conditions.syntax import canonical
from eddi_scaffold.conditions.tokens import TextFindings, in_text
from eddi_scaffold.program.running import Engine, module_of
from eddi_scaffold.program.standalone_python import python_module
from tests.conditions import c_program
from tests.conditions.formulas import Step
from tests.data_files import data_file

TYPES = {"num": NUMBER, "bool": BOOL}
TRUTH = {"F": 0, "U": 1, "T": 2}
MONITOR: Any = module_of(*python_module(monitor_model(analyse("TRUE"), "m")).values(), "m")
BoolVal, NumVal = MONITOR.BoolVal, MONITOR.NumVal
WORDS = {"and": "AND", "or": "OR", "xor": "XOR", "equal": "==", "implies": "IMPLIES"}


@cache
def load(path: Path) -> Any:
    return yaml.load(path.read_text("utf-8"), yaml.CSafeLoader)


@pytest.fixture
def oracle() -> Any:
    return load(data_file("monitors/oracle_events.yml"))


def variables(types: dict[str, str]) -> dict[str, Variable]:
    return {name: Variable(name, TYPES[kind]) for name, kind in types.items() if kind in TYPES}


@pytest.mark.parametrize("word", [*WORDS, "not"])
def test_truth_tables(oracle: Any, word: str) -> None:
    text = "NOT a" if word == "not" else f"a {WORDS[word]} b"
    analysis = analyse(text, variables=variables({"a": "bool", "b": "bool"}))
    engine = Engine(analysis.program)
    raw = {"F": False, "U": None, "T": True}
    for case, result in oracle["truth_tables"][word].items():
        assert engine.step(0, [raw[c] for c in case]) == (TRUTH[result],)
        engine.reset()
        a, *rest = (BoolVal(raw[c]) for c in case)
        b = rest[0] if rest else BoolVal()
        table = {
            "and": lambda a, b: a & b,
            "or": lambda a, b: a | b,
            "xor": lambda a, b: a ^ b,
            "equal": lambda a, b: a.equals(b),
            "implies": lambda a, b: a.implies(b),
            "not": lambda a, _: ~a,
        }
        assert table[word](a, b).truth == TRUTH[result]


def by_types(op: str, item: Any, other: Any) -> Any:
    return {
        "input": lambda: item,
        "+": lambda: item + other,
        "-": lambda: item - other,
        "*": lambda: item * other,
        "/": lambda: item / other,
        ">": lambda: item > other,
        "==": lambda: item.equals(other),
    }[op]()


def test_arithmetic(oracle: Any) -> None:
    for case in oracle["arithmetic"]:
        a, b, op = case["a"], case.get("b"), case["op"]
        text = "x" if op == "input" else f"x {op} y"
        analysis = analyse(text, variables=variables({"x": "num", "y": "num"}))
        names = {"x": a, "y": b}
        (actual,) = Engine(analysis.program).step(0, [names[v.name] for v in analysis.variables])
        value = by_types(op, NumVal(a), NumVal(b))
        if isinstance(value, BoolVal):
            assert actual == value.truth == TRUTH[case["result"]]
        elif case["result"] is None:
            assert math.isnan(actual)
            assert not value.known
        else:
            assert actual == value.value == case["result"]


def test_precedence_and_canonical_form(oracle: Any) -> None:
    for case in oracle["precedence"]:
        findings = TextFindings(in_text(case["text"]))
        file = parse(case["text"], findings)
        actual = canonical(file, file.events[0].root)
        assert actual == case["parsed"]
        assert len(findings.problems) == case["warnings"]
        again = parse(actual)
        assert canonical(again, again.events[0].root) == actual


def test_errors(oracle: Any) -> None:
    known = variables({"x": "num", "y": "num", "a": "bool", "b": "bool"})
    for case in oracle["errors"]:
        if case["text"] == "AVERAGE(x, 5 s) > 1":  # a duration may have a blank since
            continue
        analysis = analyse(case["text"], rate=10, variables=known)
        problems = [problem for problem in analysis.problems if problem.level == "error"]
        assert [problem.place.col for problem in problems] == [case["column"]], case["text"]
        assert analysis.program is None


def traces() -> list[str]:
    return [trace["name"] for trace in load(data_file("monitors/oracle_events.yml"))["traces"]]


@pytest.mark.parametrize("name", traces())
def test_traces(oracle: Any, name: str, tmp_path: Path) -> None:
    trace = next(item for item in oracle["traces"] if item["name"] == name)
    analysis = analyse(
        trace["text"],
        rate=trace["rate"],
        variables=variables(trace["vars"]),
        declarations=trace.get("declare", ""),
    )
    form = analysis.program
    model = monitor_model(analysis, name)
    ((_, text),) = python_module(model).items()
    names: dict[str, Any] = {"__name__": "trace"}
    exec(compile(text, name, "exec", dont_inherit=True), names)
    engine, generated = Engine(analysis.program), names["Engine"]()
    steps = [
        Step(t, dict(zip(trace["vars"], values, strict=True)), {})
        for t, *values, _ in trace["steps"]
    ]
    lines = c_program.run(c_program.build(model, tmp_path), form, steps)
    for step, line, (*_, expected) in zip(steps, lines, trace["steps"], strict=True):
        (actual,) = engine.step(step.t, [step.values[v.name] for v in form.reads])
        (printed,) = generated.evaluate(step.t, *c_program.clean(form, step))
        if trace["type"] == "bool":
            assert actual == printed == int(line) == TRUTH[expected], step
        elif expected is None:
            assert math.isnan(actual), step
            assert math.isnan(printed)
            assert "nan" in line
        else:
            assert actual == printed == c_program.as_number(line)
            assert math.isclose(actual, expected, rel_tol=1e-9), step
