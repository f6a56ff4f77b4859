"""Compiled events and expressions: the text, and what of a hostile model is in it."""

import itertools
import random
from types import SimpleNamespace

import pytest

from eddi_scaffold.conditions.analysis import analyse
from runtime_lib.tests import conserts
from runtime_lib.tests.bound_models import bound_input
from runtime_lib.tests.event.event_models import SECOND, events, form, monitor
from tests.conditions import test_lists
from tests.conditions.formulas import DECLARATIONS, RATE, Formulas
from tests.program.formatting import HOSTILE, assert_plain_data

LONG = "a_name_of_more_than_twenty_four_characters"


def events_of(text):
    analysis = analyse(text, rate=RATE)
    assert analysis.program is not None, analysis.problems
    factors = itertools.chain([None], itertools.repeat((9, 5)))
    inputs = [
        bound_input(one.name, attribute=f"in_{k}", factor=factor)
        for k, (one, factor) in enumerate(zip(analysis.inputs, factors, strict=False))
    ]
    return events(analysis.program, inputs)


def many():
    """Every operation, in events that are made at random."""
    formulas = Formulas(random.Random(3), False)
    lines = [f"EVENT e{k} (HAZARD) := {formulas.boolean(3)}" for k in range(60)]
    return events_of(DECLARATIONS + "\n".join(lines))


def lists():
    rng = random.Random(4)
    made = [test_lists.formula(rng) for _ in range(40)]
    bools = [one if one.startswith("A") and one[1] in "NL" else f"{one} > 1" for one in made]
    lines = [f"EVENT e{k} (HAZARD) := {one}" for k, one in enumerate(bools)]
    return events_of(test_lists.DECLARATIONS + "\n".join(lines))


def long_names():
    variables = (LONG, "y" * 24, "z" * 24, "r1", "y" * 24 + "_stamp", "self", "expressions")
    x, y, z, *others = variables
    bounds = {"range": (-1.7976931348623157e308, 1.7976931348623157e308), "infinite": True}
    conditions = [
        ("hysteresis", y, z, x),
        ("gt", ("least", y, z), -1.7976931348623157e308),
        ("gt", ("max", ("div", y, ("age", z)), 3, 0.5), ("sqrt", ("sub", x, z))),
        *(("gt", one, 5) for one in others),
    ]
    made = form(*conditions, variables=variables, **{y: bounds})
    return events(made, [bound_input(one) for one in variables])


def expression():
    """A ConSert whose inputs are computed: of a message, and a state of two conditions."""
    name = f"x.{LONG}.value"
    bound = form(("time", ("gt", "x", 5), 3), variables=("x",), x={"name": name, "timeout": 9})
    states = [
        {"state": one, "program": form((op, "x", 5), variables=("x",))}
        for one, op in (("low", "lt"), ("high", "gt"))
    ]
    specs = {
        "a": {"expression": {"type": "bool", "parts": [{"program": bound}], "polarity": "HAZARD"}},
        "b": {"expression": {"type": "state", "parts": states}, "attribute": "3 b"},
    }
    checks = {name: [["unless", ["x" * 40], "y" * 40]]}
    specs["a"]["expression"] |= {"names": {"x": ["message", "m"]}, "checks": checks}
    specs["b"]["expression"] |= {"names": {"x": ["input", "a"]}}
    evidence = ["a", ("b", conserts.categorical("high"))]
    return conserts.consert(evidence, guarantees=["G"], edges=["a>G", "b>G"], specs=specs)


ALL = {"many": many, "lists": lists, "long_names": long_names, "expression": expression}


@pytest.mark.parametrize("made", ALL.values(), ids=ALL)
def test_formatter_and_linter_change_nothing(made):
    assert_plain_data(made().text())


def test_names_with_another_meaning_are_variables_of_their_own():
    names = ("self", "expressions", "r1", "t", "last", "t_stamp", "NAN", LONG)
    found = form(*(("gt", one, 5) for one in names), variables=names)
    running = events(found, [bound_input(one) for one in names]).monitor()
    given = SimpleNamespace(**{one: float(k) for k, one in enumerate(names)})
    rows = running.execute_step(given, 0)
    assert [row["verdict"] for row in rows] == [k > 5 for k in range(len(names))]


def test_nothing_of_a_hostile_model_becomes_code():
    names = [*HOSTILE, "m"]
    found = form(
        *(("gt", one, 5) for one in HOSTILE),
        ("eq_enum", "m", ("literal", 0)),
        variables=names,
        m={"literals": HOSTILE},
    )
    inputs = [bound_input(one, attribute=f"value {k}") for k, one in enumerate(names)]
    *results, last = found.results
    results = [result._replace(id=HOSTILE[-k]) for k, result in enumerate(results)]
    made = events(found._replace(results=(*results, last)), inputs)
    assert_plain_data(made.text())
    values = {f"value {k}": 6.0 for k in range(len(HOSTILE))}
    rows = made.monitor().execute_step(
        SimpleNamespace(**values, **{f"value {len(HOSTILE)}": HOSTILE[0]}), 0
    )
    assert all(row["verdict"] for row in rows)


def test_an_expression_is_a_class_of_the_package():
    first, second = (spec.expression for spec in expression().monitor().inputs)
    assert (first.__name__, first().names) == ("Expression_a", {"x": ("message", "m")})
    assert first().value(0, {}) is True  # a HAZARD
    assert [second().value(0, {"x": x}) for x in (4.0, 6.0, 5.0, None)] == [
        "low",
        "high",
        None,
        None,
    ]


def test_two_monitors_of_one_text_are_independent():
    made = type(monitor(("time", "a", 2), ("rise", "a")))
    one, other = made(), made()
    for k in range(3):
        rows = one.execute_step(SimpleNamespace(a=True), k * SECOND)
    fresh = other.execute_step(SimpleNamespace(a=True), 0)
    assert [row["verdict"] for row in rows] == [True, False]
    assert [row["verdict"] for row in fresh] == [None, None]
