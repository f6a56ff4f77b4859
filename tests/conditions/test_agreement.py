"""Reference = engine in this process = generated Python = generated C, on random events."""

import math
import random
from pathlib import Path

import pytest
from hypothesis import settings

from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.standalone import monitor_model
from eddi_scaffold.program.running import Engine
from eddi_scaffold.program.standalone_python import python_module
from tests.conditions import c_program
from tests.conditions.formulas import DECLARATIONS, RATE, Formulas, Step, recording
from tests.conditions.reference import by_definition

BATCH, STEPS = 50, 80
IN_NUMBERS = {True: 2, False: 0, None: 1}


def batches() -> int:
    """Return how many batches of formulas are tried: 1,500 formulas in the long profile."""
    return 30 if settings.default.max_examples > 1000 else 2


def text_of(seed: int, *, monotone: bool = False, count: int = BATCH) -> str:
    rng = random.Random(seed)
    formulas = Formulas(rng, monotone)
    events = [
        f"EVENT e{k} (EVIDENCE) := {formulas.boolean(rng.randint(1, 3))}" for k in range(count)
    ]
    return DECLARATIONS + "\n".join(events)


def analysis_of(text: str) -> Analysis:
    result = analyse(text, rate=RATE)
    assert [problem for problem in result.problems if problem.level == "error"] == []
    assert result.program is not None
    return result


def python_engine(analysis: Analysis) -> object:
    ((name, text),) = python_module(monitor_model(analysis, "batch")).items()
    names: dict[str, object] = {"__name__": "batch_event"}
    exec(compile(text, name, "exec", dont_inherit=True), names)
    return names["Engine"]()


def compare(text: str, steps: list[Step], c_lines: list[list[int]]) -> tuple[int, int]:
    """Compare all ways on one recording; return (verdicts compared, verdicts left out as ties)."""
    analysis = analysis_of(text)
    form = analysis.program
    engine, python = Engine(analysis.program), python_engine(analysis)
    defined = by_definition(text, steps)
    expressions = {event.id: event.canonical for event in analysis.events}
    compared = ties = 0
    for number, step in enumerate(steps):
        values = [step.values[variable.name] for variable in form.reads]
        stamps = [step.stamps.get(variable.name) for variable in form.reads]
        result = engine.step(step.t, values, stamps)
        generated = python.evaluate(step.t, *c_program.clean(form, step))
        assert generated == result, number
        assert list(result) == c_lines[number], number
        for k, output in enumerate(form.results):
            expected, other = defined[number][k]
            if expected is not other:
                ties += 1
                continue
            compared += 1
            assert result[k] == IN_NUMBERS[expected], (
                f"step {number} at {step.t}: {expressions[output.id]}"
            )
    return compared, ties


def test_random_events_agree(tmp_path: Path) -> None:
    compared = ties = 0
    for seed in range(batches()):
        text = text_of(seed)
        analysis = analysis_of(text)
        form = analysis.program
        program = c_program.build(monitor_model(analysis, f"batch{seed}"), tmp_path / str(seed))
        steps = recording(random.Random(1000 + seed), STEPS)
        lines = [
            [int(cell) for cell in line.split()] for line in c_program.run(program, form, steps)
        ]
        more = compare(text, steps, lines)
        compared, ties = compared + more[0], ties + more[1]
    assert compared >= 0.97 * (compared + ties)


def test_known_verdicts_survive_more_knowledge() -> None:
    """A verdict that is known stays, whatever UNKNOWN inputs had been (section 2)."""
    known = 0
    for seed in range(batches() * 4):
        text = text_of(9000 + seed, monotone=True, count=30)
        analysis = analysis_of(text)
        rng = random.Random(seed)
        steps = recording(rng, STEPS)
        less, more = Engine(analysis.program), Engine(analysis.program)
        for step in steps:
            hidden = {n: None if rng.random() < 0.2 else v for n, v in step.values.items()}
            names = [variable.name for variable in analysis.variables]
            stamps = [step.stamps.get(name) for name in names]
            entry = less.step(step.t, [hidden[name] for name in names], stamps)
            other = more.step(step.t, [step.values[name] for name in names], stamps)
            for output, a, b in zip(analysis.events, entry, other, strict=True):
                if a != 1:
                    known += 1
                    assert a == b, output.canonical
    assert known > 1000


@pytest.mark.parametrize("function", ["AVERAGE", "SUM", "MAX", "MIN", "MEDIAN", "STDDEV", "RATE"])
@pytest.mark.parametrize("coverage", ["", ", COVERAGE 0.5"])
def test_numbers_of_windows_agree(function: str, coverage: str, tmp_path: Path) -> None:
    text = f"{DECLARATIONS}{function}(x, 1.3s{coverage})"
    analysis = analysis_of(text)
    form = analysis.program
    program = c_program.build(monitor_model(analysis, "number"), tmp_path, "-O1")
    engine = Engine(analysis.program)
    steps = [step for seed in range(5) for step in recording(random.Random(seed), STEPS)]
    lines = c_program.run(program, form, steps)
    for step, line, ((low, high),) in zip(steps, lines, by_definition(text, steps), strict=True):
        (result,) = engine.step(step.t, [step.values["x"]], [None])
        in_c = c_program.as_number(line)
        assert (result == in_c) or (math.isnan(result) and math.isnan(in_c))
        if low is None:
            assert math.isnan(result)
        else:
            assert low - 1e-12 <= result <= high + 1e-12
