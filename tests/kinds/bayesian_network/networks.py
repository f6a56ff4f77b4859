"""Networks for tests: files of the oracle, and random ones with a brute-force answer."""

import json
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from random import Random

from eddi_runtime.bayesian_network import BayesianNetworkMonitor
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from runtime_lib.tests.bayesian_network.networks import nodes_of, random_network


def read(text: str | bytes, name: str) -> ReadResult:
    data = text.encode() if isinstance(text, str) else text
    return read_models(Source(name, data))


def read_path(path: Path) -> Model:
    reading = read_models(read_source(path))
    (model,) = reading.models
    return model


def joined(model: Model, config: str | None = None) -> tuple[BoundMonitor | None, list[Problem]]:
    if config is None:
        return monitor_of(model, None)
    file, problems = read_config(Source("eddi_config.yml", config.encode()))
    if file is None:
        return None, problems
    monitor, more = monitor_of(model, file)
    return monitor, [*problems, *more]


def of_states(outputs: Iterable[str], observed: Iterable[str]) -> str:
    """Return a configuration in which messages report the states of some nodes."""
    rows = (f"- {{id: {json.dumps(name)}, requires: [x], max_age: none}}\n" for name in observed)
    return (
        f"Model: {{id: net, type: BayesianNetwork, outputs: {json.dumps([*outputs])}}}\n"
        "SimulatorOutputs: [{id: x, type: std_msgs.String, topic: /x}]\n"
        f"EDDIInputs:\n{''.join(rows)}"
    )


def running(monitor: BoundMonitor) -> BayesianNetworkMonitor:
    found = monitor.compiled.monitor(monitor.id)
    assert isinstance(found, BayesianNetworkMonitor)
    return found


def networks(most: int = 6) -> st.SearchStrategy[Network]:
    """Small random networks with zeros, certain nodes and rows, and parents in any order."""
    return st.randoms().map(partial(_network, most))


def _network(most: int, chance: Random) -> Network:
    net = random_network(chance, chance.randint(1, most), zeros=0.4, most_states=3, least_states=1)
    nodes = nodes_of(net)
    chance.shuffle(nodes)
    return Network("net", tuple(nodes))
