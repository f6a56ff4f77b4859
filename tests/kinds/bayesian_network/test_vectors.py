"""Vectors of networks: random ones are passed, mutants are killed or equal; pgmpy agrees."""

from __future__ import annotations

import itertools
import json
import math
import re
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime.testing import failures
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds.bayesian_network.cross_check import _PgmpyNetwork
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.network_model import NetworkModel
from eddi_scaffold.kinds.bayesian_network.write import to_xmlbif
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.evidence.mutants import Mutated, input_class
from tests.kinds.bayesian_network.networks import joined, networks, read

ROBOT = Path(__file__).parents[3] / "examples" / "warehouse-robot" / "robot.yml"


@pytest.fixture(scope="module")
def localisation() -> BoundMonitor:
    monitors = monitors_of(None, [ROBOT])[0]
    return next(monitor for monitor in monitors if monitor.id == "localisation")


def observed(monitor_class: Any) -> list[str]:
    """Return all that a monitor shows, for all evidence.

    Sums are linear in the likelihoods of each node: with its states, one row of likelihoods
    besides them only has to show that they are taken.
    """
    rows: list[str] = []

    def step(monitor: Any, **values: float | None) -> None:
        output = monitor.execute_step(SimpleNamespace(**values), 0)
        shown = repr((output, monitor.claims(), monitor.facts(), monitor.faults()))
        rows.append(re.sub(r"\d\.[\d.e-]+", lambda number: f"{float(number[0]):.10g}", shown))

    for matched, slip in itertools.product((0.5, 0.9, None, True), (0.01, 0.2, None, True)):
        step(monitor_class(), matched=matched, slip=slip)
    likelihoods = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 1.0))
    names = [f"node_{spec.attribute}" for spec in monitor_class.nodes]
    for asked, case in itertools.product((False, True), itertools.product(likelihoods, repeat=3)):
        methods: dict[str, Any] = {"update_dra_data": lambda _: None}
        for name, spec, numbers in zip(names, monitor_class.nodes, case, strict=True):
            outcomes = dict(zip(spec.states, numbers, strict=True))
            if asked or any(numbers):
                methods[name] = lambda outcomes=outcomes: (asked, outcomes)  # noqa: B023
        step(monitor_class(SimpleNamespace(**methods)))
    return rows


def test_each_mutant_is_killed_or_verify_sees_it_or_it_is_equal_for_all_evidence(
    localisation: BoundMonitor, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    mutated = Mutated(localisation, tmp_path)
    expected = observed(mutated.original)
    for change, mutant in mutated.survivors(mutated.drawn(request, 0.15)):
        verify_sees_it = checked(localisation, mutated.text)[1] != []
        assert verify_sees_it or observed(mutant) == expected, change


@given(networks(), st.randoms())
def test_the_monitor_of_a_random_network_passes(network: Network, chance: Random) -> None:
    (model,) = read(to_xmlbif(network), "net.xmlbif").models
    monitor, _ = joined(model, json.dumps(configuration(network, chance)))
    assert monitor is not None
    text = monitor.model.vectors(monitor.bound, {"model": "net", "sha256": ""})
    assert len(text.encode()) <= 64 * 1024
    if text:
        with TemporaryDirectory() as folder:
            file = Path(folder, "vectors.json")
            file.write_text(text)
            of = type(monitor.compiled.monitor("net"))
            assert failures(str(file), of, input_class(of)) == []


def test_posteriors_are_those_of_pgmpy(localisation: BoundMonitor) -> None:
    pytest.importorskip("pgmpy")
    model = localisation.model
    assert isinstance(model, NetworkModel)
    peer = _PgmpyNetwork(model.data)
    data = json.loads(model.vectors(localisation.bound, {}))
    steps = next(steps for name, steps in data["runs"] if name == "methods")
    (node,) = (node for node in model.data.nodes if node.id in model.settings.outputs)
    seen, expected, compared = dict[str, Any](), dict[str, Any](), 0
    for _, methods, results in steps:
        seen.update(methods)
        expected.update(results)
        case = {name[5:-2]: [*of[1].values()] for name, of in seen.items() if any(of[1].values())}
        for state, p in zip(node.states, peer.posterior(node.id, case), strict=True):
            assert math.isclose(expected[f"{node.id}={state}"], p, rel_tol=1e-9, abs_tol=1e-12)
            compared += 1
    assert compared > 40


def configuration(network: Network, chance: Random) -> dict[str, Any]:
    """Return any configuration that is right."""
    inputs, discretisation, thresholds = [], {}, []
    for node in network.nodes:
        kind = chance.choice(["none", "direct", "map", "bins", "bins"])
        age = chance.choice(["none", "0.5 s"])
        input_: dict[str, Any] = {"id": node.id, "from": "x", "max_age": age}
        entry: dict[str, Any] = {"input": f"{node.id}_"}
        if kind == "map":
            entry["map"] = {value: chance.choice(node.states) for value in ("1", "2", "-3")}
            input_ |= {"type": "int"}
        elif kind == "bins":
            order = chance.sample(node.states, len(node.states))
            edges = chance.sample([-3, -1.5, 0, 0.7, 1.0, 2.25, 7], len(order) - 1)
            entry |= {"order": order, "bins": sorted(edges)}
            further: dict[str, list[Any]] = {
                "scale": [3.6, -2.0],
                "offset": [1.0, -273.15],
                "closed": ["left"],
                "range": [[-2, 5], [0, 100.5]],
                "out_of_range": ["clamp"],
                "allow_inf": [True],
                "hysteresis": [0.03, 0.5],
                "sentinel": [[[-1, order[0]], ["err", "unobserved"]]],
                "missing": ["prior", "hold", "default"],
            }
            entry |= {
                key: chance.choice(of) for key, of in further.items() if chance.random() < 0.3
            }
        if entry.get("missing") == "default":
            input_ |= {"default": 0.5, "allow_unsafe_default": True}
        if kind in ("map", "bins"):
            discretisation[node.id] = entry
            input_["id"] = entry["input"]
        elif len(node.states) > 1:
            key, limit = chance.choice(["at_most", "at_least"]), chance.choice([0.1, 0.5])
            release = limit * (1.5 if key == "at_most" else 0.5)
            row = {"id": f"T{node.id}", "of": f"{node.id}={node.states[0]}", key: limit}
            thresholds.append({**row, "release": release, "hold": chance.choice([0, "1 s"])})
        inputs += [input_] if kind != "none" else []
    model: dict[str, Any] = {"id": "net", "type": "BayesianNetwork", "frequency": 10}
    further = {
        "outputs": [chance.sample(network.names(), 1)],
        "observed": [chance.sample(network.names(), 1)],
        "evidence_mode": ["d7.2"],
        "on_inconsistent": ["prior", "hold"],
        "thresholds": [thresholds],
    }
    model |= {key: chance.choice(of) for key, of in further.items() if chance.random() < 0.6}
    model["discretisation"] = discretisation
    source = {"id": "x", "type": "std_msgs/Float32", "topic": "/x"}
    return {"Model": model, "SimulatorOutputs": [source], "EDDIInputs": inputs}
