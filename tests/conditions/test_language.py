"""The language: every diagnostic with its exact place and text, types, units, names, limits."""

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER, Variable
from eddi_scaffold.conditions.syntax import canonical
from eddi_scaffold.program.instructions import Program
from tests.conditions.formulas import DECLARATIONS, RATE, Formulas
from tests.data_files import tabled

KNOWN = {
    "x": Variable("x", NUMBER),
    "y": Variable("y", NUMBER),
    "d": Variable("d", NUMBER, "m"),
    "e": Variable("e", NUMBER, "km"),
    "temp": Variable("temp", NUMBER, "degC"),
    "a": Variable("a", BOOL),
    "b": Variable("b", BOOL),
}


def problems(text: str, *, rate: float | None = 10, known: bool = True) -> list[str]:
    analysis = analyse(text, rate=rate, variables=KNOWN if known else None)
    return [f"{p.place.line}:{p.place.col} {p.case}" for p in analysis.problems]


TABLES = Path(__file__).with_name("language.txt").read_text("utf-8").split("\n\n")
ALL = [
    pytest.param(*row.split(" | "), rate, known, id=row)
    for table, rate, known in zip(TABLES, (10, None, 10), (True, False, False), strict=True)
    for row in table.strip().splitlines()[1:]
]


@pytest.mark.parametrize(("expected", "text", "rate", "known"), ALL)
def test_diagnostics(expected: str, text: str, rate: float | None, known: bool) -> None:
    result = problems(text.replace("\\n", "\n"), rate=rate, known=known)
    assert " + ".join(entry for entry in result if "E026" not in entry) == expected


def test_every_error_of_a_file_is_told_at_once() -> None:
    lines = ("p (HAZARD) := x >", "q (HAZARD) := y + a", "r (HAZARD) := AND", "s (HAZARD) := p")
    text = "\n".join(f"EVENT {line}" for line in lines)
    # nothing on s: that p is not there follows from the first
    assert problems(text) == ["1:24 E001.word", "2:25 E007.operand", "3:21 E001.word"]


def program_of(text: str) -> Program:
    result = analyse(text, rate=10, variables=KNOWN)
    assert result.program is not None, result.problems
    return result.program


def constants(text: str) -> list[float]:
    return [row.value for row in program_of(text).operations if row.op == "number"]


@tabled
def test_units_and_constants_are_computed_once(text: str, numbers: list[float]) -> None:
    assert constants(text) == pytest.approx(numbers, rel=1e-15)


def test_equal_expressions_are_one_node() -> None:
    program = program_of("MAX(x, 1s) > 5 AND NOT (MAX(x, 1s) > 5) OR MAX(x, 1000ms) > 6")
    assert [row.op for row in program.operations].count("max") == 1


def test_words_are_names_where_they_can_be() -> None:
    text = (
        "VAR time.max : NUMBER TIMEOUT 1s VAR range : NUMBER TIMEOUT 1s\nMAX (time.max, 1s) > range"
    )
    assert problems(text, known=False) == []
    assert problems("a.and.or > 5 AND x.NOT == TRUE", known=False) == []


@pytest.mark.parametrize("rate", [0, -1, float("nan"), float("inf"), 1e10])
def test_a_rate_that_is_none(rate: float) -> None:
    with pytest.raises(EddiError) as caught:
        analyse("a", rate=rate)
    assert caught.value.problems[0].code == "E005"


# limits


def test_nesting_is_limited() -> None:
    good = "(" * 98 + "a" + ")" * 98
    assert problems(good) == []
    deep = "(" * 5000 + "a" + ")" * 5000
    assert problems(deep) == ["1:101 E013.depth"]


def test_length_is_limited() -> None:
    assert problems("a " * 40000) == ["1:1 E013.text"]
    assert problems("a OR " * 9000 + "a") == []


# properties


def test_printing_and_reading_round_trip() -> None:
    rounds = 10_000 if settings.default.max_examples > 1000 else 500
    rng = random.Random(7)
    formulas = Formulas(rng)
    for _ in range(rounds):
        text = formulas.boolean(rng.randint(0, 4))
        file = parse(text)
        once = canonical(file, file.events[0].root)
        again = parse(once)
        assert canonical(again, again.events[0].root) == once
        assert [(n.op, n.args) for n in again.nodes] == [(n.op, n.args) for n in file.nodes]


SEEDS = (
    DECLARATIONS + "EVENT e (HAZARD) := AVERAGE(x, 5s, COVERAGE 0.5) > 100 AND TIME(a, 5s)",
    "MAX(temp1,10s) + MAX(temp2,10s) / 2 > AVERAGE(core,10s) // a comment",
    "ENUM M { P, Q } VAR m.n[3] : M TIMEOUT 1s CONST k = -5 m m.n[3] == P",
)
PIECES = st.sampled_from(
    ["é", "😀", "\0", "1e5", "5s", "UNKNOWN", "MAX(", "EVENT ", "9" * 50, ".."]
)


@settings(max_examples=max(300, settings.default.max_examples))
@given(
    st.sampled_from(SEEDS),
    st.lists(
        st.tuples(st.integers(0, 200), st.integers(0, 6), PIECES | st.text(max_size=2)), max_size=5
    ),
)
def test_mutated_texts_have_problems_with_places(
    text: str, edits: list[tuple[int, int, str]]
) -> None:
    for at, cut, piece in edits:
        text = text[:at] + piece + text[at + cut :]
    check_places(text)


def check_places(text: str) -> None:
    result = analyse(text, rate=RATE)
    lines = text.split("\n")
    for problem in result.problems:
        assert problem.place.line is not None
        assert problem.place.col is not None
        assert 1 <= problem.place.line <= len(lines)
        assert 1 <= problem.place.col <= len(lines[problem.place.line - 1]) + 1
    assert (result.program is None) == any(p.level == "error" for p in result.problems)


@tabled
def test_one_side_has_the_type_of_the_other(text: str, expected: dict[str, object]) -> None:
    result = analyse(text, rate=10)
    assert [entry.message for entry in result.problems] == []
    assert {entry.name: entry.type.kind for entry in result.variables} == expected


@pytest.mark.parametrize("text", ["x == y", "KNOWN(x)", "x == y AND y == z AND z == x"])
def test_what_no_use_decides_is_asked_for(text: str) -> None:
    result = analyse(text, rate=10)
    assert result.program is None
    assert {entry.code for entry in result.problems} == {"E008"}
