"""Composition: reasons, order, bindings, instances, and ConSerts that wait for each other."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.kinds.consert.compose import compose
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Evidence,
    Guarantee,
    NumericDimension,
    Propagation,
    ProvidedService,
    Range,
    RequiredService,
)
from eddi_scaffold.kinds.consert.ranges import Interval, exact, is_inside
from tests.cli.command import run
from tests.data_files import data_text
from tests.diagnosed import assert_reported


def numeric(*ranges, uom="s", subset="Demand", type_="Latency"):
    bounds = tuple(
        Range(Bound(a, float(a)), Bound(b, float(b)), end == "]") for a, b, end in ranges
    )
    return NumericDimension(type_, bounds, subset, uom)


def provider(*dimensions, id_="G", service="T"):
    return ConSert(
        "P",
        (Guarantee(id_, dimensions),),
        (),
        (Evidence("E", BinaryDimension("B")),),
        (),
        (Propagation("E", id_),),
        (),
        (ProvidedService("S", service, (id_,)),),
    )


def user(*dimensions, id_="D", service="T", offers="U"):
    own = Guarantee("GU", (BinaryDimension("X"),))
    return ConSert(
        "U",
        (own,),
        (Demand(id_, dimensions),),
        (),
        (),
        (Propagation(id_, "GU"),),
        (RequiredService("R", service, (id_,)),),
        (ProvidedService("Q", offers, ("GU",)),),
    )


def within(end, *, to="]", uom="s", subset="Demand"):
    return numeric(("0", str(end), to), uom=uom, subset=subset)


LEVELS = [CategoricalDimension("Level", pair, "Demand") for pair in (("a", "b"), ("b", "c"))]
REASONS = [
    (within(2), within(3), "Latency: [0, 3] s of D is not inside [0, 2] s of p/G"),
    (
        *(within(end, subset="Guarantee") for end in (3, 2)),
        "Latency: [0, 3] s of p/G is not inside [0, 2] s of D",
    ),
    (
        *(within(2, to=")"), within(2000, uom="ms")),
        "Latency: [0, 2000] ms of D is not inside [0, 2) s of p/G",
    ),
    (
        within(2, uom="m"),
        within(2),
        "Latency: the unit m of p/G and the unit s of D do not compare",
    ),
    (
        within(2, uom=None),
        within(2),
        "Latency: the ratio of p/G and the unit s of D do not compare",
    ),
    (
        *(within(2, subset="Guarantee"), within(2)),
        "Latency: the subset is Guarantee in p/G and Demand in D",
    ),
    (*LEVELS, "Level: {b, c} of D is not inside {a, b} of p/G"),
]


@pytest.mark.parametrize(("offered", "wanted", "reason"), REASONS)
def test_reason_of_the_nearest_candidate(offered, wanted, reason):
    result = compose([("p", provider(offered)), ("u", user(wanted))])
    assert not result.composable
    assert (result.unmatched_demands, result.unmatched_services) == (("D",), ())
    assert result.reasons == (f"demand u/D is not fulfilled: dimension {reason}",)
    assert result.order == ("p",)


def test_nobody_there():
    result = compose([("u", user(BinaryDimension("X")))])
    assert result.unmatched_demands == ("D",)
    assert result.unmatched_services == ("R",)
    assert result.reasons == (
        "demand u/D is not fulfilled: no other ConSert guarantees anything in a service of type T",
        "required service u/R is not provided: no other ConSert provides a service of type T",
    )


def test_conserts_that_wait_for_each_other():
    x = BinaryDimension("X")
    result = compose([("a", user(x, offers="T")), ("b", user(x, offers="T"))])
    assert not result.composable
    assert result.unmatched_demands == result.unmatched_services == ()
    assert result.reasons == (
        "a waits for b, which cannot be accepted",
        "b waits for a, which cannot be accepted",
    )


def test_two_instances_need_two_names():
    model = user(BinaryDimension("X"))
    with pytest.raises(EddiError) as refused:
        compose([("u", model), ("u", model)])
    assert_reported("C007", refused.value.problems)
    again = compose([("u", model), ("v", model)])
    assert again.unmatched_demands == ("u/D", "v/D")


def test_open_ends_and_exact_bounds():
    offered = numeric(("0", "inf", ")"))
    assert not compose(
        [("p", provider(offered)), ("u", user(numeric(("0", "inf", "]"))))]
    ).composable
    assert compose([("p", provider(offered)), ("u", user(numeric(("0", "1e300", "]"))))]).composable
    assert exact(Bound("0.1", 0.1)) == Fraction(1, 10)
    assert exact(Bound("1e-999999999", 0.0)) == 0


spans = st.lists(
    st.tuples(st.integers(0, 8), st.integers(1, 4), st.booleans()).map(
        lambda t: Interval(Fraction(t[0]), False, Fraction(t[0] + t[1]), t[2])
    ),
    max_size=4,
)


@given(spans, spans)
def test_inclusion_is_that_of_the_numbers(inner, outer):
    def holds(ranges, x):
        return any(r.start <= x and (x <= r.end if r.closed else x < r.end) for r in ranges)

    points = [Fraction(n, 2) for n in range(30)]
    expected = all(holds(outer, x) for x in points if holds(inner, x))
    assert is_inside(inner, outer) == expected


def test_a_mark_counts_for_the_file_that_has_it(tmp_path: Path) -> None:
    text = data_text("conserts/fallback.yml")
    (tmp_path / "A.yml").write_text(text)
    (tmp_path / "B.yml").write_text(text.replace("Stop", "Wait"))
    marks = ("--default-guarantee", "Stop", "--default-guarantee", "B/Wait")
    found = run("compose", "A.yml", "B.yml", *marks, cwd=tmp_path)
    assert (found.status, found.out.splitlines()[0]) == (0, "composable"), found.err
    wrong = run("compose", "A.yml", "B.yml", *marks, "--default-guarantee", "Sit", cwd=tmp_path)
    assert (wrong.status, wrong.err.count("[C008]")) == (2, 1)
    assert "there is no guarantee 'Sit'" in wrong.err
    (tmp_path / "n.bif").write_text(
        "network N { } variable V { type discrete [2] { y, n }; } probability (V) { table 1 0; }"
    )
    wrong = run("compose", "A.yml", "n.bif", *marks, cwd=tmp_path)
    assert (wrong.status, wrong.err.count("[C008]")) == (2, 1)


def test_text_and_json():
    x = BinaryDimension("X")
    good = compose([("u", user(x)), ("p", provider(x)), ("q", provider(x))])
    assert good.as_text() == ["composable", "order: p, q, u", "bindings:", "  u/D <- p/G or q/G"]
    guarantees = [{"instance": name, "guarantee": "G"} for name in "pq"]
    binding = {"instance": "u", "demand": "D", "guarantees": guarantees}
    assert good.as_json() == {
        "composable": True,
        "order": ["p", "q", "u"],
        "bindings": [binding],
        **{key: [] for key in ("unmatched_demands", "unmatched_services", "reasons", "warnings")},
    }
    bad = compose([("p", provider(BinaryDimension("Y"))), ("u", user(x))])
    assert bad.as_text()[:3] == ["not composable", "order: p", "reasons:"]
