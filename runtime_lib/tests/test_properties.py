"""What holds for every ConSert and every input."""

import itertools
from fractions import Fraction

from eddi_runtime.why import TRUE
from hypothesis import given
from hypothesis import strategies as st

from runtime_lib.tests.conserts import (
    active,
    categorical,
    consert,
    give,
    monitor,
    numeric,
    one_leaf,
)

VALUES = {"F": False, "U": None, "T": True}


@st.composite
def graphs(draw, max_leaves=7):
    """Return (leaves, gates, guarantees, edges); every gate and guarantee has an input."""
    leaves = [f"e{k}" for k in range(draw(st.integers(1, max_leaves)))]
    gates = [f"g{k}" + draw(st.sampled_from("&|")) for k in range(draw(st.integers(0, 6)))]
    guarantees = [f"G{k}" for k in range(draw(st.integers(1, 3)))]
    below, edges = list(leaves), []
    for name in [gate[:-1] for gate in gates] + guarantees:
        size = st.integers(1, min(4, len(below)))
        sources = draw(st.permutations(below))[: draw(size)]
        edges += [f"{source}>{name}" for source in sources]
        below.append(name)
    return leaves, gates, guarantees, edges


def made(graph, **settings):
    leaves, gates, guarantees, edges = graph
    return monitor(leaves, gates=gates, guarantees=guarantees, edges=edges, **settings)


def two_valued(graph, true):
    """Evaluate with sets of names: the plainest reference."""
    _, gates, guarantees, edges = graph
    kinds = {gate[:-1]: gate[-1] for gate in gates}
    holding = set(true)
    for name in [*kinds, *guarantees]:
        sources = [edge.split(">")[0] for edge in edges if edge.split(">")[1] == name]
        test = any if kinds.get(name) == "|" else all
        if test(source in holding for source in sources):
            holding.add(name)
    return [name for name in guarantees if name in holding]


def states(graph):
    return st.fixed_dictionaries({leaf: st.sampled_from("FUT") for leaf in graph[0]})


def cases(**kwargs):
    return graphs(**kwargs).flatmap(lambda graph: st.tuples(st.just(graph), states(graph)))


def step(one, state):
    rows = one.execute_step(give(**{name: VALUES[letter] for name, letter in state.items()}))
    return active(rows)


@given(cases())
def test_kleene_is_two_valued_logic_from_both_sides(case):
    graph, state = case
    one = made(graph)
    found = step(one, state)
    true = [name for name, letter in state.items() if letter == "T"]
    not_false = [name for name, letter in state.items() if letter != "F"]
    assert found == two_valued(graph, true)
    possible = [name for name, verdict in one.verdicts().items() if verdict != "FALSE"]
    assert possible == two_valued(graph, not_false)
    assert found == [name for name, verdict in one.verdicts().items() if verdict == "TRUE"]


@given(cases(), st.randoms())
def test_the_order_of_lists_changes_nothing_but_the_order(case, random):
    graph, state = case
    leaves, gates, guarantees, edges, order = (
        random.sample(part, len(part)) for part in (*graph, graph[0])
    )
    mixed = consert(leaves, (), gates, guarantees, edges, order=order)
    one, other = made(graph), mixed.monitor()
    assert set(step(one, state)) == set(step(other, state))
    assert one.verdicts() == other.verdicts()
    for name in graph[2]:
        assert one.explain(name) == other.explain(name)


def subsets(names):
    return itertools.chain.from_iterable(
        itertools.combinations(names, size) for size in range(len(names) + 1)
    )


def minimal_sets(names, works):
    """Return every minimal subset that works, by brute force, by size and then by ids."""
    found = []
    for group in sorted(subsets(sorted(names)), key=lambda one: (len(one), one)):
        if not any(set(one) <= set(group) for one in found) and works(set(group)):
            found.append(group)
    return tuple(found)


@given(cases(max_leaves=10))
def test_explanations_are_those_of_brute_force(case):
    graph, state = case
    one = made(graph)
    step(one, state)
    true = {name for name, letter in state.items() if letter == "T"}
    for found in one.explain():
        name = found.guarantee
        assert found.active == (name in two_valued(graph, true))
        assert not found.truncated
        if found.active:
            wanted = minimal_sets(
                true, lambda lost, g=name: g not in two_valued(graph, true - lost)
            )
            assert found.single_losses == tuple(group[0] for group in wanted if len(group) == 1)
            assert found.missing == ()
        else:
            false = set(graph[0]) - true
            wanted = minimal_sets(false, lambda more, g=name: g in two_valued(graph, true | more))
            assert found.missing == wanted
            assert found.reasons.keys() == {leaf for group in wanted for leaf in group}
            assert found.single_losses == ()


@given(cases())
def test_sets_that_are_written_down_and_those_that_are_searched_are_the_same(case):
    graph, state = case
    one = made(graph)
    searched = monitor(graph[0], gates=graph[1], guarantees=graph[2], edges=graph[3], limit=0)
    assert one.graph is None
    assert searched.graph is not None
    for each in (one, searched):
        step(each, state)
    assert one.explain() == searched.explain()
    sentences = [[row.sentence for row in each.why().values()] for each in (one, searched)]
    assert sentences[0] == sentences[1]
    assert one.status_message() == searched.status_message()


