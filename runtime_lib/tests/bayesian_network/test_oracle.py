"""The shared oracle: exact posteriors, and discretisation step by step."""

import re
import xml.etree.ElementTree as ET

import pytest

pytest.importorskip("yaml", reason="the oracle is YAML")
pytest.importorskip("numpy")
pytest.importorskip("hypothesis")
import yaml
from eddi_runtime.bayesian_network.evidence import finding
from eddi_runtime.inputs import InputSpec
from hypothesis import settings

from eddi_scaffold.kinds.bayesian_network.structure import NumberedNetwork, Shape
from runtime_lib.tests.bayesian_network.networks import discretiser, engine, furthest
from tests.data_files import data_file

_REFERENCE = re.compile(r"//@nodes\.(\d+)(?:/@nodeStates\.(\d+))?")


def read(path):
    """Read a well-formed network of the shared data: no checks, the generator has those."""
    root = ET.parse(path).getroot()
    nodes = root.findall("nodes")
    states = [tuple(one.get("name") for one in node.findall("nodeStates")) for node in nodes]
    parents = [[] for _ in nodes]
    for link in root.findall("causalConnections"):
        source, target = (int(_REFERENCE.match(link.get(end))[1]) for end in ("from", "to"))
        parents[target].append(source)
    tables = [table(node, k, parents, states) for k, node in enumerate(nodes)]
    names = tuple(node.get("name") for node in nodes)
    shape = Shape(names, tuple(map(len, states)), tuple(map(tuple, parents)))
    return NumberedNetwork(shape, tuple(states), tuple(tables), names)


def table(node, number, parents, states):
    rows = {}
    for row in node.findall("conditionalProbabilityDistributions"):
        case = dict(_REFERENCE.findall(row.get("parentNodeStates", "")))
        place = 0
        for parent in parents[number]:
            place = place * len(states[parent]) + int(case[str(parent)])
        values = [0.0] * len(states[number])
        for value in row.findall("conditionalProbabilityValues"):
            values[int(_REFERENCE.match(value.get("nodeState"))[2])] = float(value.get("value", 0))
        rows[place] = values
    return tuple(value for place in sorted(rows) for value in rows[place])


def evidence(case, net, engine):
    states, weights = list(engine.missing), {}
    for name, value in case["evidence"].items():
        node = net.shape.names.index(name)
        known = net.states[node]
        found = known.index(value) if isinstance(value, str) else finding(value, known)
        position = engine.observable.index(node)
        if isinstance(found, int):
            states[position] = found
        elif found is not None:
            weights[position] = found
    return states, weights


@pytest.mark.slow
@pytest.mark.parametrize("tables", [True, False])
def test_posteriors(tables):
    oracle = yaml.safe_load(data_file("bn/oracle.yml").read_text("utf-8"))
    worst = 0.0
    for number, case in enumerate(oracle["posteriors"]):
        net = read(data_file("bn/" + case["file"]))
        names = net.shape.names
        outputs = [names.index(name) for name in case["outputs"]]
        observed = [names.index(name) for name in case["evidence"]]
        # What is asked for, and every node observable: other schedules, the same answers.
        all_too = number % 3 == 0 or settings.default.max_examples > 1000  # they are large
        for observable in (observed, range(len(names))) if all_too else (observed,):
            made = engine(net, outputs, observable, tables=tables)
            rows = made.infer(*evidence(case, net, made))
            if case["want"] == "impossible":
                assert rows is None, case["id"]
                continue
            wanted = [case["want"][names[node]] for node in made.outputs]
            assert rows is not None, case["id"]
            worst = max(worst, furthest(rows, wanted))
    assert worst < 1e-12


def test_discretisation():
    oracle = yaml.safe_load(data_file("bn/oracle.yml").read_text("utf-8"))
    for case in oracle["discretise"]:
        given = dict(case["config"], input="x")
        if "map" in given:
            given["map"] = list(given["map"].items())
        spec = InputSpec("x", "x", (), None, None, None, every_message=False)
        reader = discretiser(given, case["states"], spec)
        known = [*case["states"], None]
        assert [known[reader.read(value, 0)] for value in case["values"]] == case["want"], case[
            "id"
        ]
