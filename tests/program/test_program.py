"""The instruction set: what the page lists is what front ends make and back ends print."""

import ast
import math
import re

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.program import instructions
from eddi_scaffold.program.c_step import CStep
from eddi_scaffold.program.instructions import (
    BOOL,
    FILTERS,
    LEAVES,
    NUMBER,
    SIGNATURES,
    TEXT,
    Interval,
    Operation,
    Program,
    Read,
    Result,
    reads_of_results,
)
from eddi_scaffold.program.python_step import JUDGEMENTS, Printer
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
from eddi_scaffold.program.running import Engine
from eddi_scaffold.program.standalone import named
from runtime_lib.tests.event.event_models import form
from tests.program.formatting import objections


def test_no_word_of_a_form_becomes_code():
    evil = '"); import os; os.abort() #'
    named = {"x": {"name": evil}, "m": {"literals": (evil,)}}
    found = form(("gt", "x", 5), ("eq_enum", "m", ("literal", 0)), variables=("x", "m"), **named)
    results = tuple(result._replace(id=evil) for result in found.results)
    engine = Engine(found._replace(results=results))
    assert engine.step(0, [6.0, evil]) == (2, 2)
    assert engine.step(1, [4.0, "else"]) == (0, 1)


def test_which_reads_decide_a_result():
    program = form(("gt", "x", 5), ("or", "a", ("gt", ("age", "y"), 1)))
    assert reads_of_results(program) == [[0], [1, 2]]


_VALUES = {
    "variable": 0,
    "number": 1.0,
    "truth": 2,
    "literal": 0,
    "age": 0,
    "is_covered": ("a",),
    "is_within": (Interval(0.0, 1.0, True),),
    "debounce": 3,
    "majority": 3,
}
_READ = {"is_covered": TEXT, "is_within": NUMBER}


def everything() -> set[str]:
    return {*SIGNATURES, *LEAVES, *JUDGEMENTS, *FILTERS}


def test_the_list_is_complete() -> None:
    _, table, _ = re.split(r"(?s)\n=+ +=+\n", instructions.__doc__ or "")
    first = re.findall(r"(?m)^``(.*?)``", table)
    listed = {word for words in first for word in words.split()}
    assert {one.removesuffix("_bool").removesuffix("_enum") for one in everything()} == listed


def test_each_operation_is_printed_by_both_back_ends() -> None:
    silent = set()
    for op in sorted(everything() - set(LEAVES)):
        types, type_ = SIGNATURES.get(op, ((_READ.get(op, BOOL),), BOOL))
        read = tuple(Read(f"x{k}", one, stamped=True) for k, one in enumerate(types or (NUMBER,)))
        leaves = [Operation("variable", (), one.type, k) for k, one in enumerate(read)]
        window = {"window": 10, "capacity": 4} if op in instructions.WINDOWS else {}
        done = Operation(op, tuple(range(len(types))), type_, _VALUES.get(op), op, **window)
        last = Result("y", len(leaves))
        program = Program(1, read, (*leaves, done), (last,))
        in_python = Printer(program, [one.name for one in read]).operations()
        in_c = CStep(named(program, "one", [])).statements()
        result = f"r{len(leaves)}"
        silent |= {op} if not any(result in line for line in in_python) else set()
        silent |= {op} if not any(f"{result} = " in line for line in in_c) else set()
    assert silent == set()


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
