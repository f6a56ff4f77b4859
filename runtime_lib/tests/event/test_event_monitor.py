"""The monitor of events: attributes in, rows and messages out; never an exception."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from eddi_runtime.inputs import UNKNOWN_AGE, EDDIInputBase, InputState

from . import event_models
from .event_models import SECOND, form

NAN = float("nan")


class Hostile:
    def __getattribute__(self, name):
        raise RuntimeError(name)


made = event_models.monitor


def step(monitor, k, **values):
    return monitor.execute_step(SimpleNamespace(**values), k * SECOND)


def verdicts(rows):
    return [row["verdict"] for row in rows]


def test_polarity_and_edges():
    monitor = made(("gt", "x", 5), ("gt", "x", 5))
    rows = step(monitor, 0, x=6.0)
    assert rows[0] == {
        "id": "e0",
        "verdict": True,
        "active": True,
        "raised": True,
        "cleared": False,
    }
    rows = step(monitor, 1, x=None)
    assert [(r["verdict"], r["active"], r["cleared"]) for r in rows] == [
        (None, False, True),
        (None, True, True),
    ]
    assert [r["raised"] for r in step(monitor, 2, x=7)] == [True, True]
    assert [r["raised"] for r in step(monitor, 2, x=0)] == [False, False]  # the same time
    assert verdicts(step(monitor, 1, x=0)) == [False, False]  # the clock went back


NO_VALUES = (None, NAN, object(), [], {}, "x", True, 10**400, 1j, Hostile())


@pytest.mark.parametrize("number", range(len(NO_VALUES)))
def test_what_is_no_value_is_unknown(number):
    value = NO_VALUES[number]
    monitor = made(("gt", "x", 5), "a")
    a = value if value is not True else 1
    rows = monitor.execute_step(SimpleNamespace(x=value, a=a), 0)
    assert verdicts(rows) == [None, None]
    missing = monitor.execute_step(object(), SECOND)
    assert [tree[1]["verdict"] for tree in monitor.message(missing)] == [1, 1]
    assert verdicts(monitor.execute_step(Hostile(), 2 * SECOND)) == [None, None]


def test_messages():
    monitor = made(("gt", "x", 5), ("gt", "x", 5))
    (one, other) = monitor.message(step(monitor, 0, x=6.0))
    fields = {"id": "e0", "verdict": 2, "active": True, "raised": True, "cleared": False}
    assert one == ("EventOutput", {**fields, "accepted": []})
    assert other[1]["id"] == "e1"
    assert monitor.output_faults() == ()
    for spoilt in (
        None,
        [None],
        [{"id": 1}],
        [dict(fields, verdict="yes")],
        [dict(fields, active=1)],
    ):
        assert monitor.message(spoilt) == []
        assert len(monitor.output_faults()) == 1


def test_the_message_of_an_event_has_the_acceptances_that_it_may_rest_on():
    limitless = {"max_age": "none"}
    inputs = {"x": limitless, "y": limitless, "a": {"max_age": 1.0}}
    monitor = made(("and", ("gt", "x", 5), "a"), ("gt", "y", 1), inputs=inputs)
    states = dict.fromkeys(inputs, InputState("ok"))
    output = step(monitor, 0, x=6.0, y=2.0, a=True, states=states)
    found = [fields["accepted"] for _, fields in monitor.message(output)]
    assert found == [["x: max_age: none"], ["y: max_age: none"]]
    assert monitor.accepted() == ("x: max_age: none", "y: max_age: none")
    output = step(monitor, 1, x=None, y=2.0, a=True, states=states)
    assert [fields["accepted"] for _, fields in monitor.message(output)] == [[], found[1]]


def named(monitor):
    """Return event -> the inputs that are named as why it does not hold."""
    whys = monitor.why().items()
    return {id_: [one.path[0] for one in why.causes if one.path] for id_, why in whys}


def test_who_keeps_an_event_from_being_known():
    monitor = made(("and", ("gt", "x", 5), "a"), ("gt", "y", 1))
    step(monitor, 0, x=None, y=2.0, a=True)
    assert named(monitor) == {"e0": ["x"], "e1": []}
    step(monitor, 1, x=None, y=2.0, a=False)
    assert named(monitor) == {"e0": [], "e1": []}  # FALSE whatever x is
    step(monitor, 2, x="six", y=NAN, a=True)
    assert named(monitor) == {"e0": ["x"], "e1": ["y"]}
    assert monitor.faults() == {"x": "expected a number, got 'six'"}
    assert monitor.series(step(monitor, 3, x=6, y=0, a=True)) == {"e0": True, "e1": False}
    assert monitor.status_message() is None


def test_a_number_that_its_declaration_refuses_is_told():
    said = {"x": {"range": (0.0, 30.0)}, "y": {"range": (0.0, 9.0), "infinite": True}}
    monitor = made(("gt", "x", 5), ("gt", "y", 1), **said)
    step(monitor, 0, x=50, y=math.inf)
    assert monitor.faults() == {"x": "50 is outside RANGE 0 .. 30"}
    step(monitor, 1, x=-math.inf, y=10.0)
    assert monitor.faults() == {
        "x": "-inf, without ALLOW INF",
        "y": "10.0 is outside RANGE 0 .. 9",
    }
    step(monitor, 2, x=30.0, y=0)
    assert monitor.faults() == {}
    assert made(("gt", "x", 5)).execute_step(SimpleNamespace(x=math.inf), 0)[0]["verdict"] is None


def test_what_is_beyond_the_range_is_told_in_the_unit_in_which_it_was_given():
    said = {"inputs": {"x": {"factor": [100, 1]}}, "x": {"range": (0.0, 1234567.0)}}
    monitor = made(("gt", "x", 5), **said)
    step(monitor, 0, x=12345.68)
    assert monitor.faults() == {"x": "12345.68, times 100: 1234568.0 is outside RANGE 0 .. 1234567"}


def test_ages_come_from_the_input():
    monitor = made(("gt", "x", 5), ("lt", ("age", "x"), 3), x={"timeout": 2 * SECOND})
    source = EDDIInputBase()
    source.x = 6.0
    for age, wanted in (
        (None, [True, True]),
        (1.0, [True, True]),
        (2.5, [None, True]),
        (3.0, [None, False]),
        (UNKNOWN_AGE, [None, None]),
    ):
        source.states["x"] = InputState("ok", "", age)
        monitor.reset()
        assert verdicts(monitor.execute_step(source, 10 * SECOND)) == wanted


def test_a_clock_that_stands_hides_no_silence():
    monitor = made(("time", "a", 1), period=SECOND)
    assert verdicts(step(monitor, 7, a=True)) == [True]
    assert verdicts(step(monitor, 7, a=False)) == [True]  # no time has passed
    assert verdicts(step(monitor, 7, a=None)) == [None]
    assert verdicts(step(monitor, 7, a=True)) == [True]


# expressions of inputs


def expression(kind, *parts, **more):
    return event_models.expression(dict({"type": kind, "parts": list(parts)}, **more))


def messages(**fields):
    return {"x": SimpleNamespace(**fields)}


def test_an_expression_over_messages():
    part = {"program": form(("gt", "x", 5), variables=("x",), x={"name": "x.data[1].value"})}
    one = expression("bool", part)
    assert tuple(one.names) == ("x",)
    good = messages(data=[None, SimpleNamespace(value=6)])
    assert one.value(0, good) is True
    assert one.value(1, messages(data=[])) is None
    assert one.value(2, {}) is None
    hazard = expression("bool", part, polarity="HAZARD")
    assert [hazard.value(0, good), hazard.value(1, {})] == [True, True]


def test_numbers_and_states():
    number = {"program": form(("mul", "x", 2), variables=("x",))}
    assert expression("float", number).value(0, {"x": 1.25}) == 2.5
    found = [expression("int", number).value(0, {"x": x}) for x in (1.25, 0.75, None, 1e308)]
    assert found == [2, 2, None, None]
    states = [
        {"state": "High", "program": form(("gt", "x", 5), variables=("x",))},
        {"state": "Low", "program": form(("lt", "x", 6), variables=("x",))},
    ]
    state = expression("state", *states)
    assert [state.value(k, {"x": x}) for k, x in enumerate((7, 4, 5.5, None))] == [
        "High",
        "Low",
        None,
        None,
    ]
    state.reset()


def test_ages_of_messages_end_them():
    part = {"program": form(("gt", "x", 5), variables=("x",), x={"timeout": SECOND})}
    one = expression("bool", part)
    assert one.value(0, {"x": 6.0}, {"x": 0.5}) is True
    assert one.value(1, {"x": 6.0}, {"x": 1.5}) is None
    assert one.value(2, {"x": 6.0}, {"x": UNKNOWN_AGE}) is None


def test_elements_by_key_and_why_there_is_none():
    name = 'x.status["a.b"].level'
    part = {"program": form(("gt", "x", 5), variables=("x",), x={"name": name})}
    one = expression("bool", part, paths={name: ["status", ["name", "a.b"], "level"]})
    assert tuple(one.names) == ("x",)
    good = SimpleNamespace(name="a.b", level=6)
    assert (one.value(0, messages(status=[good])), one.reason) == (True, "")
    assert one.value(1, messages(status=[good, good])) is None
    assert one.reason == "LookupError: 2 elements have the name 'a.b'; there: a.b, a.b"
    assert one.value(2, {"x": Hostile()}) is None
    assert (one.value(3, {}), one.reason) == (None, "")


def test_every_event_is_listed_with_what_it_lacks():
    monitor = made(("gt", "x", 5), ("and", ("gt", "x", 5), ("gt", "y", 5)), hazards=[1])
    step(monitor, 0, x=6.0)
    first, second = monitor.why().values()
    assert (first.verdict, second.verdict) == (2, 1)  # a HAZARD that is UNKNOWN
    assert second.sentence == f"{second.id} <- y: no value"
    step(monitor, 1, x=4.0)
    first, second = monitor.why().values()
    assert (first.sentence, second.sentence) == (f"{first.id}: false for 0.0 s (x 4)", "")
