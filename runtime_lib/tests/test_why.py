"""The sentence, and the message that carries it."""

import math
from types import SimpleNamespace

import pytest
from eddi_runtime import why
from eddi_runtime.why import NAN, Cause, ClaimWhy
from hypothesis import given
from hypothesis import strategies as st


def read(tree):
    return why.read_why(message(tree))


def message(value):
    if isinstance(value, tuple):
        return SimpleNamespace(**{name: message(one) for name, one in value[1].items()})
    return [message(one) for one in value] if isinstance(value, list) else value


@pytest.mark.parametrize(
    ("function", "pairs"),
    [
        (why.seconds, {0: "0.0 s", 99.94: "99.9 s", 99.96: "100 s", 3599: "3599 s", 3600: "1.0 h"}),
        (why.length, {0.35: "0.35 s", 2.0: "2 s", 10: "10 s", NAN: "no limit"}),
        (why.figure, {0: "0", 0.001: "0.001", 1e-4: "1.0e-4", 0.00399: "0.00399", 55.0: "55"}),
        (why.figure, {2.1e-9: "2.1e-9", 1e6: "1.0e6", 12345: "12345", 999.7: "1000", -0.5: "-0.5"}),
        (why.figure, {math.inf: "inf", NAN: "NaN", 6.931: "6.93", 999999.9: "1.0e6"}),
    ],
)
def test_numbers(function, pairs):
    assert {value: function(value) for value in pairs} == pairs


def test_a_sentence_shows_three_chains_and_is_limited():
    causes = [Cause((f"In{k}", f"/t{k}"), "silent", "x\x1b[2J\n", f"/t{k}") for k in range(12)]
    claim = why.claim_why("w", "Go", why.UNKNOWN, [*causes, *causes])
    chains = "; ".join(f"In{k} <- /t{k}: x [2J " for k in range(3))
    assert claim.sentence == f"Go <- {chains}; and 9 more"
    long = ClaimWhy("Go", why.UNKNOWN, (Cause(("a" * 500,), "false", "b"),))
    assert (len(long.sentence), long.sentence[-3:]) == (402, "a..")
    assert why.claim_why("w", "Go", why.UNKNOWN, []).sentence == "Go: nothing can make it hold"


def test_causes_of_another_monitor_count_while_they_are_fresh_and_of_the_same_verdict():
    there = why.claim_why("lidar", "Clear", why.UNKNOWN, [Cause(("scan",), "window", "{since}")])
    claims = {"Clear": there}
    (cause,) = why.told(claims, "Clear", 2.5, why.UNKNOWN)
    assert (cause.since, cause.under("Path").path) == (2.5, ("Path", "scan"))
    assert not why.told(claims, "Clear", 3.1, why.UNKNOWN)
    assert not why.told(claims, "Clear", NAN, why.UNKNOWN)
    assert not why.told(claims, "Clear", 0.0, why.FALSE)
    assert not why.told(claims, "Other", 0.0, why.UNKNOWN)
    known = {"Clear": there._replace(verdict=why.FALSE)}
    assert why.told(known, "Clear", 0.0, why.UNKNOWN)


def test_who_waits_no_longer_than_it_may_has_never_heard_anything():
    text = f"{why.TEXTS['waiting']} (nobody publishes it)"
    cause = Cause(("scan", "/scan"), "waiting", text, "/scan", since=1.5, limit=2.0)
    assert cause.later(0.4).said == "no message yet, 1.9 s of 2 s to wait (nobody publishes it)"
    over = cause.later(0.6)
    assert over.state == "never"
    assert over.said == "no message yet, 2.1 s after the start (nobody publishes it)"


def test_the_classes_of_another_runtime_are_read_by_their_fields():
    there = why.claim_why("m", "Clear", 0, [Cause(("x",), "false", "b", "/t", detail="c")])
    (cause,) = there.causes
    foreign = SimpleNamespace(
        **{**there._asdict(), "causes": [SimpleNamespace(**cause._asdict())]},
    )
    assert why.read_why({"Clear": foreign}) == {"Clear": there}


def test_a_message_keeps_within_its_bytes_and_a_path_keeps_its_topic():
    cause = Cause(("/topic",), "silent", "t" * 300, "/topic")
    for k in range(40):
        (cause,) = why.claim_why(f"monitor{k}", "c", why.FALSE, [cause.under(f"input{k}")]).causes
    assert (len(cause.path), cause.path[-1], len(cause.monitors)) == (16, "/topic", 16)
    rows = [ClaimWhy(f"c{k}", 1, (cause,) * 8, 3) for k in range(20)]
    _, fields = tree = why.why_tree("m", {row.id: row for row in rows})
    assert why._size(fields["claims"]) < why.MOST_BYTES
    assert {one.more + len(one.causes) for one in read(tree).values()} == {11}


@given(st.recursive(st.none() | st.integers() | st.floats() | st.text(), st.lists))
def test_no_message_of_another_monitor_raises(junk):
    class Row:
        def __getattr__(self, name):
            return junk

    for given_ in (junk, Row(), {"a": junk}, SimpleNamespace(claims=[Row(), junk])):
        assert why.read_why(given_) == {}
        assert why.told(given_, "Go", 0.0, 1) == ()
