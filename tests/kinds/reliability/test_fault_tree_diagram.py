"""Diagrams against the sum over all combinations of events."""

import random
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.kinds.reliability.decision_diagram import build
from eddi_scaffold.kinds.reliability.fault_tree import Gate, TooLargeError, minimal_cut_sets
from tests.kinds.reliability.trees import compiled


def happens(gates, state):
    values = list(state)
    for gate in gates:
        below = [values[i] for i in gate.of]
        values.append(
            {
                "OR": any(below),
                "AND": bool(below) and all(below),
                "NOT": not (below and below[0]),
                "XOR": sum(below) % 2 == 1,
                "VOTE": sum(below) >= gate.k,
            }[gate.type]
        )
    return values[-1]


def enumerated(gates, q):
    total = 0.0
    for state in product((False, True), repeat=len(q)):
        if happens(gates, state):
            weight = 1.0
            for p, is_true in zip(q, state, strict=True):
                weight *= p if is_true else 1.0 - p
            total += weight
    return total


def random_tree(chance, coherent):
    events = chance.randint(1, 8)
    gates = []
    for i in range(chance.randint(1, 7)):
        kinds = ["OR", "AND", "VOTE"] + ([] if coherent else ["XOR", "NOT"])
        kind = chance.choice(kinds)
        count = 1 if kind == "NOT" else chance.randint(1, 4)
        of = tuple(chance.randrange(events + i) for _ in range(count))
        gates.append(Gate(kind, of, chance.randint(1, count) if kind == "VOTE" else 0))
    return events, gates


@pytest.mark.slow
@pytest.mark.parametrize("coherent", [True, False])
def test_random_trees_equal_enumeration(coherent):
    chance = random.Random(7)
    for _ in range(300):
        events, gates = random_tree(chance, coherent)
        top = events + len(gates) - 1
        tree = compiled(build(events, gates, top), events)
        q = [chance.random() * 10 ** -chance.randint(0, 3) for _ in range(events)]
        expected = enumerated(gates, q)
        assert tree.failure(q) == pytest.approx(expected, rel=1e-12, abs=0.0)
        assert tree.survival(q) == pytest.approx(1.0 - expected, abs=1e-12)
        assert tree.interval(q, q) == pytest.approx((expected, expected), rel=1e-12)


def test_intervals_of_unknown_events_hold_every_completion_and_are_exact():
    chance = random.Random(8)
    for _ in range(150):
        events, gates = random_tree(chance, coherent=False)
        unknown = frozenset(i for i in range(events) if chance.random() < 0.4)
        tree = compiled(build(events, gates, events + len(gates) - 1, unknown), events)
        q = [chance.random() for _ in range(events)]
        low = [0.0 if i in unknown else p for i, p in enumerate(q)]
        high = [1.0 if i in unknown else p for i, p in enumerate(q)]
        found = []
        for state in product((0.0, 1.0), repeat=len(unknown)):
            some = dict(zip(sorted(unknown), state, strict=True))
            found.append(enumerated(gates, [some.get(i, p) for i, p in enumerate(q)]))
        expected = (min(found), max(found))
        assert tree.interval(low, high) == pytest.approx(expected, rel=1e-12, abs=1e-300)


def test_minimal_cut_sets_equal_brute_force():
    chance = random.Random(9)
    for _ in range(200):
        events, gates = random_tree(chance, coherent=True)
        known = {i: chance.random() < 0.5 for i in range(events) if chance.random() < 0.2}
        found = minimal_cut_sets(events, gates, events + len(gates) - 1, known.items())
        failing = [
            frozenset(i for i, is_true in enumerate(state) if is_true and i not in known)
            for state in product((False, True), repeat=events)
            if all(state[i] == is_true for i, is_true in known.items()) and happens(gates, state)
        ]
        minimal = {one for one in failing if not any(other < one for other in failing)}
        assert set(found) == minimal
        assert [len(one) for one in found] == sorted(len(one) for one in found)


def test_cut_sets_need_a_coherent_tree_and_an_end():
    assert minimal_cut_sets(2, [Gate("XOR", (0, 1))], 2) is None
    pairs = [Gate("OR", (2 * i, 2 * i + 1)) for i in range(12)]
    tree = [*pairs, Gate("AND", tuple(range(24, 36)))]
    assert minimal_cut_sets(24, tree, 36, work=1000) is None
    assert len(minimal_cut_sets(24, tree, 36)) == 4096


def test_the_limit_counts_nodes_on_the_way():
    pairs = [Gate("AND", (i, 10 + i)) for i in range(10)]
    tree = [*pairs, Gate("OR", tuple(range(20, 30)))]
    build(20, tree, 30)
    shared = [Gate("OR", tuple(range(0, 20, 2))), Gate("VOTE", tuple(range(20)), 10)]
    tree = [*shared, Gate("AND", (20, 21))]
    with pytest.raises(TooLargeError):
        build(20, tree, 22, limit=50)


def test_a_basic_event_alone_and_an_empty_gate():
    for gates, expected in (([], 0.25), ([Gate("OR", ())], 0.0), ([Gate("AND", ())], 0.0)):
        assert compiled(build(1, gates, len(gates)), 1).failure([0.25]) == expected


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.booleans(), st.booleans())
def test_constants_are_put_in_and_change_no_value(seed, coherent, observed):
    chance = random.Random(seed)
    events, gates = random_tree(chance, coherent)
    known = {i: chance.random() < 0.5 for i in range(events) if chance.random() < 0.4}
    first = frozenset(i for i in range(events) if observed and i not in known)
    diagram = build(events, gates, events + len(gates) - 1, first, known=tuple(known.items()))
    q = [float(known[i]) if i in known else chance.random() for i in range(events)]
    found = compiled(diagram, events).failure(q)
    assert found == pytest.approx(enumerated(gates, q), rel=1e-12, abs=1e-300)
    assert {event for event, _, _ in diagram.nodes}.isdisjoint(known)


def test_large_diagrams_are_evaluated_without_text():
    gates = [Gate("VOTE", (0, 1, 2), 2), Gate("AND", (3, 4)), Gate("OR", (5, 6))]
    diagram = build(5, gates, 7)
    q = [0.1, 0.2, 0.3, 0.4, 0.5]
    written, looped = compiled(diagram, 5), compiled(diagram, 5, limit=0)
    assert looped.failure(q) == pytest.approx(written.failure(q), rel=1e-15)
    assert looped.survival(q) == pytest.approx(written.survival(q), rel=1e-15)
