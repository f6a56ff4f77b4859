"""Why a topic is silent: the words that all transports have in common."""

import difflib
import time

import pytest
from eddi_runtime.node.report import fault
from eddi_runtime.node.topics import Input, Receipts, Silence, Topic

BOOL, TEXT = "std_msgs/Bool", "std_msgs/String"
SILENT = "its publisher is there, and silent"
THERE = Topic("/rte/e0b", BOOL, [BOOL], 3.0, SILENT)
ABSENT = THERE._replace(types=(), age=None)


def reason(topic, published=(), silence=None):
    fact = (silence or Silence([], 0.0)).explained([topic], published)
    assert not fact.wrong_types
    return fact.reasons[topic.name]


def test_a_topic_that_nobody_publishes_has_the_nearest_name():
    assert reason(ABSENT, ["/rte/e0c", "/x"]) == "nobody publishes it, the nearest name is /rte/e0c"
    assert reason(ABSENT, ["/camera/image"]) == "nobody publishes it"


def test_the_nearest_name_is_searched_when_the_graph_changes_only(monkeypatch):
    searched = []
    search = difflib.get_close_matches
    monkeypatch.setattr(
        difflib, "get_close_matches", lambda *given: searched.append(given) or search(*given)
    )
    silence = Silence([], 0.0)
    near = "nobody publishes it, the nearest name is /rte/e0"
    assert [reason(ABSENT, {"/rte/e0c"}, silence) for _ in range(3)] == [f"{near}c"] * 3
    assert len(searched) == 1  # with hundreds of silent topics it would take half a core
    assert reason(ABSENT, {"/rte/e0d"}, silence) == f"{near}d"


def test_nothing_is_called_absent_before_the_graph_is_known():
    starting = Silence([], 3600.0)
    assert reason(ABSENT, ["/rte/e0c"], starting) == ""
    assert reason(ABSENT._replace(age=2.0), silence=starting) == "its publisher is gone"


def test_a_publisher_that_was_there_is_gone_although_it_never_sent():
    silence = Silence([], 0.0)
    before = THERE._replace(age=None)
    assert reason(before, silence=silence) == "its publisher is there, and silent"
    assert reason(ABSENT, ["/rte/e0c"], silence) == "its publisher is gone"


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ({}, "its publisher is there, and silent"),
        ({"alive": None}, "its publisher is registered, and silent"),
        ({"alive": False}, "its publisher gives no sign of life"),
        ({"deadline": 0.5}, "its publisher has missed its deadline of 0.5 s"),
        ({"deadline": 3.5}, "its publisher is there, and silent"),
        ({"deadline": 0.5, "age": None}, "its publisher is there, and silent"),
        ({"connected": False}, "its publisher is there, and not connected"),
        (
            {"connected": False, "refused": "the reliability"},
            "the reliability that its publisher has does not fit",
        ),
        ({"refused": "the reliability"}, "its publisher is there, and silent"),  # another one fits
        (
            {"unreadable": True, "alive": False},
            "what is sent there is not std_msgs/Bool, although it is called so",
        ),
    ],
)
def test_the_reason_is_what_is_known_best(known, words):
    assert fault(BOOL, **{"age": 3.0, **known}) == words


def test_the_reason_is_that_of_a_publication_of_the_right_type():
    assert reason(THERE._replace(types=[TEXT, BOOL])) == SILENT


def test_another_type_is_named_with_the_expected_one():
    fact = Silence([], 3600.0).explained([THERE._replace(types={TEXT})], ())
    assert fact.wrong_types == {
        "/rte/e0b": "std_msgs/Bool expected, the publisher sends std_msgs/String"
    }
    assert not fact.reasons


def test_only_topics_without_a_recent_message_are_looked_at():
    one, two = Input("a", "/a", None), Input("b", "/b", None)
    receipts = Receipts([one, two], lambda: None)
    receipts.receive("a", "message")
    silence = Silence([one, two], 0.0)
    assert silence.quiet(receipts.latest()) == [(two, None)]
    former = {"a": receipts.latest()["a"]._replace(at=time.monotonic() - 5.0)}
    assert [(found.id, age and round(age)) for found, age in silence.quiet(former)] == [
        ("a", 5),
        ("b", None),
    ]
