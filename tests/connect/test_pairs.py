"""Pairs of inputs and robots whose right answers people decided by reading."""

from collections.abc import Mapping
from typing import Any

import pytest
import yaml

from eddi_scaffold.connect.matching import Decision, Fulfilment, decide
from eddi_scaffold.connect.topics import InputNeed, RobotTopic
from eddi_scaffold.monitors.message_types import known_messages
from tests.data_files import data_file

_DATA: Mapping[str, Any] = yaml.load(
    data_file("connect/pairs.yml").read_text("utf-8"), yaml.CSafeLoader
)


@pytest.mark.parametrize("pair", _DATA["pairs"], ids=lambda pair: pair["id"])
def test_a_pair_is_taken_or_left_to_a_person(pair: Mapping[str, Any]) -> None:
    decision, answer = decided(pair), pair["answer"]
    listed = [one.topic.id for one in decision.candidates]
    if "take" in answer:
        assert (decision.state, listed[0]) == ("taken", answer["take"])
        assert decision.candidates[0].leaf.text == answer["field"]
    else:
        assert decision.state != "taken"
        assert set(answer.get("list", ())) <= set(listed)


def decided(pair: Mapping[str, Any]) -> Decision:
    robot, given = _DATA["robots"][pair["robot"]], dict(pair["input"])
    provided = given.pop("provided_by", {})
    types = {**known_messages(), **robot.get("types", {})}
    need = InputNeed(is_demand=given.pop("demand", False), **given)
    topics = (
        robot.get("topics")
        or yaml.load(data_file(robot["outputs"]).read_text("utf-8"), yaml.CSafeLoader)[
            "SimulatorOutputs"
        ]
    )
    found = [RobotTopic(one["id"], one["type"].replace(".", "/"), one["topic"]) for one in topics]
    offers = [
        Fulfilment(
            next(one for one in found if one.id == id_), f"guarantees[{guarantee}].active", ""
        )
        for id_, guarantee in provided.items()
    ]
    (decision,) = decide([need], found, types.get, {need.id: offers})
    return decision
