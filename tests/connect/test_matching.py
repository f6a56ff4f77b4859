"""Which topic of a small robot is taken for an input, which are listed, and why one is not."""

import yaml

from eddi_scaffold.connect.matching import Decision, Fulfilment, decide
from eddi_scaffold.connect.topics import InputNeed, RobotTopic
from eddi_scaffold.monitors.message_types import known_messages
from tests.data_files import data_text, tabled

ROBOT = yaml.load(data_text("connect/small_robot.yml"), yaml.CSafeLoader)
TOPICS = [RobotTopic(name, *rest) for name, rest in ROBOT.items()]


def decided(need: InputNeed, offers: list[Fulfilment] | None = None) -> Decision:
    given = {need.id: offers} if offers is not None else {}
    (decision,) = decide([need], TOPICS, known_messages().get, given)
    return decision


@tabled
def test_what_is_clear_is_taken(id_, type_, unit, topic, key, text, given):
    decision = decided(InputNeed(id_, type_, unit=unit))  # type: ignore[arg-type]
    best = decision.candidates[0]
    assert (decision.state, best.topic.id, best.access.key) == ("taken", topic, key)
    assert best.access.text.startswith(text)
    assert best.access.unit == given


@tabled
def test_what_is_not_clear_is_left_to_a_person(need, listed, text):
    decision = decided(InputNeed(**need))
    assert decision.state == "listed"
    found = {one.topic.id: one.access.text for one in decision.candidates}
    assert found[listed].startswith(text)


def test_claims_of_other_names_are_listed_only_where_none_is_like_the_input() -> None:
    offers = [
        Fulfilment(TOPICS[-2], f"evidence[{key}].active", "", key, is_sure=False)
        for key in ("PoseIsGood", "LastsTheShift")
    ]
    for name, keys in {"PoseKnown": ["PoseIsGood"], "Zzz": ["PoseIsGood", "LastsTheShift"]}.items():
        found = decided(InputNeed(name, "bool"), offers)
        assert [one.access.text for one in found.candidates] == [
            f"evidence[{k}].active" for k in keys
        ]
