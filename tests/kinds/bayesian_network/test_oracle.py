"""The oracle: posteriors, discretisation, what is wrong with damaged files, and exports."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import data_file
from tests.kinds.bayesian_network.networks import joined, of_states, read, read_path, running


@cache
def oracle() -> dict[str, list[Any]]:
    return dict(yaml.load(data_file("bn/oracle.yml").read_text("utf-8"), yaml.CSafeLoader))


def cases(section: str) -> list[Any]:
    return list(oracle().get(section, ()))


def ident(case: dict[str, Any]) -> str:
    return str(case.get("id", case.get("file")))


def row(network: Network, wanted: str) -> list[float]:
    """Return the row of a table named ``C|A=y,B=n``."""
    name, _, given = wanted.partition("|")
    node = network.node(name)
    states = dict(pair.split("=") for pair in given.split(",") if pair)
    index = 0
    for parent in node.parents:
        of = network.node(parent).states
        index = index * len(of) + of.index(states[parent])
    width = len(node.states)
    return list(node.table[index * width : (index + 1) * width])


@pytest.mark.slow
@pytest.mark.parametrize("case", cases("posteriors"), ids=ident)
def test_posteriors(case: dict[str, Any]) -> None:
    model = read_path(data_file("bn/" + case["file"]))
    monitor, problems = joined(model, of_states(case["outputs"], case["evidence"]))
    assert monitor is not None, problems
    machine = running(monitor)
    attributes = {binding.model.id: binding.attribute for binding in monitor.inputs}
    values = {attributes[name]: value for name, value in case["evidence"].items()}
    output = machine.execute_step(SimpleNamespace(**values))
    if case["want"] == "impossible":
        assert output == []
        return
    (one,) = output
    found = {node.title: [outcome.value for outcome in node.outcomes] for node in one.output_nodes}
    assert set(found) == set(case["want"])
    for name, wanted in case["want"].items():
        assert found[name] == pytest.approx(wanted, abs=1e-12, rel=0)


def one_node(states: list[str]) -> str:
    share = " ".join([str(1 / len(states))] * len(states))
    named = "".join(f'<state id="{state}"/>' for state in states)
    cpt = f'<cpt id="N">{named}<probabilities>{share}</probabilities></cpt>'
    return f'<smile version="1.0" id="X"><nodes>{cpt}</nodes></smile>'


def discretised(case: dict[str, Any]) -> str:
    entry = yaml.safe_dump({"input": "value", **case["config"]}, default_flow_style=True, width=999)
    return (
        f"Model:\n  id: X\n  type: BayesianNetwork\n  outputs: [N]\n"
        f"  discretisation:\n    N: {entry}\n"
        "SimulatorOutputs: [{id: x, type: std_msgs.Float64, topic: /x}]\n"
        "EDDIInputs: [{id: value, requires: [x], max_age: none}]\n"
    )


@pytest.mark.parametrize("case", cases("discretise"), ids=ident)
def test_discretisation(case: dict[str, Any]) -> None:
    (model,) = read(one_node(case["states"]), "x.xdsl").models
    monitor, problems = joined(model, discretised(case))
    assert monitor is not None, problems
    machine = running(monitor)
    found = []
    for value in case["values"]:
        (output,) = machine.execute_step(SimpleNamespace(value=value))
        sure = [one.name for one in output.output_nodes[0].outcomes if one.value == 1.0]
        found.append(sure[0] if sure else None)
    assert found == case["want"]


@pytest.mark.parametrize("case", cases("discretise_errors"), ids=ident)
def test_wrong_discretisation(case: dict[str, Any]) -> None:
    (model,) = read(one_node(case["states"]), "x.xdsl").models
    monitor, problems = joined(model, discretised(case))
    assert monitor is None
    assert case["code"] in [problem.code for problem in problems]


@pytest.mark.parametrize("case", cases("import"), ids=ident)
def test_damaged_eddi(case: dict[str, Any]) -> None:
    text = data_file("bn/eddi_pedestrian.xml").read_text("utf-8")
    assert case["old"] in text
    reading = read(text.replace(case["old"], case["new"], case["count"]), "x.xml")
    codes = {problem.code: problem.level for problem in reading.problems}
    assert case["code"] in codes, codes
    cases = {problem.case for problem in reading.problems}
    is_warning = bool(cases & {"X006.misprint", "X006.prefix", "X006.spelling", "B113.normalised"})
    assert codes[case["code"]] == ("warning" if is_warning else "error")
    assert bool(reading.models) == is_warning


@pytest.mark.parametrize("section", ["xdsl", "xmlbif"])
def test_other_formats(section: str) -> None:
    for case in cases(section):
        reading = read(case["text"], f"x.{section}")
        codes = [problem.code for problem in reading.problems]
        if case["id"] == "parent_later":  # pgmpy writes XDSL so, and it is clear what is meant
            assert (codes, len(reading.models)) == ([], 1)
            continue
        if "code" in case:
            assert case["code"] in codes, (case["id"], codes)
            assert not reading.models, case["id"]
            text = " ".join(problem.message for problem in reading.problems)
            assert str(case.get("names", "")) in text, case["id"]
            continue
        (model,) = reading.models
        for wanted, values in case.get("want", {}).items():
            assert row(model.data, wanted) == values, case["id"]
        if "target" in case:
            assert [node.id for node in model.data.nodes if node.target] == case["target"]
            assert {node.id: node.title for node in model.data.nodes} == case["titles"]


@pytest.mark.parametrize("case", cases("exports"), ids=ident)
def test_exports(case: dict[str, Any]) -> None:
    model = read_path(data_file("bn/" + case["file"]))
    for name, text in model.export().items():
        reading = read_models(Source(name, text.encode()))
        node = reading.models[0].data.node(case["node"])
        assert (list(node.parents), list(node.table)) == (case["parents"], case["values"])
