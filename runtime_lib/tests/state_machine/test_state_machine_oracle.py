"""Every case of the oracle: inputs as a robot's messages leave them, steps of the monitor."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from .machines import SECOND, VALUES, models, monitor, oracle, result

CASES = {case["id"]: case for case in oracle("oracle")["cases"]}


@pytest.mark.parametrize("name", CASES)
def test_case(name):
    case = CASES[name]
    model = models()[case["model"]]
    made, held, last = monitor(model, case["config"]), {}, None
    momentary = {k for k, one in model.get("triggers", {}).items() if one.get("momentary")}
    for step in case["steps"]:
        given = {text: VALUES[letter] for text, letter in step.get("in", {}).items()}
        for text in momentary:  # the messages since the last step
            given[text] = [given[text]] if text in given else []
        seen = {f"observed {k}": VALUES[letter] for k, letter in step.get("observe", {}).items()}
        reset = {"reset": VALUES[step.get("reset", "F")]}
        now = {**held, **given, **seen, **reset}
        held = held if step["t"] == last else now  # what came in between had gone again
        last = step["t"]
        output = made.execute_step(SimpleNamespace(**now), round(step["t"] * SECOND))
        assert result(output, step["t"]) == step["want"]


def test_all_cases_are_there():
    assert (len(CASES), sum(len(case["steps"]) for case in CASES.values())) == (83, 362)
