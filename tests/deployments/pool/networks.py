"""Bayesian networks with thresholds over what is known of two observed nodes."""

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any

from tests.deployments.pool.templates import (
    NUMBERS,
    SOURCES,
    TEXTS,
    Config,
    Leaf,
    Reading,
    Slot,
    Template,
)

_MODEL, _SETTINGS = (
    Path(__file__).with_name(name).read_text("utf-8") for name in ("network.xmlbif", "scope.yml")
)
ARRAY = Reading("array", "std_msgs/Float64MultiArray", (), "float[]", field="data")
"""It has no leaves: what is unknown of it is the verdict, which its completion draws."""
USUAL = (0.5, 9.5, 2.5, 7.5, 5.0)
FAR = 90.0


def scopes() -> Iterator[Template]:
    """Yield a monitor for each way to go on without a verdict."""
    for mode in ("hold", "clear"):
        name = f"scope_{mode}"
        file, reference = f"{name}_safeml.yml", f"{name}_reference.csv"
        settings = _SETTINGS.replace("REFERENCE", reference).replace("MODE", mode)
        config = Config(name, "SafeML", ("config", file))
        slot = Slot("s_x", ARRAY, 1.2, good=USUAL)
        config.source(slot)
        config.inputs.append(
            {"id": "frame", "type": "float[]", "requires": ["s_x"], "field": "data"}
        )
        rows = "".join(f"{7 * k % 20 / 2}\n" for k in range(20))
        files = {file: settings, reference: rows, f"{name}_config.yml": config.text()}
        yield Template(name, "safeml", files, (slot,), {"scope": "/status", "verdict": ""})


ROWS = ("0.9 0.1  0.4 0.6  0.2 0.8  0.05 0.95", "0.8 0.2  0.1 0.9  0.3 0.7  0.02 0.98")
"""P(High, Low | Near, Human): of two tables, each with a probability above 0 for every state."""
THRESHOLDS: Sequence[Mapping[str, Any]] = (
    {"at_most": 0.3, "state": "High"},
    {"at_most": 0.1, "state": "High"},
    {"at_most": 0.25, "state": "High", "release": 0.45},
    {"at_least": 0.7, "state": "Low"},
    {"at_least": 0.9, "state": "Low", "release": 0.55},
    {"at_most": 0.3, "state": "High", "hold": "1 s"},
)
_KNOWN_TEXT = Leaf("data", TEXTS, lambda value: value in TEXTS)
_IN_RANGE = Leaf("data", NUMBERS, lambda value: type(value) is float and 0.0 <= value <= 100.0)
OBSERVED: Mapping[str, tuple[Reading, Mapping[str, Any], Any]] = {
    "flag": (SOURCES["flag"], {"map": {True: "Yes", False: "No"}}, False),
    "bins": (SOURCES["number"], {"bins": [40.0], "order": ["Yes", "No"]}, 90.0),
    "range": (
        Reading("number", "std_msgs/Float64", (_IN_RANGE,), "float", field="data"),
        {"bins": [40.0], "order": ["Yes", "No"], "range": [0, 100]},
        90.0,
    ),
    "hysteresis": (
        SOURCES["number"],
        {"bins": [40.0], "order": ["Yes", "No"], "hysteresis": 15.0},
        90.0,
    ),
    "text": (
        Reading("text", "std_msgs/String", (_KNOWN_TEXT,), "str", field="data"),
        {"map": {"fog": "Yes", "clear": "No"}},
        "clear",
    ),
}
"""How a node of the states Yes and No is observed: reading, rule, a favourable value."""


def networks(count: int) -> Iterator[Template]:
    for number in range(count):
        rng = Random(f"network {number}")
        threshold = THRESHOLDS[number % len(THRESHOLDS)]
        ways = {node: rng.choice(list(OBSERVED)) for node in ("Near", "Human")}
        yield _network(f"risk{number}", ways, threshold, rng)


def bare_network() -> Template:
    """Return a network whose posterior is all that it tells."""
    return _network("bare", {"Near": "flag", "Human": "flag"}, None, Random("bare"))


def _network(
    name: str, ways: Mapping[str, str], threshold: Mapping[str, Any] | None, rng: Random
) -> Template:
    config = Config(name, "BayesianNetwork", ("model", f"{name}.xmlbif"))
    slots, rules = [], {}
    for node, way in ways.items():
        reading, rule, good = OBSERVED[way]
        accepts = threshold is not None and rng.random() < 0.06
        limit = rng.choice((0.7, 1.2))
        slot = Slot(f"s_{node}", reading, limit, accepts_unknown=accepts, good=good)
        slots.append(slot)
        config.input(node.lower(), slot)
        missing = {"missing": "prior"} if accepts else {}
        rules[node] = {"input": node.lower(), **deepcopy(dict(rule)), **missing}
    config.model = {"outputs": ["Risk"], "discretisation": rules}
    if threshold is not None:
        config.model["evidence"] = [{"id": "Low", "node": "Risk", **threshold}]
    model = _MODEL.replace("TITLE", name).replace("ROWS", rng.choice(ROWS))
    files = {f"{name}.xmlbif": model, f"{name}_config.yml": config.text()}
    offers = {"posterior": ""} if threshold is None else {"threshold": "/evidence"}
    return Template(name, "bayesian_network", files, tuple(slots), offers)
