"""Networks that are text: what BIF files mean, and where they are wrong."""

from pathlib import Path

import pytest

from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.kinds.bayesian_network.network import Network
from tests.kinds.bayesian_network.networks import read

START = """\
network "Dog Problem" { // as JavaBayes writes it
  property "credal-set constant-density-bounded 1.1" ;
}
variable A { type discrete[2] { "y" "n" }; property position = (73, 165) ; }
variable B { /* three */ type discrete [ 3 ] { <5, 5-12, 12+ }; }
"""
BIF = START + "probability ( A ) { table 0.25, 0.75; }\n"
ROW = (0.5, 0.25, 0.25)
ROWS = (*ROW, 0.125, 0.0, 0.875)


def network(reading: ReadResult) -> Network:
    assert reading.problems == ()
    return reading.models[0].data


@pytest.mark.parametrize(
    "table",
    [
        "( B | A ) { (y) 0.5, 0.25, 0.25; (n) 0.125, 0, 0.875; }",
        '("B" "A") { ("n") 0.125 0 0.875; ("y") 0.5 0.25 0.25; }',
        "( B | A ) { table 0.5, 0.125, 0.25, 0, 0.25, 0.875; }",  # own states vary slowest
        "( B | A ) { default 0.5 0.25 0.25; (n) 0.125 0 0.875; property x; }",
    ],
)
def test_tables_of_bif(table: str) -> None:
    found = network(read(f"{BIF}probability {table}", "n.bif"))
    assert found.name == "Dog Problem"
    b = found.node("B")
    assert (b.states, b.parents, b.table) == (("<5", "5-12", "12+"), ("A",), ROWS)
    assert found.node("A").table == (0.25, 0.75)


def test_comments_of_bif_may_follow_a_word_at_once() -> None:
    variable = "variable C { type discrete[2] { m/s, // one\n km/h// two\n }; }"
    table = "probability ( C ) { table 0.25/* a */, 0.75// b\n; }"
    found = network(read(f"{BIF}probability ( B ) {{ table 0 0 1; }} {variable} {table}", "n.bif"))
    c = found.node("C")
    assert (c.states, c.table) == (("m/s", "km/h"), (0.25, 0.75))


def test_the_order_of_parents_is_that_of_the_file() -> None:
    variable = "variable {} {{ type discrete [2] {{ {}, {} }}; }}"
    start = "".join(variable.format(*one) for one in ("Ayn", "Byn", "Cuv"))
    roots = "probability (A) { table 1 0; } probability (C) { table 1 0; }"
    rows = "(u, y) 1 0; (u, n) 0.9 0.1; (v, y) 0.8 0.2; (v, n) 0.7 0.3;"
    bif = f"network N {{ }} {start} {roots} probability (B | C, A) {{ {rows} }}"
    wanted = (("C", "A"), (1.0, 0.0, 0.9, 0.1, 0.8, 0.2, 0.7, 0.3))
    b = network(read(bif, "n.bif")).node("B")
    assert (b.parents, b.table) == wanted


@pytest.mark.parametrize("row", Path(__file__).with_name("wrong_bif.txt").read_text().splitlines())
def test_what_is_wrong_in_bif(row: str) -> None:
    """A row: case, line and column, what stands behind two variables and the table of the first."""
    case, place, text = row.split(" ", 2)
    text = text.encode().decode("unicode_escape")
    (problem,) = read(f"{BIF}probability {text}", "n.bif").problems
    assert (problem.case, f"{problem.place.line}:{problem.place.col}") == (case, place)


def test_a_default_that_would_fill_too_much_is_refused() -> None:
    names = [f"P{k}" for k in range(40)]
    text = "".join(
        f"variable {name} {{ type discrete [2] {{ y, n }}; }}" for name in ["X", *names]
    ) + "".join(f"probability ({name}) {{ table 1 0; }}" for name in names)
    text = f"network N {{ }} {text} probability (X | {', '.join(names)}) {{ default 1 0; }}"
    (problem,) = read(text, "n.bif").problems
    assert problem.case == "B110.table_too_large"


def test_text_that_is_not_utf_8() -> None:
    (problem,) = read(b"network N { }\n// caf\xe9", "n.bif").problems
    assert (problem.code, problem.place.line, problem.place.col) == ("B201", 2, 7)


@pytest.mark.parametrize("name", ["n.bifxml", "n.bif", "n.xml", "n.xmlbif"])
def test_xmlbif_under_each_of_its_names(name: str) -> None:
    variable = "<VARIABLE><NAME>A</NAME><OUTCOME>y</OUTCOME><OUTCOME>n</OUTCOME></VARIABLE>"
    definition = "<DEFINITION><FOR>A</FOR><TABLE>0.25 0.75</TABLE></DEFINITION>"
    text = (
        f'<?xml version="1.0"?><BIF VERSION="0.3"><NETWORK>{variable}{definition}</NETWORK></BIF>'
    )
    assert network(read(text, name)).node("A").table == (0.25, 0.75)
