"""Conditions by definition: verdicts of an independent program, and samples that tell changes."""

import math
import random
from pathlib import Path
from typing import Any

import pytest
import yaml

from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.definition import History, Sample
from eddi_scaffold.conditions.samples import Drawing
from eddi_scaffold.program.instructions import Program
from eddi_scaffold.program.running import Engine
from tests.conditions.test_agreement import IN_NUMBERS, batches
from tests.conditions.test_lists import DECLARATIONS, formula, sample

DATA = Path(__file__).parents[1] / "data" / "evidence" / "events.yml"
CASES = {case["id"]: case for case in yaml.safe_load(DATA.read_text("utf-8"))}
LETTERS = {True: "T", False: "F", None: "U"}


def program_of(text: str, rate: float) -> Program:
    program = analyse(text, rate=rate).program
    assert program is not None
    return program


def text_of_form(form: Any) -> str:
    """Return a condition in prefix form as text; windows are in ms."""
    if not isinstance(form, list):
        return str(form)
    op, *args = form
    if op in ("average", "max", "min", "sum", "time", "once"):
        return f"{op}({text_of_form(args[0])}, {args[1]}ms)"
    texts = [text_of_form(arg) for arg in args]
    return f"(not {texts[0]})" if op == "not" else f"({texts[0]} {op} {texts[1]})"


@pytest.mark.parametrize("name", CASES)
def test_verdicts_and_changes_are_those_of_the_definition(name: str) -> None:
    case = CASES[name]
    head, _, _ = case["text"].rpartition("EVENT e := ")
    rate, inputs = 1000 / case["period_ms"], case["inputs"]
    samples = [
        Sample(t * 10**6, dict(zip(inputs, row, strict=True)), {}) for t, *row in case["samples"]
    ]

    def verdicts(program: Program) -> str:
        return "".join(LETTERS[verdict] for (verdict,) in History(program, samples).results())

    program = program_of(case["text"], rate)
    assert verdicts(program) == case["verdicts"]
    runs = [*Drawing(program, 0).runs()]
    for mutant in case["mutants"]:
        changed = program_of(f"{head}EVENT e := {text_of_form(mutant['form'])}", rate)
        assert verdicts(changed) == mutant["verdicts"]
        histories = ((History(changed, run.steps), run) for run in runs)
        assert any(
            value != other
            for history, run in histories
            for (value,), other in zip(history.results(), run.results, strict=True)
        ), mutant["change"]


def test_random_lists_are_by_definition() -> None:
    rng = random.Random(3)
    for _ in range(100 * batches()):
        text = formula(rng)
        program = program_of(f"{DECLARATIONS}\n{text}", 10)
        engine, raws = Engine(program), sample(rng)
        ((value,),) = History(program, [Sample(0, raws, {})]).results()
        (result,) = engine.step(0, [raws.get(input_.name) for input_ in engine.sampling.inputs])
        if program.operations[program.results[0].operation].type == "bool":
            assert result == IN_NUMBERS[value], text
        else:
            assert (math.isnan(result) and value is None) or result == value, text
