"""Networks as other tools write them: digits, orders, types; noisy-MAX by its definition."""

import itertools
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.read_xml_formats import NoisyMaxError, noisy_max_table
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.upgrading import rejoined
from tests.data_files import data_text
from tests.kinds.bayesian_network.networks import read

TWO = '<state id="y"/><state id="n"/>'


def xdsl(*nodes: str) -> str:
    return f'<smile version="1.0" id="N"><nodes>{"".join(nodes)}</nodes></smile>'


def cpt(name: str, numbers: str, parents: str = "") -> str:
    given = f"<parents>{parents}</parents>" if parents else ""
    return f'<cpt id="{name}">{TWO}{given}<probabilities>{numbers}</probabilities></cpt>'


@pytest.mark.parametrize("off", ["0.500001", "0.49999", "0.50001"])
def test_rows_with_few_digits_are_normalised(off: str) -> None:
    reading = read(xdsl(cpt("A", f"0.5 {off}")), "n.xdsl")
    assert [problem.case for problem in reading.problems] == ["B113.normalised"]
    total = 0.5 + float(off)
    assert reading.models[0].data.node("A").table == (0.5 / total, float(off) / total)


def test_variables_that_decide_are_one_problem() -> None:
    def variable(name: str, of: str) -> str:
        return f'<VARIABLE TYPE="{of}"><NAME>{name}</NAME></VARIABLE>'

    text = variable("D", "decision") + variable("E", "decision") + variable("U", "utility")
    child = "<DEFINITION><FOR>A</FOR><GIVEN>D</GIVEN></DEFINITION>"
    document = f'<BIF VERSION="0.3"><NETWORK>{text}{variable("A", "nature")}{child}</NETWORK></BIF>'
    assert {one.message for one in read(document, "n.xmlbif").problems} == {
        "the nodes 'D', 'E' are of type 'decision', which is not supported",
        "the node 'U' is of type 'utility', which is not supported",
    }


@pytest.mark.parametrize("config", [False, True])
def test_without_a_configuration_the_file_names_the_package(config: bool, tmp_path: Path) -> None:
    """GeNIe calls every network the same, until somebody changes that."""
    model = tmp_path / "Rover Risk.xdsl"
    model.write_text(xdsl(cpt("A", "0.5 0.5")), "utf-8")
    text = "Model: {id: N, type: BayesianNetwork}\nEDDIInputs: [{id: A, requires: []}]\n"
    (tmp_path / "config.yml").write_text(text, "utf-8")
    configs = [tmp_path / "config.yml"] if config else []
    (monitor,), _ = monitors_of(model, configs)
    assert (monitor.package, monitor.model.name) == ("n" if config else "rover_risk", "N")
    if not config:
        answers = {"kind": "bayesian_network"}
        again, _ = rejoined("n", answers, monitor.model)
        assert again.package == "n"  # as an earlier release called it


ROOTS = (
    '<smile version="1.0" id="N"><nodes>'
    f'<cpt id="A">{TWO}<probabilities>0.25 0.75</probabilities></cpt>'
    f'<cpt id="B">{TWO}<probabilities>0.5 0.5</probabilities></cpt>'
)


def noisy_or(inner: str) -> str:
    return f'{ROOTS}<noisymax id="C">{TWO}<parents>A B</parents>{inner}</noisymax></nodes></smile>'


@st.composite
def gates(draw: st.DrawFn) -> tuple[list[int], int, list[list[list[float]]], list[float]]:
    """Return numbers of states, and for each parent and the leak what it causes."""
    own = draw(st.integers(2, 4))
    cards = draw(st.lists(st.integers(2, 3), max_size=3))

    def column() -> list[float]:
        weights = draw(st.lists(st.integers(1, 9), min_size=own, max_size=own))
        return [weight / sum(weights) for weight in weights]

    nothing = [0.0] * (own - 1) + [1.0]
    causes = [[*(column() for _ in range(card - 1)), nothing] for card in cards]
    return cards, own, causes, draw(st.sampled_from([nothing, column()]))


@given(gates())
def test_the_strongest_cause_wins(
    gate: tuple[list[int], int, list[list[list[float]]], list[float]],
) -> None:
    cards, own, causes, leak = gate
    texts = [repr(value) for one in [*itertools.chain(*causes), leak] for value in one]
    table, leaks = noisy_max_table(texts, cards, own)
    assert leaks == (leak[-1] != 1.0)
    wanted: list[float] = []
    for states in itertools.product(*(range(card) for card in cards)):
        active = [*(causes[k][state] for k, state in enumerate(states)), leak]
        row = [0.0] * own
        for effects in itertools.product(range(own), repeat=len(active)):
            weight = 1.0
            for column, effect in zip(active, effects, strict=True):
                weight *= column[effect]
            row[min(effects)] += weight  # the first state is the strongest
        wanted += row
    assert [float(text) for text in table] == pytest.approx(wanted, abs=1e-12)


def test_strengths_name_the_states_of_the_columns() -> None:
    """The absence of A is what causes C: its columns stand in the order n, y."""
    text = noisy_or(
        "<strengths>1 0 0 1</strengths><parameters>0.9 0.1 0 1 0.8 0.2 0 1 0 1</parameters>"
    )
    assert [problem.case for problem in read(text, "n.xdsl").problems] == ["B202.noisy_max"]


def test_a_leak_is_read_with_a_warning() -> None:
    text = noisy_or("<parameters>0.9 0.1 0 1 0.8 0.2 0 1 0.1 0.9</parameters>")
    reading = read(text, "n.xdsl")
    assert [(problem.level, problem.code) for problem in reading.problems] == [("warning", "B208")]
    table = reading.models[0].data.node("C").table
    assert table == pytest.approx([0.982, 0.018, 0.91, 0.09, 0.82, 0.18, 0.1, 0.9])


@pytest.mark.parametrize(
    ("parameters", "cards", "message"),
    [
        ("0.9 0.1 0 1", [2, 2], "4 parameters, expected 10"),
        ("0.9 0.1 0.1 0.9 0.8 0.2 0 1 0 1", [2, 2], "of parent 1 must be"),
        ("0.9 0.2 0 1 0.8 0.2 0 1 0 1", [2, 2], "sums to 1.1"),
        ("nan 0.1 0 1 0.8 0.2 0 1 0 1", [2, 2], "sums to nan"),
        ("x 0.1 0 1 0.8 0.2 0 1 0 1", [2, 2], "'x'"),
        ("0.5 0.5 0 1 " * 40 + "0 1", [2] * 40, "2199023255552 entries"),
    ],
)
def test_what_is_no_noisy_max(parameters: str, cards: list[int], message: str) -> None:
    with pytest.raises(NoisyMaxError, match=message):
        noisy_max_table(parameters.split(), cards, 2)


def test_without_states_that_is_the_only_complaint() -> None:
    text = f'{ROOTS}<noisymax id="C"><parents>A</parents><parameters>1</parameters></noisymax>'
    reading = read(f"{text}</nodes></smile>", "n.xdsl")
    assert [problem.code for problem in reading.problems] == ["B101"]


START = data_text("networks/dogs_start.bif")
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
