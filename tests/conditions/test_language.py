"""The language: every diagnostic with its exact place and text, types, units, names, limits."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions import Variable, analyse
from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER
from eddi_scaffold.conditions.syntax import canonical
from eddi_scaffold.conditions.tokens import TextFindings, in_text
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
    return [
        f"{p.place.line}:{p.place.col} {p.code} {p.message}" + (f" ({p.hint})" if p.hint else "")
        for p in analysis.problems
    ]


CASES = {
    "x > 5 & a": ["1:7 E001 unexpected character '&' (write AND)"],
    "x > 5 AND": ["1:10 E001 an operand is expected, found the end of the text"],
    "(x > 5": ["1:7 E001 ')' is expected, found the end of the text"],
    "a == NOT b": ["1:6 E001 an operand is expected, found 'NOT' (put it in parentheses: (NOT a))"],
    "x > 5 y": ["1:7 E001 unexpected 'y': the text before is complete"],
    "x < 5 < y": ["1:7 E001 comparisons do not chain (write a < b AND b < c)"],
    "MAX(x, y) > 1": [
        (
            "1:8 E005 a duration such as 5s is expected, found 'y' "
            "(the unit is one of ns, us, ms, s, min, h)"
        )
    ],
    "MAX(x, 5 s) > 1": [
        "1:8 E005 the unit of a duration must directly follow the number (write 5s)"
    ],
    "MAX(x, 0s) > 1": ["1:8 E005 a duration must be longer than 0"],
    "MAX(x, 50ms) > 1": ["1:8 E005 the window is shorter than one sample period (0.1 s)"],
    "MAXX(x, 5s) > 1": ["1:1 E006 there is no function 'MAXX' (did you mean 'MAX'?)"],
    "ABS(x, y) > 1": ["1:1 E006 ABS takes 1 argument, here are 2"],
    "MAX(x, 5s, 3) > 1": ["1:1 E006 MAX takes 1 argument and a duration"],
    "HYSTERESIS(x, 5, 5)": ["1:1 E006 the lower bound of HYSTERESIS must be below the upper one"],
    "x == a": ["1:3 E007 a number and a boolean cannot be compared"],
    "a + x > 1": ["1:1 E007 + needs a number, this is a boolean"],
    "AGE(x + 1) > 2": ["1:5 E007 AGE needs a variable"],
    "EVENT e (HAZARD) := x + 1": ["1:21 E007 an event is a boolean, this is a number"],
    "tmp > 5 AND tmp < 9": ["1:1 E008 there is no variable 'tmp' (did you mean 'temp'?)"],
    "x > 5 m": [
        (
            "1:5 E009 this is in m, but the other side has no unit "
            "(declare the unit: VAR name : NUMBER UNIT m)"
        )
    ],
    "RATE(d, 5s) > 5 m": [
        (
            "1:15 E009 this is in m, but the other side has no unit "
            "(what *, / and RATE give has no unit: write the number without one)"
        )
    ],
    "d > 5 degC": ["1:5 E009 m (length) and degC (temperature in Celsius) do not go together"],
    "d > e": ["1:5 E009 the left side is in m, this is in km (multiply it by 1000)"],
    "temp > 5 K": [
        "1:8 E009 degC (temperature in Celsius) and K (temperature in Kelvin) do not go together"
    ],
    "d > 5mmm": ["1:6 E009 there is no unit 'mmm' (did you mean 'mm'?)"],
    "EVENT p (HAZARD) := q EVENT q (HAZARD) := NOT p": [
        "1:7 E008 the event uses itself: p uses q uses p"
    ],
    "CONST k = 5 CONST k = 6 x > k": ["1:19 E008 the name 'k' has two meanings"],
    "UNKNOWN == a": [
        (
            "1:1 E001 UNKNOWN is not a literal, use KNOWN(...) "
            "(KNOWN(x) tests whether a value is known)"
        ),
    ],
    "coverage > 5": ["1:1 E001 'coverage' is a reserved word, it cannot be a name"],
    "VAR not : BOOL": ["1:5 E001 'not' is a reserved word, it cannot be a name"],
    "x > 1e999": ["1:5 E013 the number does not fit into a double"],
    "x > 1e-999": ["1:5 E013 the number does not fit into a double"],
    "MAX(x, 1e30h) > 1": ["1:8 E013 the duration does not fit into 62 bits of nanoseconds"],
    "MAX(x, 90h) > 1": [
        "1:8 E013 the window has 3240000 samples, more than 524280 (TIME and ONCE need no buffer)"
    ],
    "MAX(x, 5s, COVERAGE 0) > 1": ["1:21 E005 the coverage must be above 0 and at most 1"],
    "ONCE(a, 5s, COVERAGE 0.5)": ["1:13 E005 ONCE takes no COVERAGE"],
    "x + y / 2 > 1": [
        (
            "1:5 W001 only this term is divided, not the whole sum "
            "(put the sum in parentheses, or this term to show that it is intended)"
        )
    ],
    "EVENT e := a": [
        (
            "1:7 W002 the event 'e' does not declare what UNKNOWN means: EVIDENCE is used "
            "(EVENT e (EVIDENCE): not active when UNKNOWN; (HAZARD): active)"
        )
    ],
    "VAR v : BOOL; v": [
        (
            "1:5 W003 v has no TIMEOUT: it goes unnoticed when its source falls silent "
            "(add TIMEOUT 500ms, or RATE 10 Hz)"
        )
    ],
    "EVENT e (HAZARD) := a IMPLIES b": [
        (
            "1:23 W002 the HAZARD 'e' holds whenever the left side of IMPLIES does not "
            "(a hazard is what must not be: write AND in place of IMPLIES)"
        )
    ],
    "1 > 2": ["1:1 W004 the result never changes: no variable decides it"],
}


@pytest.mark.parametrize("text", CASES)
def test_diagnostics(text: str) -> None:
    assert problems(text) == CASES[text]


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("AVERAGE(x, 5s) > 1", "1:12 E005 AVERAGE needs a sampling rate (add --rate 10)"),
        ("VAR v : NUMBR TIMEOUT 1s", "1:9 E008 there is no type 'NUMBR' (did you mean 'NUMBER'?)"),
        ("VAR v : NUMBER UNIT mtr TIMEOUT 1s", "1:21 E009 there is no unit 'mtr'"),
        ("VAR v : BOOL RANGE 0 .. 1 TIMEOUT 1s", "1:9 E007 UNIT and RANGE are for numbers"),
        ("VAR v : NUMBER RANGE 5 .. 1 TIMEOUT 1s", "1:22 E007 the RANGE is empty"),
        ("VAR v : NUMBER UNIT m RANGE 0 .. 5 degC TIMEOUT 1s", "1:34 E009 a bound in degC"),
        ("VAR v : NUMBER UNIT mm TIMEOUT 1s v > 1e308 km", "1:39 E013 the number does not fit"),
        ("VAR v : NUMBER UNIT mm RANGE 0 .. 1e308 km", "1:30 E013 the bounds do not fit"),
        ("VAR v : NUMBER RATE 10", "1:21 E001 a rate such as 10 Hz is expected"),
        ("VAR v : NUMBER TIMOUT 1s", "1:16 E001 'TIMOUT' is no option of a VAR (did you mean 'TIM"),
        ("VAR v : NUMBER UNITS m", "1:16 E001 'UNITS' is no option of a VAR (did you mean 'UNIT'"),
        ("VAR v : NUMBER ALLOW NAN", "1:22 E001 INF behind ALLOW is expected, found 'NAN'"),
        ("VAR v : NUMBER UNIT\nVAR w : BOOL", "2:1 E001 a unit behind UNIT is expected, found"),
        ("EVENT e (MAYBE) := TRUE", "1:10 E001 EVIDENCE or HAZARD is expected, found 'MAYBE'"),
        ("ENUM E { A, A } VAR v : E TIMEOUT 1s", "1:13 E008 the name 'A' has two meanings"),
        ("x[1.5] > 2", "1:3 E001 an index from 0 on or a key is expected, found '1.5'"),
        ("x > 1 AND x", "1:11 E008 'x' is a number elsewhere, but AND needs a boolean"),
        ("KNOWN(x)", "1:7 E008 the type of 'x' is not known"),
        ("ENUM E { A } VAR v : E TIMEOUT 1s v < A", "1:37 E007 E cannot be ordered"),
    ],
)
def test_more_diagnostics(text: str, wanted: str) -> None:
    found = problems(text, rate=None, known=False)
    assert any(line.startswith(wanted) for line in found), found


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (
            "VAR v : NUMBER UNIT m TIMOUT 1s\nVAR w : NUMBER UNIT mtr TIMEOUT 1s\nv < 1 m",
            [
                "1:23 E001 'TIMOUT' is no option of a VAR (did you mean 'TIMEOUT'?)",
                "2:21 E009 there is no unit 'mtr' (did you mean 'meter'?)",
            ],
        ),
        (
            "VAR v : BOOL TIMEOUT 1s rate > 3",
            ["1:25 E008 there is no variable 'rate' (there are: v)"],
        ),
        ("x > 5 y", ["1:7 E001 unexpected 'y': the text before is complete"]),
        (
            "AVERAGE(x, 5s, COVERAGE 2) > 1",
            ["1:25 E005 the coverage must be above 0 and at most 1"],
        ),
        ("VAR x : NUMBER TIMEOUT 1s\ny > 1", ["2:1 E008 there is no variable 'y' (there are: x)"]),
    ],
)
def test_nothing_is_told_that_follows_from_another_error(text: str, wanted: list[str]) -> None:
    assert problems(text, known=False) == wanted


def test_every_error_of_a_file_is_told_at_once() -> None:
    lines = ("p (HAZARD) := x >", "q (HAZARD) := y + a", "r (HAZARD) := AND", "s (HAZARD) := p")
    text = "\n".join(f"EVENT {line}" for line in lines)
    assert [line.split(" ", 2)[:2] for line in problems(text)] == [
        ["1:24", "E001"],
        ["2:25", "E007"],
        ["3:21", "E001"],  # nothing on s: that p is not there follows from the first
    ]


def form_of(text: str) -> dict[str, object]:
    found = analyse(text, rate=10, variables=KNOWN)
    assert found.form is not None, found.problems
    return found.form


def constants(text: str) -> list[float]:
    return [row["value"] for row in form_of(text)["nodes"] if row["op"] == "number"]


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
    form = form_of("MAX(x, 1s) > 5 AND NOT (MAX(x, 1s) > 5) OR MAX(x, 1000ms) > 6")
    assert [row["op"] for row in form["nodes"]].count("max") == 1


def test_events_may_use_later_ones() -> None:
    found = analyse("EVENT p (HAZARD) := NOT q EVENT q (EVIDENCE) := x > 1", variables=KNOWN)
    assert [(event.id, event.polarity) for event in found.events] == [
        ("p", "HAZARD"),
        ("q", "EVIDENCE"),
    ]


def test_words_are_names_where_they_can_be() -> None:
    text = (
        "VAR time.max : NUMBER TIMEOUT 1s VAR range : NUMBER TIMEOUT 1s\nMAX (time.max, 1s) > range"
    )
    assert problems(text, known=False) == []
    assert problems("a.and.or > 5 AND x.NOT == TRUE", known=False) == []


def test_canonical_form_of_literals() -> None:
    found = analyse("x > 1e-7 AND d > 5.0 m AND NOT a and ABS(x) >= 1.5e300", variables=KNOWN)
    assert found.events[0].canonical == (
        "((((x > 1e-07) AND (d > 5 m)) AND (NOT a)) AND (ABS(x) >= 1.5e+300))"
    )


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
    assert problems(deep) == ["1:101 E013 the expression is nested more than 100 deep"]


@pytest.mark.parametrize(
    "text",
    [
        " AND ".join(["a"] * 4000),
        "NOT " * 8000 + "a",
        "x > " + "-" * 8000 + "x",
        " IMPLIES ".join(["a"] * 4000),
        " + ".join(["x"] * 4000) + " > 1",
    ],
)
def test_long_chains_are_no_nesting(text: str) -> None:
    found = analyse(text, rate=10, variables=KNOWN)
    assert found.form is not None, found.problems


def test_length_and_number_of_operations_are_limited() -> None:
    assert problems("a " * 40000) == ["1:1 E013 the text is longer than 65536 bytes"]
    assert "more than 10000 operations" in problems("a OR " * 9000 + "a")[0]


# properties


def read(text: str) -> Analysis:
    return analyse(text, rate=RATE)


def test_printing_and_reading_round_trip() -> None:
    rounds = 10_000 if settings.default.max_examples > 1000 else 500
    rng = random.Random(7)
    formulas = Formulas(rng)
    for _ in range(rounds):
        text = formulas.boolean(rng.randint(0, 4))
        file = parse(text, TextFindings(text, in_text(text)))
        once = canonical(file, file.events[0].root)
        again = parse(once, TextFindings(once, in_text(once)))
        assert canonical(again, again.events[0].root) == once
        assert [(n.op, n.args) for n in again.nodes] == [(n.op, n.args) for n in file.nodes]


SEEDS = (
    DECLARATIONS + "EVENT e (HAZARD) := AVERAGE(x, 5s, COVERAGE 0.5) > 100 AND TIME(a, 5s)",
    "MAX(temp1,10s) + MAX(temp2,10s) / 2 > AVERAGE(core,10s) // a comment",
    "ENUM M { P, Q } VAR m.n[3] : M TIMEOUT 1s CONST k = -5 m m.n[3] == P",
)
PIECES = (
    *("(", ")", "AND", "NOT ", ">", "==", "1e5", "5s", ",", "UNKNOWN", "MAX(", "EVENT ", "VAR "),
    *(
        ":=",
        "..",
        ".",
        "[",
        "]",
        "{",
        "}",
        "\x00",
        "é",
        "😀",
        "//",
        "\n",
        ";",
        "9" * 50,
        "COVERAGE",
    ),
)


@given(st.data())
def test_any_text_gives_a_result_or_places_inside_of_it(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(SEEDS))
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(text)))
        end = min(len(text), at + data.draw(st.integers(0, 8)))
        text = text[:at] + data.draw(st.sampled_from(PIECES) | st.text(max_size=4)) + text[end:]
    check_places(text)


def test_ten_thousand_mutations() -> None:
    rounds = 10_000 if settings.default.max_examples > 1000 else 600
    rng = random.Random(11)
    for _ in range(rounds):
        text = rng.choice(SEEDS)
        for _ in range(rng.randint(1, 5)):
            at = rng.randint(0, len(text))
            text = text[:at] + rng.choice(PIECES) + text[at + rng.randint(0, 6) :]
        check_places(text)


def check_places(text: str) -> None:
    found = read(text)
    lines = text.split("\n")
    for problem in found.problems:
        assert problem.place.line is not None
        assert problem.place.col is not None
        assert 1 <= problem.place.line <= len(lines)
        assert 1 <= problem.place.col <= len(lines[problem.place.line - 1]) + 1
    assert (found.form is None) == any(p.level == "error" for p in found.problems)
