"""Properties of reading and writing ConSerts, and input that nobody would write on purpose."""

import dataclasses
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.kinds.consert.checks import check_consert, static_checks
from eddi_scaffold.kinds.consert.compose import compose
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Evidence,
    Gate,
    Guarantee,
    NumericDimension,
    Propagation,
    ProvidedService,
    Range,
    RequiredService,
)
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.read_short import read_consert
from eddi_scaffold.kinds.consert.write_yaml import to_yaml
from tests.kinds.consert.example import ROVER, monitor_of
from tests.kinds.consert.test_static import consert as consert_of

pytestmark = pytest.mark.slow

TRICKY = [
    "a b",
    *["On", "no", "null", "~", "1e3", "1:30", "0x10", "1_000", "class", "ü", "-", ":", "#"],
]
texts = st.sampled_from(TRICKY) | st.text(
    st.characters(exclude_categories=("Cs",)), min_size=1, max_size=8
)
bounds = st.sampled_from(["0", "-1.50", "1e3", "+5", ".5", "1E-3", "7."]).map(
    lambda text: Bound(text, float(text))
)
ranges = st.builds(Range, bounds, bounds, st.booleans()) | st.just(
    Range(Bound("-inf", float("-inf")), Bound("inf", float("inf")), inclusive=True)
)
subsets = st.sampled_from(["Demand", "Guarantee"])
dimensions = (
    st.builds(BinaryDimension, texts)
    | st.builds(
        CategoricalDimension, texts, st.lists(texts, min_size=1, max_size=3).map(tuple), subsets
    )
    | st.builds(
        NumericDimension,
        texts,
        st.lists(ranges, min_size=1, max_size=3).map(tuple),
        subsets,
        st.sampled_from([None, "", "m", "km/h", "ns"]),
    )
)
some_dimensions = st.lists(dimensions, min_size=1, max_size=2).map(tuple)
descriptions = st.none() | texts


def tuples(strategy):
    return st.lists(strategy, max_size=3).map(tuple)


conserts = st.builds(
    ConSert,
    st.just("m"),
    tuples(
        st.builds(
            Guarantee,
            texts,
            some_dimensions,
            descriptions,
            st.booleans(),
            st.none() | st.integers(-9, 9),
        )
    ),
    tuples(st.builds(Demand, texts, some_dimensions, descriptions)),
    tuples(st.builds(Evidence, texts, dimensions, descriptions)),
    tuples(st.builds(Gate, texts, st.sampled_from(["And", "Or"]))),
    tuples(st.builds(Propagation, texts, texts)),
    tuples(st.builds(RequiredService, texts, texts, tuples(texts))),
    tuples(st.builds(ProvidedService, texts, texts, tuples(texts))),
)


@given(conserts)
def test_written_and_read_again_is_equal(consert):
    again, problems = read_consert(Source("m.yml", to_yaml(consert).encode()))
    assert problems == []
    assert again == consert


@given(conserts)
def test_checks_never_raise_and_what_is_left_can_be_used(consert):
    if has_errors(check_consert(consert)):
        return
    static_checks(consert)
    compose([("a", consert), ("b", consert)])
    (model,) = ConSertModel.read_file(Source("m.yml", to_yaml(consert).encode()), ()).models
    assert model.data == consert
    for use in (
        ConSertModel.inputs,
        ConSertModel.outline,
        ConSertModel.counts,
        ConSertModel.export,
    ):
        use(model)
    monitor_of(model)


def test_order_of_lists_changes_nothing_but_the_order():
    (model,) = ConSertModel.read_file(Source("m.yml", ROVER.encode()), ()).models
    lists = [f.name for f in dataclasses.fields(ConSert) if f.name not in ("name", "place")]
    for seed in range(20):
        shuffle = random.Random(seed)
        changed = {}
        for name in lists:
            items = list(getattr(model.data, name))
            shuffle.shuffle(items)
            changed[name] = tuple(items)
        other = dataclasses.replace(model.data, **changed)
        assert {(p.code, p.message) for p in check_consert(other)} == {
            (p.code, p.message) for p in check_consert(model.data)
        }
        assert sorted(p.message for p in static_checks(other)) == sorted(
            p.message for p in static_checks(model.data)
        )


def of_one_evidence(gates, edges):
    return consert_of(["G"], gates, " ".join(map(">".join, edges)), leaves="E")


def test_a_ladder_of_shared_gates_is_linear():
    """Two gates per level, each fed by both of the level below: 2 ** 500 paths."""
    gates, edges, below = [], [], ("E", "E")
    for level in range(500):
        pair = (f"a{level}", f"o{level}")
        gates += [f"{pair[0]}&", f"{pair[1]}|"]
        edges += [(source, target) for target in pair for source in dict.fromkeys(below)]
        below = pair
    edges += [(source, "G") for source in below]
    consert = of_one_evidence(gates, edges)
    assert not has_errors(check_consert(consert))
    static_checks(consert)
    model = ConSertModel.read_file(Source("m.yml", to_yaml(consert).encode()), ()).models[0]
    assert len(model.outline()) < 3_000


@pytest.mark.parametrize("count", [2, 20])
def test_every_knot_is_reported_once(count):
    edges = [("E", "G")]
    for n in range(count):
        edges += [(f"a{n}", f"b{n}"), (f"b{n}", f"a{n}"), (f"a{n}", f"a{n + 1}")]
    gates = [f"{kind}{n}&" for n in range(count + 1) for kind in "ab"]
    problems = check_consert(of_one_evidence(gates, edges))
    cycles = [problem.message for problem in problems if problem.code == "C010"]
    assert cycles == [f"cycle: a{n} -> b{n} -> a{n}" for n in range(count)]
