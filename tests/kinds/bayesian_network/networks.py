"""Networks for tests: files of the oracle, and random ones with a brute-force answer."""

import json
import math
from collections.abc import Iterable
from pathlib import Path

from eddi_runtime.bayesian_network import BayesianNetworkMonitor
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import Model, ReadResult, kinds
from eddi_scaffold.kinds.bayesian_network.network import Network, Node
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models

KIND = kinds()["bayesian_network"]


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


@st.composite
def networks(draw: st.DrawFn, most: int = 6) -> Network:
    """Small random networks with zeros, certain nodes and rows, and parents in any order."""
    count = draw(st.integers(1, most))
    cards = [draw(st.integers(1, 3)) for _ in range(count)]
    nodes = []
    for k in range(count):
        parents = draw(st.lists(st.integers(0, k - 1), unique=True, max_size=3)) if k else []
        rows = math.prod(cards[p] for p in parents)
        table: list[float] = []
        for _ in range(rows):
            weights = draw(st.lists(st.integers(0, 4), min_size=cards[k], max_size=cards[k]))
            total = sum(weights) or 1
            values = (
                [w / total for w in weights] if sum(weights) else [1.0, *[0.0] * (cards[k] - 1)]
            )
            table += [value / math.fsum(values) for value in values]
        nodes.append(
            Node(
                f"n{k}",
                f"n{k}",
                tuple(f"s{j}" for j in range(cards[k])),
                tuple(f"n{p}" for p in parents),
                tuple(table),
            )
        )
    order = draw(st.permutations(nodes))
    return Network("net", tuple(order))
