"""Literals, names and brackets: nothing of a model becomes code, and the formatter agrees."""

import ast
import math

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.program.python_text import (
    Group,
    Item,
    assignment,
    call,
    comment,
    literal,
    number,
    text_literal,
    tuple_of,
    variables,
)
from tests.program.formatting import objections

anything = st.text(st.characters())


@given(anything)
def test_a_text_comes_back_from_its_literal(text):
    made = text_literal(text)
    assert ast.literal_eval(made) == text
    assert made.isascii()
    assert "\n" not in made


@given(st.floats())
def test_a_number_comes_back_from_its_literal(value):
    found = eval(number(value), {"INF": math.inf, "NAN": math.nan})
    assert found == value or math.isnan(value)
    assert math.copysign(1, found) == math.copysign(1, value) or math.isnan(value)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | anything | st.floats(allow_nan=False),
    lambda inner: st.lists(inner) | st.dictionaries(anything, inner) | st.tuples(inner, inner),
    max_leaves=30,
)


@given(json_values)
def test_a_value_comes_back_from_its_lines(value):
    names: dict[str, object] = {"INF": math.inf}
    exec("\n".join(assignment("x", literal(value), 0)), names)
    assert names["x"] == value


@given(anything)
def test_a_comment_is_one_line_of_ascii(text):
    made = comment(text)
    assert len(made) <= 70
    assert all(" " <= one <= "~" for one in made)


@given(st.lists(anything | st.sampled_from(["self", "v0", "v1", "a", "class"]), unique=True))
def test_variables_are_identifiers_and_differ(ids):
    names = variables(ids, {"self", "v1"})
    assert len(set(names)) == len(ids)
    assert all(one.isidentifier() and one not in ("self", "class") for one in names)


def test_brackets_are_as_the_formatter_lays_them():
    short = tuple_of(["1"])
    commented = tuple_of([Item("1", behind="one"), Item(short, above="two")])
    wide = tuple_of([Group("{", (Item(text_literal("x" * 60), '"key": '),), "}")] * 3)
    lines = [
        *assignment("a", short, 0),
        *assignment("b", commented, 0),
        *assignment("c", wide, 0),
        *assignment("d", call("dict", [], x=short, y=wide), 0),
        *assignment("e", tuple_of([]), 0),
        *assignment("f", literal('it\'s "quoted"'), 0),
    ]
    assert objections("\n".join(lines) + "\n") == ""
