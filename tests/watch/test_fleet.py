"""What is known of a fleet, from the messages of its monitors."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime.why import Cause, ClaimWhy
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds import WHY
from eddi_scaffold.watch import fleet, messages
from eddi_scaffold.watch.fleet import Change, FleetState, MonitorView
from eddi_scaffold.watch.messages import Message, requested_robots, status_messages
from tests.watch.served import diagnostics

CONSERT = "eddi_messages/ConSertStatus"
FALSE, UNKNOWN, TRUE = 0, 1, 2


def status(**verdicts: Any) -> SimpleNamespace:
    rows = [
        SimpleNamespace(id=k, verdict=v, missing=[] if v == TRUE else [f"needs_{k}"])
        for k, v in verdicts.items()
    ]
    return SimpleNamespace(model_id="Cart", model_digest="ab", guarantees=rows, accepted=[])


def message(t: float, content: Any, robot: str = "/r1", **more: Any) -> Message:
    return Message(f"{robot}/cart/guarantees/status", CONSERT, content, t, **more)


def only(state: FleetState, now: float = 0.0) -> MonitorView:
    ((monitor,),) = (robot.monitors for robot in state.snapshot(now).robots)
    return monitor


def brief(changes: list[Change]) -> list[tuple[str, str, str | None]]:
    return [(one.id, one.state, one.before) for one in changes]


def test_states_reasons_and_since_when() -> None:
    state = FleetState()
    assert brief(state.take(message(1.0, status(A=TRUE, B=UNKNOWN)))) == [
        ("A", "active", None),
        ("B", "unknown", None),
    ]
    assert state.take(message(2.0, status(A=TRUE, B=UNKNOWN))) == []
    assert brief(state.take(message(3.0, status(A=FALSE, B=UNKNOWN)))) == [
        ("A", "not active", "active")
    ]
    a, b = only(state).verdicts
    assert (a.state, a.reasons, a.since, a.seen) == ("not active", ("needs_A",), 3.0, True)
    assert (b.state, b.since, b.seen) == ("unknown", 1.0, False)
    assert (only(state).name, only(state).title) == ("Cart", "ConSert")


def told(t: float, claim: str, verdict: int, *path: str) -> Message:
    causes = (Cause(path, "silent", "nothing for {age}, limit {limit}", "/x", (), 1.0, 1.0, 0.5),)
    claims = {claim: ClaimWhy(claim, verdict, causes if path else ())}
    return Message("/r1/cart/guarantees/why", WHY, claims, t)


def test_the_sentence_of_a_claim_comes_after_its_change_and_grows_older() -> None:
    state = FleetState()
    state.take(told(0.5, "A", UNKNOWN, "before"))
    state.take(message(1.0, status(A=TRUE)))
    state.take(message(2.0, status(A=UNKNOWN)))
    (a,) = only(state, 2.0).verdicts
    assert (a.why, a.good, a.word) == (None, "unknown", "unknown")
    (change,) = state.take(told(2.1, "A", UNKNOWN, "x", "/x"))
    assert change.reasons == ("A <- x <- /x: nothing for 1.0 s, limit 0.5 s",)
    assert state.take(told(3.1, "A", UNKNOWN, "x", "/x")) == []
    (a,) = only(state, 4.1).verdicts
    assert a.why is not None
    assert a.why.sentence == "A <- x <- /x: nothing for 2.0 s, limit 0.5 s"
    (a,) = only(state, 6.2).verdicts
    assert a.why is not None
    assert a.why.causes == ()  # too old
    state.look(9.0)
    assert only(state, 9.0).verdicts[0].why is None  # it is silent: something else is wrong


def test_a_long_sentence_is_whole() -> None:
    state = FleetState()
    state.take(message(1.0, status(A=UNKNOWN)))
    (change,) = state.take(told(1.1, "A", UNKNOWN, *["x" * 80] * 4))
    assert change.reasons[0].endswith("x: nothing for 1.0 s, limit 0.5 s")


def test_the_names_of_several_graphs_are_told_apart_in_reports_as_well() -> None:
    state = FleetState()
    state.take(message(1.0, status(A=TRUE), "/domain7/r1", node="/domain7/r1/cart"))
    values = {"x": "ok", "x__age_s": "0.1", "x__from": "/scan, /lidar/events Clear"}
    report = diagnostics(1.0, "/r1/cart", **values)
    state.take(replace(report, topic=f"/domain7{report.topic}"))
    found = only(state).report
    assert found is not None
    assert found.inputs[0].sources == ("/domain7/scan", "/domain7/lidar/events Clear")


@pytest.mark.parametrize(
    ("verdict", "claim", "good", "word"),
    [
        (FALSE, TRUE, "active", "absent"),
        (TRUE, FALSE, "not active", "present"),
        (UNKNOWN, UNKNOWN, "unknown", "unknown"),
    ],
)
def test_a_hazard_that_is_absent_is_good(verdict: int, claim: int, good: str, word: str) -> None:
    state = FleetState()
    content = SimpleNamespace(id="h", verdict=verdict, active=verdict != FALSE, accepted=[])
    state.take(told(0.9, "h", claim))
    state.take(Message("/r1/cart/guarantees", "eddi_messages/EventOutput", content, 1.0))
    (hazard,) = only(state, 60.0).verdicts
    assert (hazard.good, hazard.word) == (good, word)


def test_the_possible_states_of_a_machine_are_told() -> None:
    evidence = [SimpleNamespace(id="NotFailed", active=False)]
    output = SimpleNamespace(
        id="shuttle", state="", possible=["Ready", "Halted"], failed=UNKNOWN, accepted=[]
    )
    vars(output).update(evidence=evidence, unknown_inputs=["fault"], reason="")
    topic, state = "/shuttle/state", FleetState()
    changes = state.take(Message(topic, "eddi_messages/StateMachineOutput", output, 1.0))
    reasons = ("in Ready or Halted", "fault")
    assert [(one.id, one.state, one.reasons) for one in changes] == [
        ("not failed", "unknown", reasons),
        ("NotFailed", "unknown", reasons),
    ]
    state.take(Message(f"{topic}/why", WHY, told(1.0, "failed", UNKNOWN, "fault").content, 1.0))
    monitor = only(state)
    assert monitor.situation == "in Ready or Halted"
    assert monitor.verdicts[0].why is not None
    state.look(10.0)
    assert only(state).situation == ""


def test_a_reason_is_in_the_words_of_the_diagnostics() -> None:
    from eddi_runtime import event as events

    for verdict, reasons in ((FALSE, events._REASONS[:1]), (TRUE, ())):
        event = SimpleNamespace(id="e", verdict=verdict, active=verdict == TRUE, accepted=[])
        ((said,), *_) = vars(status_messages()["eddi_messages/EventOutput"][1](event)).values()
        assert said.reasons == reasons


def test_silence_makes_every_verdict_unknown_and_the_next_message_known_again() -> None:
    state = FleetState(patience_s=3.0)
    for k in range(10):
        state.take(message(k / 10, status(A=TRUE, B=UNKNOWN)))
    assert state.look(3.9) == []
    found = state.look(4.0)
    assert brief(found) == [("A", "unknown", "active"), ("B", "unknown", "unknown")]
    assert {(one.t, one.reasons) for one in found} == {(4.0, ("no message for more than 3 s",))}
    assert only(state).silent
    assert all("no message for more than 3 s" in one.reasons for one in only(state).verdicts)
    assert state.look(100.0) == []
    assert brief(state.take(message(101.0, status(A=TRUE, B=UNKNOWN)))) == [
        ("A", "active", "unknown"),
        ("B", "unknown", "unknown"),
    ]
    assert not only(state).silent


def test_a_slow_monitor_is_not_silent_between_its_messages() -> None:
    state = FleetState(patience_s=3.0)
    for t in (0.0, 10.0, 20.0):
        state.take(message(t, status(A=TRUE)))
    assert state.look(30.0) == []
    assert len(state.look(51.0)) == 1


def test_a_kept_message_is_believed_only_when_another_one_follows() -> None:
    state = FleetState(patience_s=3.0)
    assert state.take(message(0.0, status(A=TRUE), kept=True)) == []
    assert brief(state.look(3.5)) == [("A", "unknown", None)]
    assert "unknown age" in only(state).verdicts[0].reasons[0]
    assert brief(state.take(message(4.0, status(A=TRUE)))) == [("A", "active", "unknown")]
    state.take(message(6.0, status(A=TRUE), kept=True))  # of a publisher that came back
    assert brief(state.look(7.5)) == [("A", "unknown", "active")]


def test_robots_are_told_apart_by_node_namespace_or_topic() -> None:
    state = FleetState()
    state.take(message(0.0, status(A=TRUE), "/r1"))
    state.take(message(0.0, status(A=FALSE), "/r2"))
    state.take(Message("/odd", CONSERT, status(A=TRUE), 0.0, node="/r3/cart"))
    state.take(Message("/cart/guarantees/status", CONSERT, status(A=TRUE), 0.0))
    assert [one.name for one in state.snapshot(0.0).robots] == ["/", "/r1", "/r2", "/r3"]


def test_only_the_robots_that_are_asked_for() -> None:
    state = FleetState(requested_robots(["r1", "arm=/cell/arm"]))
    for robot in ("/r1", "/r10", "/cell/arm", "/cell"):
        state.take(message(0.0, status(A=TRUE), robot))
    assert [one.name for one in state.snapshot(0.0).robots] == ["/r1", "arm"]


def test_a_message_that_is_none_of_ours_is_noted_once() -> None:
    state = FleetState()
    for content in (SimpleNamespace(), SimpleNamespace(model_id=1, guarantees=3)):
        assert state.take(message(0.0, content)) == []
    note, _ = state.snapshot(0.0).notes
    assert "/r1/cart/guarantees/status" in note


def test_what_a_monitor_says_no_more_is_gone() -> None:
    state = FleetState()
    state.take(message(0.0, status(A=TRUE, B=TRUE)))
    state.take(message(0.1, status(B=TRUE)))
    assert [one.id for one in only(state).verdicts] == ["B"]


def test_memory_is_limited_whatever_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fleet, "MAX_VERDICTS", 50)
    monkeypatch.setattr(fleet, "MAX_MONITORS", 20)
    state = FleetState()
    for k in range(100):
        state.take(message(0.0, status(**{f"G{k}_{n}": TRUE for n in range(7)}), f"/r{k}"))
    snapshot = state.snapshot(0.0)
    shown = [one for robot in snapshot.robots for m in robot.monitors for one in m.verdicts]
    assert len(shown) == 50
    assert len(snapshot.robots) == 20
    assert len(snapshot.notes) == 2
    long = state.take(message(1.0, status(x=TRUE), "/r1", node="n\x1b" * 9999))
    assert long == []
    state.take(message(1.0, status(B=TRUE), "/r1"))  # its seven are gone: there is room again
    assert messages.plain("a\nb\x1b[2J" + "c" * 999).startswith("a b?[2J")
    assert len(messages.plain("c" * 999)) == messages.MAX_TEXT


@given(
    st.lists(
        st.tuples(
            st.floats(0.01, 9.0),
            st.booleans(),
            st.sampled_from([FALSE, UNKNOWN, TRUE]),
            st.booleans(),
        ),
        max_size=30,
    )
)
def test_nothing_is_active_unless_a_message_said_so_in_time(
    steps: list[tuple[float, bool, int, bool]],
) -> None:
    state, t, fresh, said = FleetState(patience_s=3.0), 0.0, -1e9, FALSE
    gaps: list[float] = []
    for gap, comes, verdict, kept in steps:
        t += gap
        state.look(t)
        if comes:
            state.take(message(t, status(A=verdict), kept=kept))
            if not kept:
                gaps.append(t - fresh)
                fresh, said = t, verdict
        robots = state.snapshot(t).robots
        shown = [one.state for r in robots for m in r.monitors for one in m.verdicts]
        longest = max(3.0, 3 * max(gaps[-5:], default=0.0))
        if "active" in shown:
            assert said == TRUE
            assert t - fresh <= longest


def test_monitors_of_one_process_have_names_and_reports_of_their_own() -> None:
    """Messages of events and of SafeML do not say of which model they are."""
    state = FleetState()
    event = SimpleNamespace(id="Clear", active=True, verdict=TRUE, accepted=[])
    scope = SimpleNamespace(in_scope=True, omission=False, statistic=0.5, acceptances=[])
    for topic, name, content in (
        ("/lidar/events", "eddi_messages/EventOutput", event),
        ("/people/scope/status", "eddi_messages/SafeMLStatus", scope),
    ):
        state.take(Message(topic, name, content, 1.0, node="/eddi_monitors"))
    reports = [
        SimpleNamespace(
            name=f"/eddi_monitors: {model}",
            hardware_id="/eddi_monitors",
            message=f"of {model}",
            values=[SimpleNamespace(key="runtime_version", value="1")],
        )
        for model in ("lidar", "people", "other")
    ]
    content = SimpleNamespace(status=reports)
    state.take(Message("/diagnostics", "diagnostic_msgs/DiagnosticArray", content, 1.1))
    (robot,) = state.snapshot(1.2).robots
    found = {one.name: one.report and one.report.message for one in robot.monitors}
    assert found == {"lidar": "of lidar", "people": "of people"}
