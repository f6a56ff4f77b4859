"""The uses of a condition's variables: nothing that can bring it about is left out."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.uses import uses
from tests.data_files import tabled

VARIABLES = "VAR a : BOOL TIMEOUT 1s\nVAR b : BOOL TIMEOUT 1s\nVAR v : NUMBER TIMEOUT 1s\n"
VALUES = {"a": (False, True), "b": (False, True), "v": (0, 1, 2)}


def uses_of(text: str, *, side: bool = True) -> dict[str, list[list[list[object]]]]:
    analysis = analyse(f"{VARIABLES}EVENT e (EVIDENCE) := {text}", rate=10)
    assert analysis.program is not None, analysis.problems
    (result,) = analysis.program.results
    return {
        name: [
            [[x for x in VALUES[name] if use.holds(x)], [n for n, _ in use.companions]]
            for use in all_
        ]
        for name, all_ in uses(analysis.program, result.operation, side=side).items()
    }


@tabled
def test_what_brings_a_condition_about(text: str, expected: object) -> None:
    assert dict(sorted(uses_of(text).items())) == expected


def test_what_makes_it_false() -> None:
    assert uses_of("a AND v < 1", side=False) == {"a": [[[False], []]], "v": [[[1, 2], []]]}


def conditions() -> st.SearchStrategy[str]:
    leaves = st.sampled_from(["a", "b", "v == 1", "v < 2", "v != 0", "1 <= v"])
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            inner.map("(NOT ({}))".format),
            st.tuples(inner, st.sampled_from(["AND", "OR", "XOR", "IMPLIES"]), inner).map(
                lambda t: f"(({t[0]}) {t[1]} ({t[2]}))"
            ),
        ),
        max_leaves=6,
    )


@given(conditions(), st.booleans())
def test_a_value_that_no_use_allows_never_decides(text: str, side: bool) -> None:
    """Setting a variable to a value that passes no test cannot bring the wanted side about."""
    python = text
    for word, operator in (("AND", "and"), ("XOR", "!="), ("OR", "or"), ("IMPLIES", "<=")):
        python = python.replace(word, operator)
    python = python.replace("NOT", "not")
    allowed = uses_of(text, side=side)
    worlds = [dict(zip(VALUES, w, strict=True)) for w in itertools.product(*VALUES.values())]
    truth = {tuple(w.values()): _value(python, w) is side for w in worlds}
    for world in worlds:
        for name, values in VALUES.items():
            mine = [x for tested, _ in allowed.get(name, []) for x in tested]
            for value in values:
                changed = {**world, name: value}
                if value not in mine and truth[tuple(changed.values())]:
                    # it holds with the value, so it must hold with every other one
                    others = [{**world, name: other} for other in values]
                    assert all(truth[tuple(o.values())] for o in others), (text, world, name, value)


def _value(text: str, world: dict[str, object]) -> bool:
    """Evaluate by Python's operators: XOR is !=, IMPLIES is <= on truth values."""
    return bool(eval(text, {}, dict(world)))
