"""The oracle: the compiled machine of each EDDI plays every case, step by step."""

from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from eddi_scaffold.kinds.state_machine.options import input_id
from eddi_scaffold.kinds.state_machine.state_machine_model import StateMachineModel
from tests.kinds.state_machine.machines import (
    DATA,
    configured,
    machine_of,
    options_of,
    running,
)

CASES = yaml.load((DATA / "oracle.yml").read_text("utf-8"), yaml.CSafeLoader)["cases"]
TRUTH = {"F": False, "U": float("nan"), "T": True}  # what is no truth value is unknown
MESSAGES = {"F": [], "U": [None], "T": [True]}


def configured_case(case: dict[str, Any]) -> StateMachineModel:
    """Return the configured machine of a case."""
    model, config = machine_of(DATA / f"{case['model']}.emf.xml"), case["config"]
    steps = case["steps"]
    observed = dict.fromkeys(state for step in steps for state in step.get("observe", ()))
    values: dict[str, Any] = {"start": config.get("start", "initial"), "reset": "reset_now"}
    values["observe"] = {state: f"in_{input_id(state)}" for state in observed}
    values["triggers"] = {text: {"absent": True} for text in config.get("absent", ())}
    values["evidence"] = [
        {**entry, **({"hold": f"{entry['hold']} s"} if "hold" in entry else {})}
        for entry in config["evidence"]
    ]
    if "max_gap" in config:
        values["max_gap"] = f"{config['max_gap']} s"
    inputs = dict.fromkeys([*values["observe"].values(), "reset_now"], "bool")
    return configured(model, options_of(values, inputs, 1 / config["period"]))[0]


def monitor_of(case: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Return the monitor of a case, and its inputs before any message has come."""
    model = configured_case(case)
    given = {one.id: [] if one.every_message else None for one in model.inputs()}
    return running(model), given


def play(case: dict[str, Any]) -> list[dict[str, Any]]:
    monitor, given = monitor_of(case)
    orders = [name for name, value in given.items() if value == []]
    played = []
    last = None
    for step in case["steps"]:
        before, given = given, given | {name: [] for name in orders}
        values = {input_id(name): value for name, value in step.get("in", {}).items()}
        values["reset_now"] = step.get("reset", "F")
        values |= {f"in_{input_id(name)}": of for name, of in step.get("observe", {}).items()}
        given |= {
            name: (MESSAGES if name in orders else TRUTH)[value] for name, value in values.items()
        }
        t = step["t"]
        given, last = before if t == last else given, t  # at the time of the last step none counts
        output = monitor.execute_step(SimpleNamespace(**given), round(t * 1e9))
        texts = {True: [], False: []}
        for action in output.raised:
            text = f"{action.moment} {action.state}: {action.kind} {action.text}"
            texts[action.certain].append(text)
        played.append(
            {
                "possible": list(output.possible),
                "state": output.state or None,
                "failed": "FUT"[output.failed],
                "since": pytest.approx(t - output.since_seconds, abs=1e-6),
                "raised": texts[True],
                "maybe": sorted(texts[False]),
                "evidence": dict(output.evidence),
                "reason": list(output.reasons),
            }
        )
    return played


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_it_plays_the_case(case: dict[str, Any]) -> None:
    wanted = [step["want"] for step in case["steps"]]
    for played, want in zip(play(case), wanted, strict=True):
        assert want == {**played, "reason": want["reason"]}
        assert sorted(played["reason"]) == sorted(want["reason"])
