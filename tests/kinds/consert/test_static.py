"""Static checks: what follows from the trees of a ConSert whatever the evidence."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    ConSert,
    Evidence,
    Gate,
    Guarantee,
    Propagation,
    ProvidedService,
)
from eddi_scaffold.kinds.consert.graph import constants, path_sets
from eddi_scaffold.kinds.consert.static_checks import static_checks

B = BinaryDimension("T")


def consert(guarantees, gates, edges, leaves="abc", services=()):
    return ConSert(
        "C",
        tuple(Guarantee(g, (B,)) if isinstance(g, str) else g for g in guarantees),
        (),
        tuple(Evidence(leaf, B) for leaf in leaves),
        tuple(Gate(id_, function) for id_, function in gates),
        tuple(Propagation(*edge.split(">")) for edge in edges.split()),
        (),
        tuple(ProvidedService(f"S{n}", "T", tuple(ids)) for n, ids in enumerate(services)),
    )


def found(model):
    return [(problem.level, problem.code, problem.message) for problem in static_checks(model)]


def test_constants():
    model = consert(["T", "F"], [("t", "And"), ("f", "Or")], "t>T f>F a>F a>t2", services=[])
    assert found(model) == [
        ("warning", "S001", "guarantee 'T' is always active, whatever the evidence"),
        ("warning", "S001", "guarantee 'F' is never active, whatever the evidence"),
        ("info", "S002", "no guarantee depends on 'a', although it is connected"),
    ]


def test_redundant_leaf_and_gate():
    model = consert(["G"], [("o", "Or")], "a>o b>o a>G o>G")
    assert found(model) == [
        ("info", "S002", "no guarantee depends on 'b', although it is connected"),
        ("info", "S002", "gate 'o' changes nothing given the other inputs"),
    ]


def test_equal_functions_and_implication():
    model = consert(["G", "H", "I"], [], "a>G a>H b>H a>I b>I", services=["GHI"])
    assert found(model) == [
        ("info", "S003", "guarantees 'H' and 'I' are active under the same conditions"),
        ("info", "S003", "guarantee 'H' implies 'G'"),
        ("info", "S003", "guarantee 'I' implies 'G'"),
        (
            "info",
            "S007",
            (
                "provided service 'S0' needs 'a' in every case: "
                "without it no guarantee of the service is active"
            ),
        ),
    ]


def test_ranking_against_implication_and_two_defaults():
    weak, strong = Guarantee("W", (B,), ranking=1), Guarantee("S", (B,), ranking=2)
    defaults = [Guarantee(id_, (B,), default=True) for id_ in "DE"]
    model = consert(
        [weak, strong, *defaults], [("o", "Or")], "a>o b>o o>W a>S b>S", services=["WSDE"]
    )
    assert found(model) == [
        ("warning", "S005", "provided service 'S0' has several default guarantees: 'D', 'E'"),
        ("info", "S003", "guarantee 'S' implies 'W'"),
        (
            "warning",
            "S005",
            "guarantee 'S' implies 'W', which is ranked better: 'S' is never the best",
        ),
    ]


def test_beyond_the_cap_nothing_is_said():
    pairs = [(f"l{n}", f"r{n}") for n in range(12)]
    gates = [(f"o{n}", "Or") for n in range(12)]
    edges = " ".join(f"l{n}>o{n} r{n}>o{n} o{n}>G" for n in range(12))
    model = consert(["G"], gates, edges, leaves=[leaf for pair in pairs for leaf in pair])
    assert found(model) == [
        ("info", "S000", "guarantee 'G' has more than 256 minimal sets of evidence: not compared")
    ]


@st.composite
def random_conserts(draw):
    leaves, gates = "abcde", [f"g{n}" for n in range(draw(st.integers(0, 6)))]
    edges = []
    for index, node in enumerate([*gates, "G", "H"]):
        below = [*leaves, *gates[: min(index, len(gates))]]
        sources = draw(st.lists(st.sampled_from(below), max_size=4, unique=True))
        edges += [f"{source}>{node}" for source in sources]
    functions = [(gate, draw(st.sampled_from(["And", "Or"]))) for gate in gates]
    return consert(["G", "H"], functions, " ".join(edges), leaves=leaves, services=["GH"])


def evaluated(model, true_leaves):
    sources = {}
    for edge in model.tree_propagations:
        sources.setdefault(edge.target, []).append(edge.source)
    functions = {gate.id: any if gate.function == "Or" else all for gate in model.gates}
    values = {leaf.id: leaf.id in true_leaves for leaf in model.evidence}
    for id_ in [*functions, "G", "H"]:
        values[id_] = functions.get(id_, all)([values[s] for s in sources.get(id_, ())])
    return values


@given(random_conserts())
def test_path_sets_say_all_about_a_node(model):
    sets, fixed = path_sets(model), constants(model)
    outcomes = {id_: set() for id_ in sets}
    for bits in itertools.product([False, True], repeat=5):
        true_leaves = {leaf for leaf, bit in zip("abcde", bits, strict=True) if bit}
        mask = sum(1 << n for n, bit in enumerate(bits) if bit)
        for id_, value in evaluated(model, true_leaves).items():
            assert value == any(one & mask == one for one in sets[id_])
            outcomes[id_].add(value)
    for id_, values in outcomes.items():
        assert fixed[id_] == (values.pop() if len(values) == 1 else None)
    static_checks(model)
