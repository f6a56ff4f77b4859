"""The language: every diagnostic with its exact place and text, types, units, names, limits."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions import Variable, analyse
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER
from eddi_scaffold.conditions.syntax import canonical
from eddi_scaffold.program.instructions import Program
from tests.conditions.formulas import DECLARATIONS, RATE, Formulas

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


OF_KNOWN_VARIABLES = r"""
1:7 E001.character | x > 5 & a
1:10 E001.word | x > 5 AND
1:7 E001.word | (x > 5
1:6 E001.word | a == NOT b
1:7 E001.rest | x > 5 y
1:7 E001.chain | x < 5 < y
1:8 E005.duration | MAX(x, y) > 1
1:8 E005.no_time | MAX(x, 0s) > 1
1:8 E005.short_window | MAX(x, 50ms) > 1
1:1 E006.unknown_function | MAXX(x, 5s) > 1
1:1 E006.arguments | ABS(x, y) > 1
1:12 E001.word | MAX(x, 5s, 3) > 1
1:1 E006.bounds | HYSTERESIS(x, 5, 5)
1:3 E007.comparison | x == a
1:1 E007.operand | a + x > 1
1:5 E007.age | AGE(x + 1) > 2
1:21 E007.event | EVENT e (HAZARD) := x + 1
1:1 E008.unknown_variable | tmp > 5 AND tmp < 9
1:5 E009.one_side | x > 5 m
1:15 E009.one_side | RATE(d, 5s) > 5 m
1:5 E009.apart | d > 5 degC
1:5 E009.scale | d > e
1:8 E009.apart | temp > 5 K
1:6 E009.unknown | d > 5mmm
1:7 E008.uses_itself | EVENT p (HAZARD) := q EVENT q (HAZARD) := NOT p
1:19 E008.two_meanings | CONST k = 5 CONST k = 6 x > k
1:1 E001.literal | UNKNOWN == a
1:1 E001.reserved | coverage > 5
1:5 E001.reserved | VAR not : BOOL
1:5 E013.number | x > 1e999
1:5 E013.number | x > 1e-999
1:8 E013.duration | MAX(x, 1e30h) > 1
1:8 E013.window | MAX(x, 90h) > 1
1:21 E005.range | MAX(x, 5s, COVERAGE 0) > 1
1:13 E005.not_here | ONCE(a, 5s, COVERAGE 0.5)
1:5 W001 | x + y / 2 > 1
1:7 W002.polarity | EVENT e := a
1:5 W003.variable | VAR v : BOOL; v
1:23 W002.implies | EVENT e (HAZARD) := a IMPLIES b
1:1 W004.constant | 1 > 2
"""
OF_DECLARATIONS = r"""
1:12 E005.no_rate | AVERAGE(x, 5s) > 1
1:9 E008.unknown_type | VAR v : NUMBR TIMEOUT 1s
1:21 E009.unknown | VAR v : NUMBER UNIT mtr TIMEOUT 1s
1:9 E007.unit_of_other | VAR v : BOOL RANGE 0 .. 1 TIMEOUT 1s
1:22 E007.range | VAR v : NUMBER RANGE 5 .. 1 TIMEOUT 1s
1:34 E009.bound | VAR v : NUMBER UNIT m RANGE 0 .. 5 degC TIMEOUT 1s
1:39 E013.number_in_unit | VAR v : NUMBER UNIT mm TIMEOUT 1s v > 1e308 km
1:5 W003.variable + 1:30 E013.bounds | VAR v : NUMBER UNIT mm RANGE 0 .. 1e308 km
1:21 E001.rate | VAR v : NUMBER RATE 10
1:5 W003.variable + 1:23 E001.rest | VAR v : NUMBER TIMOUT 1s
1:25 E008.unknown_variable | VAR v : BOOL TIMEOUT 1s UNIT\nVAR w : BOOL TIMEOUT 1s
1:10 E001.word | EVENT e (MAYBE) := TRUE
1:13 E008.two_meanings | ENUM E { A, A } VAR v : E TIMEOUT 1s
1:3 E001.index_or_key | x[1.5] > 2
1:11 E007.operand | x > 1 AND x
1:37 E007.order | ENUM E { A } VAR v : E TIMEOUT 1s v < A
"""
OF_USED_NAMES = r"""
1:25 E008.unknown_variable | VAR v : BOOL TIMEOUT 1s rate > 3
1:25 E005.range | AVERAGE(x, 5s, COVERAGE 2) > 1
2:1 E008.unknown_variable | VAR x : NUMBER TIMEOUT 1s\ny > 1
1:1 E007.list | scan.ranges[*] > 1
1:21 E001.word | MIN(scan.ranges[*], 5s) > 1
1:1 E007.two_messages | MIN(a.x[*] + b.y[*]) > 1
1:1 E007.two_lists | MIN(a.x[*] + a.b.y[*]) > 1
1:1 E007.two_lists | MIN(a.x[*] + a.y[1..2]) > 1
1:1 E007.two_lists | MIN(a[*].x + a[*].y[*]) > 1
1:5 E007.objection | ANY(RISE(a.x[*] > 1))
1:5 E007.objection | MIN(AGE(a.x[*]) + a.x[*]) > 1
1:1 E006.needs_list | ANY(x > 1)
1:1 E006.no_list | RATE(a.x[*]) > 1
1:5 E007.objection | MIN(MIN(a.x[*]) + a.x[*]) > 1
1:26 E006.length | MIN(a.x[*], LENGTH 5 .. 2) > 1
1:22 E005.range | MIN(a.x[*], COVERAGE 0) > 1
1:25 E001.word | MIN(a.x[*], COVERAGE 1, COVERAGE 1) > 1
1:13 E001.word | MIN(a.x[*], SOME 1) > 1
1:20 E009.sector | MIN(a.x[*], SECTOR 0 .. 1) > 1
1:20 E009.sector | MIN(a.x[*], SECTOR -1 .. 1 rad) > 1
1:26 E001.word | MIN(a.x[*], SECTOR -1 rad, 1 rad) > 1
1:13 E007.empty_sector | MIN(a.x[*], SECTOR 1 rad .. 0 rad) > 1
1:15 E007.scan | MIN(a.x[*].y, SECTOR 0 rad .. 1 rad) > 1
1:9 E001.word | MIN(a.x[2..1]) > 1
1:1 E006.arguments | LEAST(x) > 1
1:1 E006.bounds | CLAMP(x, 2, 1) > 1
1:8 E007.operand | NUMBER(x + 1) > 1
"""
ALL = [
    pytest.param(*row.split(" | "), rate, known, id=row)
    for table, rate, known in (
        (OF_KNOWN_VARIABLES, 10, True),
        (OF_DECLARATIONS, None, False),
        (OF_USED_NAMES, 10, False),
    )
    for row in table.strip().splitlines()
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


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("d > 5", [5.0]),
        ("d > 30 cm", [0.3]),
        ("2 km < d", [2000.0]),
        ("d > 5 m + 30 cm", [5.3]),
        ("e > 5 m + 30 cm", [0.0053]),
        ("ELAPSED(a) > 2 min", [120.0]),
        ("HYSTERESIS(d, 30 cm, 1 km)", [0.3, 1000.0]),
        ("MAX(d, 1s) - MIN(d, 1s) > 50mm", [0.05]),
        ("d * 2 > 5", [2.0, 5.0]),
        ("x > 2 * 3 - 1", [5.0]),
        ("x > -(2)", [-2.0]),
    ],
)
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


def test_length_and_number_of_operations_are_limited() -> None:
    assert problems("a " * 40000) == ["1:1 E013.text"]
    assert "E013.operations" in problems("a OR " * 9000 + "a")[0]


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