@given(cases())
def test_what_is_named_first_brings_a_guarantee_nearer_once_it_is_good(case):
    one, state = made(case[0]), dict(case[1])
    step(one, state)
    for id_, why in one.why().items():
        sets = one._sets()
        place = one.published_ids.index(id_)
        if why.causes[:1] and why.causes[0].path:
            before, good = nearest(one, place), {**state, why.causes[0].path[0]: "T"}
            step(one, good)
            assert nearest(one, place) < before
            step(one, state)
        assert (why.verdict == TRUE) == (sets.value(one.guarantees[place]) == TRUE)


def nearest(one, place):
    """Return how far the nearest set of inputs is from TRUE, whichever it is."""
    values = dict(zip([spec.id for spec in one.inputs], one._leaf_values()))
    groups = one._sets().missing(one.guarantees[place])[0]
    return min([(-min([values[k] for k in g]), len(g)) for g in groups], default=(-TRUE, 0))


SAMPLES = st.lists(st.sampled_from("FUT"), max_size=30)


@given(SAMPLES, st.integers(1, 6))
def test_debounce_by_its_definition(samples, needed):
    one = monitor(["x"], guarantees=["G"], edges=["x>G"], filtered=("debounce", needed))
    for k, sample in enumerate(samples):
        step(one, {"x": sample})
        last = samples[max(0, k + 1 - needed) : k + 1]
        not_true = [one_sample for one_sample in samples[: k + 1] if one_sample != "T"]
        held = not_true[-1] if not_true else "U"
        wanted = "T" if len(last) == needed and set(last) == {"T"} else held
        assert one.verdicts()["G"][0] == wanted


@given(SAMPLES, st.integers(1, 6))
def test_majority_by_its_definition(samples, window):
    one = monitor(["x"], guarantees=["G"], edges=["x>G"], filtered=("majority", window))
    for k, sample in enumerate(samples):
        step(one, {"x": sample})
        last = samples[max(0, k + 1 - window) : k + 1]
        true, unknown = last.count("T"), last.count("U")
        wanted = "T" if 2 * true > len(last) else "U" if 2 * (true + unknown) > len(last) else "F"
        assert one.verdicts()["G"][0] == wanted


class Hostile:
    def __init__(self, lie):
        self.lie = lie

    def answer(self, *args):
        if self.lie is Exception:
            raise self.lie("hostile")
        return self.lie

    __bool__ = __eq__ = __lt__ = __le__ = __gt__ = __ge__ = __float__ = __int__ = answer
    __index__ = __str__ = __repr__ = __len__ = __iter__ = __contains__ = answer
    __hash__ = answer


ANY_VALUE = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.integers(10**300, 10**400),
    st.floats(allow_nan=True, allow_infinity=True),
    st.text(max_size=4),
    st.sampled_from(["low", "ok"]),
    st.binary(max_size=3),
    st.lists(st.booleans(), max_size=2),
    st.fractions(),
    st.decimals(),
    st.sampled_from([Exception, True, False, 1, 1.0, "low", None]).map(Hostile),
    st.sampled_from([object, type, int, len, NotImplemented, ...]),
)


def is_true(name, value):
    if name == "n":
        return type(value) in (int, float) and (0 <= value <= 10 or 20 <= value < 30)
    return type(value) is str and value in ("low", "ok") if name == "c" else value is True


@given(st.fixed_dictionaries({}, optional=dict.fromkeys("abcnd", ANY_VALUE)))
def test_no_input_raises_or_activates_without_support(values):
    one = monitor(
        ["a", "b", ("c", categorical("low", "ok")), ("n", numeric("[0, 10]", "[20, 30)"))],
        ["d"],
        gates=["or1|", "and1&", "or2|"],
        guarantees=["G", "H"],
        edges=[
            "a>or1",
            "b>or1",
            "or1>and1",
            "c>and1",
            "n>and1",
            "and1>or2",
            "d>or2",
            "or2>G",
            "a>H",
            "G>H",
        ],
    )
    true = {name for name, value in values.items() if is_true(name, value)}
    rows = one.execute_step(give(**values))
    assert [type(row["active"]) for row in rows] == [bool, bool]
    given_g = bool(true & {"a", "b"} and {"c", "n"} <= true) or "d" in true
    assert active(rows) == ["G"] * given_g + ["H"] * (given_g and "a" in true)
    one.explain()
    assert [name for name, *_ in one._whys()] == ["G", "H"]
    assert set(one.faults()) <= set(values)
    one.message(rows)
    one.status_message()


@given(
    st.integers(-(10**6), 10**6),
    st.integers(0, 10**6),
    st.integers(0, 6),
    st.sampled_from([(1, 1), (18, 5), (5, 18), (1000, 1), (1, 10**9), (1, 3)]),
    st.booleans(),
    st.data(),
)
def test_bounds_with_factor_are_nearest_doubles(start, size, digits, factor, closed, data):
    scale = Fraction(1, 10**digits)
    texts = [f"{number}e-{digits}" for number in (start, start + size)]
    low, high = (float(n * scale / Fraction(*factor)) for n in (start, start + size))
    end = "]" if closed else ")"
    one = one_leaf(numeric(f"[{texts[0]}, {texts[1]}{end}"), factor=list(factor))
    value = data.draw(st.sampled_from([low, high]) | st.floats(low, high))
    assert one.step(give(x=value)) == (low <= value <= high if closed else low <= value < high,)
