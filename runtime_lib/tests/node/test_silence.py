"""Why a topic is silent: the words that all transports have in common."""

import difflib
import time

import pytest
from eddi_runtime.node.report import Reason, fault, offer
from eddi_runtime.node.topics import Input, Receipts, Silence, Topic

BOOL, TEXT = "std_msgs/Bool", "std_msgs/String"
SILENT = Reason("", detail="its publisher is there")
GONE, QOS = Reason("gone"), offer("best_effort", "reliable")
THERE = Topic("/rte/e0b", BOOL, [BOOL], 3.0, SILENT)
ABSENT = THERE._replace(types=(), age=None)


def reason(topic, published=(), silence=None):
    fact = (silence or Silence([], 0.0)).explained([topic], published)
    return fact.reasons.get(topic.name)


def absent(detail):
    return Reason("", detail=detail)


def test_a_topic_that_nobody_publishes_has_the_nearest_name():
    near = absent("nobody publishes it, the nearest name is /rte/e0c")
    assert reason(ABSENT, ["/rte/e0c", "/x"]) == near
    assert reason(ABSENT, ["/camera/image"]) == absent("nobody publishes it")


def test_the_nearest_name_is_searched_when_the_graph_changes_only(monkeypatch):
    searched = []
    search = difflib.get_close_matches
    monkeypatch.setattr(
        difflib, "get_close_matches", lambda *given: searched.append(given) or search(*given)
    )
    silence = Silence([], 0.0)
    near = "nobody publishes it, the nearest name is /rte/e0"
    assert [reason(ABSENT, {"/rte/e0c"}, silence) for _ in range(3)] == [absent(f"{near}c")] * 3
    assert len(searched) == 1  # with hundreds of silent topics it would take half a core
    assert reason(ABSENT, {"/rte/e0d"}, silence) == absent(f"{near}d")


def test_nothing_is_called_absent_before_the_graph_is_known():
    starting = Silence([], 3600.0)
    assert reason(ABSENT, ["/rte/e0c"], starting) is None
    assert reason(ABSENT._replace(age=2.0), silence=starting) == GONE


def test_a_publisher_that_was_there_is_gone_although_it_never_sent():
    silence = Silence([], 0.0)
    assert reason(THERE._replace(age=None), silence=silence) == SILENT
    assert reason(ABSENT, ["/rte/e0c"], silence) == GONE


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({}, "its publisher is there"),
        ({"alive": False}, "its publisher gives no sign of life"),
        ({"deadline": 0.5}, "its publisher has missed its deadline of 0.5 s"),
        ({"deadline": 3.5}, "its publisher is there"),
        ({"deadline": 0.5, "age": None}, "its publisher is there"),
        ({"connected": False}, "its publisher is there, and not connected"),
        ({"connected": False, "refused": QOS}, "best_effort is offered, reliable is needed"),
        ({"refused": QOS}, "its publisher is there"),  # another one fits
        (
            {"unreadable": True, "alive": False},
            "what is sent there is not std_msgs/Bool, although it is called so",
        ),
    ],
)
def test_the_reason_is_what_is_known_best(known, words):
    made = fault(BOOL, **{"age": 3.0, **known})
    assert words in (made.text, made.detail)


def test_the_reason_is_that_of_a_publication_of_the_right_type():
    assert reason(THERE._replace(types=[TEXT, BOOL])) == SILENT


def test_another_type_is_named_with_the_expected_one():
    text = "std_msgs/String comes, std_msgs/Bool is needed"
    assert reason(THERE._replace(types={TEXT}), silence=Silence([], 3600.0)) == ("type", text, "")


def test_only_topics_from_which_nothing_usable_comes_are_looked_at():
    one, two = Input("a", "/a", None), Input("b", "/b", None)
    receipts = Receipts([one, two], lambda: None)
    receipts.receive("a", "message")
    silence = Silence([one, two], 0.0)
    assert not silence.quiet(receipts.latest())
    silence.suspected = {"a", "b"}
    former = {"a": receipts.latest()["a"]._replace(at=time.monotonic() - 5.0)}
    assert [(source.id, age and round(age)) for source, age in silence.quiet(former)] == [
        ("a", 5),
        ("b", None),
    ]
