"""The intermediate form: what is damaged is refused, and no name becomes code."""

from __future__ import annotations

import json

import pytest

from eddi_scaffold.compiling.document import ModelError
from eddi_scaffold.compiling.expressions.engine import build_engine
from eddi_scaffold.compiling.expressions.form import read_form
from eddi_scaffold.compiling.program.instructions import reads_of_results
from runtime_lib.tests.event.event_models import SECOND, form


def damaged(**changes):
    found = form(("gt", ("max", "x", 3), 5))
    for path, value in changes.items():
        target, *keys = path.split("__")
        holder = found
        steps = [target, *keys]
        for step in steps[:-1]:
            holder = holder[int(step) if step.isdigit() else step]
        holder[int(steps[-1]) if steps[-1].isdigit() else steps[-1]] = value
    return found


@pytest.mark.parametrize(
    "changes",
    [
        {"version": 2},
        {"period": -1},
        {"period": 1 << 63},
        {"period": 0},
        {"period": 1.5},
        {"nodes": []},
        {"outputs": []},
        {"nodes__0__op": "exec"},
        {"nodes__0__value": 99},
        {"nodes__1__args": [5]},
        {"nodes__1__args": [True]},
        {"nodes__1__window": 0},
        {"nodes__1__window": SECOND - 1},
        {"nodes__1__capacity": 1 << 40},
        {"nodes__1__coverage": "1"},
        {"nodes__2__value": "import os"},
        {"nodes__2__value": float("inf")},
        {"nodes__3__args": [0]},
        {"nodes__3__at": "here"},
        {"variables__0__type": "text"},
        {"variables__0__range": [1]},
        {"variables__0__timeout": 0},
        {"variables__0__literals": [1]},
        {"outputs__0__node": 77},
    ],
)
def test_what_is_damaged_is_refused(changes):
    with pytest.raises(ModelError):
        read_form(damaged(**changes))


def test_no_word_of_a_form_becomes_code():
    evil = '"); import os; os.abort() #'
    found = form(("gt", "x", 5), ("eq_enum", "m", ("literal", 0)), variables=("x", "m"))
    found["variables"][0]["name"] = evil
    found["variables"][1]["literals"] = [evil]
    found["outputs"][0]["id"] = evil
    engine = build_engine(found)
    assert engine.step(0, [6.0, evil]) == (2, 2)
    assert engine.step(1, [4.0, "else"]) == (0, 1)


def test_a_form_survives_json():
    found = form(("and", ("time", "a", 2), ("lt", ("age", "x"), 5.5)))
    assert read_form(json.loads(json.dumps(found))) == read_form(found)


def test_which_reads_decide_a_result():
    read = read_form(form(("gt", "x", 5), ("or", "a", ("gt", ("age", "y"), 1))))
    assert reads_of_results(read) == [[0], [1, 2]]
