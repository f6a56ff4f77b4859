"""Vectors of networks: monitors of random ones pass them, and verify proves each of them."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from eddi_runtime.testing import failures
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.write import to_xmlbif
from eddi_scaffold.packages.verifying import checked
from tests.evidence.mutants import input_class
from tests.kinds.bayesian_network.networks import joined, networks, read


@given(networks(), st.randoms())
def test_the_monitor_of_a_random_network_passes(network: Network, chance: Random) -> None:
    (model,) = read(to_xmlbif(network), "net.xmlbif").models
    monitor, _ = joined(model, json.dumps(configuration(network, chance)))
    assert monitor is not None
    assert checked(monitor, monitor.compiled.text)[1] == []
    text = monitor.model.vectors(monitor.bound, {"model": "net", "sha256": ""})
    assert len(text.encode()) <= 64 * 1024
    if text:
        with TemporaryDirectory() as folder:
            file = Path(folder, "vectors.json")
            file.write_text(text)
            of = type(monitor.compiled.monitor("net"))
            assert failures(str(file), of, input_class(of)) == []


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
