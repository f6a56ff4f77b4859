"""What the diagnostics say: levels and words from facts, without any transport."""

import pytest
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.monitor import Standing
from eddi_runtime.node.report import (
    ERROR,
    OK,
    STALE,
    GraphFact,
    InputFact,
    MonitorFact,
    NodeFact,
    SourceFact,
    because,
    report,
    standing_text,
)

CALM = NodeFact(5, 0, 0, 0.001, "")
NONE = MonitorFact()
KNOWN = InputFact("K", "ok", age=0.1, received=3, limit="none")
A, B, C = SourceFact("/a", 0.1), SourceFact("/b", 1.25), SourceFact("/c", None)


def said(*inputs, monitor=NONE, node=CALM):
    return report({"model_digest": "d"}, inputs, monitor, node)


def test_nothing_to_say():
    found = said(KNOWN)
    assert (found.level, found.message) == (OK, "all inputs are up to date")
    values = dict(found.values)
    assert (values["K"], values["K.max_age"], values["K.age_s"]) == ("ok", "no limit", "0.100")
    assert "K.reason" not in values


def test_the_worst_finding_comes_first():
    waiting = InputFact("M", "waiting", blocks=("G1", "G2"), sources=(C,))
    late = InputFact("S", "stale", age=2.0, limit=0.5, sources=(B,))
    node = CALM._replace(recent_overruns=1, graph=GraphFact(warnings=("ROS master lost",)))
    more = MonitorFact(accepted=("K: max_age: none",), doubts=("pump: it may have failed",))
    found = said(waiting, late, KNOWN, monitor=more, node=node)
    assert found.level == STALE
    assert found.message == (
        "S stale: /b is late, 1.25 s old, the limit is 0.5 s; "
        "M waiting: waiting for first message of /c (blocks G1, G2); "
        "1 steps left out; ROS master lost; accepted: K: max_age: none; pump: it may have failed"
    )
    assert dict(found.values)["S.age_s"] == "2.000"
    broken = InputFact("B", "invalid", "why")
    assert said(waiting, late, broken).level == ERROR
    assert said(KNOWN, node=CALM._replace(silent_for=4.0))[:2] == (ERROR, "no step for 4.0 s")


LATE, NEVER = "/b is late, 1.25 s old, the limit is 1 s", "never received since start: /c"


@pytest.mark.parametrize(
    ("state", "sources", "words"),
    [
        ("waiting", (A, C), "waiting for first message of /c"),
        ("missing", (C, A), NEVER),
        ("missing", (C, C._replace(topic="/d")), f"{NEVER}, /d"),
        ("stale", (A, B), LATE),
        ("missing", (B, C), f"{NEVER}, {LATE}"),
        ("stale", (A, A._replace(age=UNKNOWN_AGE)), "/a was latched, its age is not known"),
        ("stale", (A,), "as it was told"),  # a message has come since the step
        ("missing", (A, C._replace(reason="no one")), f"{NEVER} (no one)"),
        ("stale", (B._replace(reason="gone"),), f"{LATE} (gone)"),
        ("latched", (A,), "age unknown"),
        ("invalid", (B,), "as it was told"),
    ],
)
def test_an_input_names_the_topics_that_are_to_blame(state, sources, words):
    assert because(InputFact("I", state, "as it was told", limit=1.0, sources=sources)) == words


def test_every_guarantee_is_listed_and_an_inactive_one_with_its_reason():
    late = InputFact("S", "stale", limit=1.0, sources=(A, B))
    lacks = (("S", "no value"), ("K", "the value is False"))
    rows = (
        Standing("guarantee", "G1", active=False, lacks=lacks),
        Standing("guarantee", "G2", active=True),
        Standing("guarantee", "G3", active=False, reason="nothing can activate it"),
        Standing("", "in_scope", active=False, lacks=(("X", "no value"),)),
    )
    values = dict(said(late, KNOWN, monitor=MonitorFact(rows)).values)
    assert values["guarantee.G1"] == (
        "inactive: S: /b is late, 1.25 s old, the limit is 1 s; K: the value is False"
    )
    assert values["guarantee.G2"] == "active"
    assert values["guarantee.G3"] == "inactive: nothing can activate it"
    assert values["in_scope"] == "inactive: X: no value"


def test_another_type_is_the_reason_of_the_input_or_a_finding_by_itself():
    node = CALM._replace(graph=GraphFact(wrong_types={"/c": "X expected", "/z": "Y expected"}))
    waiting = InputFact("M", "waiting", sources=(A, C._replace(reason="X expected")))
    found = said(waiting, node=node)
    assert found.level == ERROR
    assert found.message == (
        "M waiting: waiting for first message of /c (X expected); /z: Y expected"
    )
    values = dict(found.values)
    assert values["wrong_type.0"] == "/c: X expected"
    assert values["wrong_type.1"] == "/z: Y expected"


def test_a_long_reason_stays_one_line():
    many = tuple((f"I{k}", "no value") for k in range(7))
    text = standing_text(Standing("guarantee", "G", active=False, lacks=many), {})
    assert text.endswith("I4: no value; and 2 more inputs")
