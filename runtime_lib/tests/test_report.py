"""What the diagnostics say: levels and words from facts, without any transport."""

import pytest
from eddi_runtime.node.report import (
    ERROR,
    OK,
    STALE,
    WARN,
    GraphFact,
    InputFact,
    MonitorFact,
    NodeFact,
    Reason,
    report,
)
from eddi_runtime.why import Cause, ClaimWhy

CALM = NodeFact(5, 0, 0, 0.001, "")
NONE = MonitorFact()
KNOWN = InputFact("K", "ok", age=0.1, received=3, limit="none")


def said(*inputs, monitor=NONE, node=CALM):
    return report({"model_digest": "d"}, inputs, monitor, node)


def test_nothing_to_say():
    found = said(KNOWN)
    assert (found.level, found.message) == (OK, "all inputs are up to date")
    values = dict(found.values)
    assert (values["K"], values["K.max_age"], values["K.age_s"]) == ("ok", "no limit", "0.100")
    assert "K.reason" not in values


def test_the_worst_finding_comes_first():
    waiting = InputFact("M", "waiting", "/c: no message yet")
    late = InputFact("S", "stale", "/b: nothing for 2.0 s", age=2.0, limit=0.5)
    node = CALM._replace(recent_overruns=1, graph=GraphFact(warnings=("ROS master lost",)))
    more = MonitorFact(accepted=("K: max_age: none",))
    found = said(waiting, late, KNOWN, monitor=more, node=node)
    assert found.level == STALE
    assert found.message == (
        "S stale: /b: nothing for 2.0 s; M waiting: /c: no message yet; "
        "1 steps left out; ROS master lost; accepted: K: max_age: none"
    )
    assert dict(found.values)["S.age_s"] == "2.000"
    broken = InputFact("B", "invalid", "why")
    assert said(waiting, late, broken).level == ERROR
    assert said(waiting._replace(mistaken=True)).level == ERROR
    assert said(KNOWN, node=CALM._replace(silent_for=4.0))[:2] == (ERROR, "no step for 4.0 s")


OWN = Cause(("S", "/s"), "silent", "late", "/s", ("here",))
OTHER = Cause(("T", "C", "/t"), "silent", "gone", "/t", ("here", "there"))


@pytest.mark.parametrize(
    ("row", "level"),
    [
        (ClaimWhy("G", 1, (OWN, OTHER)), WARN),
        (ClaimWhy("G", 1, (OWN,)), OK),  # its own input has a level
        (ClaimWhy("G", 0, (OTHER,)), OK),  # known not to hold is no fault
        (ClaimWhy("G", 2), OK),
    ],
)
def test_a_claim_that_is_unknown_through_another_monitor_is_a_warning(row, level):
    found = said(KNOWN, monitor=MonitorFact("consert", {"G": row}))
    assert found.level == level
    assert ("T <- C" in found.message) is (level == WARN)


def test_every_claim_is_listed_with_its_reason():
    rows = {name: ClaimWhy(name, value, (OWN,)) for value, name in enumerate("FUT")}
    known, hazards = MonitorFact("consert", rows), frozenset("FUT")
    values = dict(said(KNOWN, monitor=known).values)
    assert values["guarantee.F"] == "inactive: F <- S <- /s: late"
    assert values["guarantee.T"] == "active"
    values = dict(said(KNOWN, monitor=known._replace(kind="event", hazards=hazards)).values)
    assert (values["event.F"], values["event.T"]) == ("present: F <- S <- /s: late", "absent")
    assert values["event.U"].startswith("unknown: U <- S")
    assert "F" in dict(said(KNOWN, monitor=known._replace(kind="safeml")).values)
    assert "threshold.F" in dict(said(KNOWN, monitor=known._replace(kind="reliability")).values)


@pytest.mark.parametrize(
    ("reason", "state", "words"),
    [
        (Reason("gone"), "silent", ("gone", "publisher gone 5.0 s (more)")),
        (Reason("gone"), "never", ("never", "t (its publisher is gone, more)")),
        (Reason("type", "A comes, B is needed"), "never", ("type", "A comes, B is needed (more)")),
        (Reason("", detail="it is there"), "silent", ("silent", "t (it is there, more)")),
        (Reason("gone"), "latched", ("latched", "t (more)")),
    ],
)
def test_what_a_transport_knows_of_a_topic_is_said_of_it(reason, state, words):
    cause = Cause(("/s",), state, "t", "/s", age=5.0, detail="more")
    made = GraphFact(reasons={"/s": reason}).explained(cause)
    assert (made.state, made.said) == words
    assert GraphFact(reasons={"/r": reason}).explained(cause) == cause
