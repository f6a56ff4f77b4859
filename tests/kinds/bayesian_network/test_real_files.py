"""Networks as other tools write them: digits, orders and types of nodes that real files have."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import monitors_of, rejoined
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


@pytest.mark.parametrize("off", ["0.499989", "0.500011"])
def test_rows_that_are_off_by_more_are_refused(off: str) -> None:
    reading = read(xdsl(cpt("A", f"0.5 {off}")), "n.xdsl")
    assert [problem.case for problem in reading.problems] == ["B113.sum"]


def test_children_may_come_before_their_parents() -> None:
    noisy = (
        f'<noisymax id="C">{TWO}<parents>B</parents><parameters>0.9 0.1 0 1 0 1</parameters>'
        "</noisymax>"
    )
    reading = read(xdsl(noisy, cpt("B", "1 0 0.25 0.75", "A"), cpt("A", "0.5 0.5")), "n.xdsl")
    assert reading.problems == ()
    network = reading.models[0].data
    assert network.names() == ["C", "B", "A"]
    assert [node.id for node in network.in_order()] == ["A", "B", "C"]
    assert network.node("C").table == pytest.approx([0.9, 0.1, 0.0, 1.0])


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
        again, _ = rejoined({"n": answers}, {"n": monitor.model}, {})["n"]
        assert again.package == "n"  # as an earlier release called it
