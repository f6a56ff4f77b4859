"""The runtime agrees with the shared oracle, by way of the generator's reader and model data."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from eddi_scaffold.kinds.consert.compile import STRAIGHT_LINE_LIMIT
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.options import ConSertOptions
from tests.kinds.consert.example import as_source, monitor_of, oracle


def monitor(name, limit=STRAIGHT_LINE_LIMIT, options=None):
    (model,) = ConSertModel.read_file(as_source(oracle()["models"][name], f"{name}.yml"), ()).models
    return monitor_of(model, limit, options)[0]


def active(rows):
    return [row["id"] for row in rows if row["active"]]


@pytest.mark.parametrize("limit", [STRAIGHT_LINE_LIMIT, 0])
def test_every_step_of_every_scenario(limit):
    steps = 0
    for scenario in oracle()["evaluate"]:
        options = ConSertOptions(filter="majority", filter_steps=scenario["window"])
        made = monitor(scenario["model"], limit, options)
        for step in scenario["steps"]:
            found = active(made.execute_step(SimpleNamespace(**step["in"])))
            assert found == step["active"], (scenario["id"], step)
            steps += 1
    assert steps == 320


def test_window_one_needs_no_filter():
    for scenario in oracle()["evaluate"]:
        if scenario["window"] == 1:
            made = monitor(scenario["model"])
            for step in scenario["steps"]:
                assert active(made.execute_step(SimpleNamespace(**step["in"]))) == step["active"]


GOOD = {
    "a": True, "b": True, "c": "low", "n": 5.0, "d": True, "RtE_A_E0": True,
    "InstallationApproved": True, "S1_Unoccupied": True,
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "guarantee", "true", "missing", "losses"),
    [
        ("ConSertA", "System_A_G1", "", "RtE_A_D0 RtE_A_E0", ""),
        ("ConSertA", "System_A_G1", "RtE_A_E0", "RtE_A_D0", ""),
        ("OrNest", "G_nest", "", "d, a c n, b c n", ""),
        ("OrNest", "G_nest", "a n", "c, d", ""),
        ("OrNest", "G_nest", "a c n", "", "a c n"),
        ("OrNest", "G_nest", "a b c n", "", "c n"),
        ("OrNest", "G_nest", "a b c d n", "", ""),
        (
            "FabOS_Scanner2", "UnoccupiedShort", "InstallationApproved S1_Unoccupied",
            "MultiEvaluation4 S2_Unoccupied", "",
        ),
    ],
)  # fmt: skip
def test_explanations(name, guarantee, true, missing, losses):
    made = monitor(name)
    made.execute_step(SimpleNamespace(**{one: GOOD[one] for one in true.split()}))
    found = made.explain(guarantee)
    assert found.missing == tuple(tuple(group.split()) for group in missing.split(", ") if group)
    assert found.single_losses == tuple(losses.split())
    assert found.active == (not missing)


def test_every_model_that_the_generator_accepts_is_accepted_here():
    accepted = 0
    for case in oracle()["parse"]:
        reading = ConSertModel.read_file(as_source(case.get("doc", case.get("text"))), ())
        if any(problem.level == "error" for problem in reading.problems):
            continue
        for model in reading.models:
            made, _ = monitor_of(model)
            assert active(made.execute_step(None)) == [
                g.id for g in model.data.guarantees if g.default
            ]
            accepted += 1
    assert accepted > 10
