"""Fault trees, chains, batteries and processors that follow what is observed of them.

They live for seconds, so that what happened in a gap matters.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any

from tests.deployments.pool.templates import (
    AGAINST,
    SOURCES,
    Config,
    Leaf,
    Rank,
    Reading,
    Slot,
    Template,
    dump,
)


def _percent(value: Any) -> bool:
    return type(value) is float and 0.0 <= value <= 100.0


def _below_limit(value: Any) -> bool:
    return type(value) is float and value <= 90.0


def _band(value: Any) -> int:
    """Return how empty a battery is: levels above 75, 50 and 25 % are its bands."""
    return sum(value <= edge for edge in (75.0, 50.0, 25.0))


def _number(fits: Callable[[Any], bool]) -> Reading:
    leaf = Leaf("data", (10.0, 30.0, 50.0, 90.0), fits)
    return Reading("number", "std_msgs/Float64", (leaf,), "float", field="data")


FLAG = SOURCES["flag"]
LEVEL, LIMITED = _number(_percent), _number(_below_limit)
TREES: Sequence[Mapping[str, Any]] = (
    {"type": "OR", "of": ["a"]},
    {"type": "AND", "of": ["a", "b"]},
    {"type": "OR", "of": ["a", "b"]},
    {"type": "VOTE", "k": 2, "of": ["a", "b", "c"]},
)
BATTERY = {"failure_rate": "0.05 1/s", "alpha": "1 1/s", "beta": "1 1/s", "degradation": "1 1/s"}
PROCESSOR = {"mttf_ref": "20 s", "t_ref": "30 degC", "t_max": "90 degC", "u_max": 90}


@dataclass(frozen=True)
class _Part:
    """A model and what is observed of it: suffix of the input -> reading, rank, usual value."""

    model: Mapping[str, Any]
    inputs: Mapping[str, tuple[Reading, Rank | None, Any]]


def reliabilities(count: int) -> Iterator[Template]:
    """Yield models of every sort, with thresholds and ways to take what is unknown."""
    for number in range(count):
        rng = Random(f"reliability {number}")
        repair = number % 5 == 4
        part = (_tree, _tree, _chain, _battery, _tree, _processor)[number % 6](rng, repair)
        yield _reliability(f"fit{number}", part, rng)


def _tree(rng: Random, repair: bool) -> _Part:
    """Return a tree of events of which each fails with 0.095 within the horizon."""
    tree = rng.choice(TREES)
    ways = [FLAG, FLAG, FLAG, *AGAINST.values()]
    inputs = {}
    for event in tree["of"]:
        reading = rng.choice(ways)
        gone = reading.expression is None  # `NOT g.active`: it has failed while that is false
        tells = reading is not AGAINST["no guarantee"]  # the false of that says nothing
        inputs[event] = (reading, _gone(gone) if tells and not repair else None, False)
    events = {one: {"rate": "0.1 1/s", "observed": True} for one in tree["of"]}
    model = {"type": "fault_tree", "top": "top", "gates": {"top": dict(tree)}, "events": events}
    return _Part({**model, **({"repair": True} if repair else {})}, inputs)


def _chain(rng: Random, repair: bool) -> _Part:
    arcs = [
        {"from": "Up", "to": "Worn", "rate": "0.2 1/s"},
        {"from": "Worn", "to": "Down", "rate": "1 1/s"},
    ]
    if repair:
        arcs.append({"from": "Worn", "to": "Up", "rate": "1 1/s"})
    seen = rng.choice(
        (
            {"Up": "ok", "Worn": "not ok", "Down": "not ok"},
            {"Up": "ok", "Worn": "ok", "Down": "not ok"},
        )
    )
    model = {"type": "markov", "initial": "Up", "fail": ["Down"], "arcs": arcs, "observe": seen}
    rank = None if repair else _gone(False)
    return _Part({**model, **({"repair": True} if repair else {})}, {"ok": (FLAG, rank, True)})


def _battery(rng: Random, repair: bool) -> _Part:
    rank = None if repair else _band
    model = {"type": "battery", **BATTERY, **({"repair": True} if repair else {})}
    return _Part(model, {"level": (LEVEL, rank, 90.0)})


def _processor(rng: Random, repair: bool) -> _Part:
    inputs = {"temperature": (LIMITED, None, 10.0), "utilisation": (LIMITED, None, 10.0)}
    return _Part({"type": "processor", **PROCESSOR}, inputs)


def _gone(value: bool) -> Rank:
    return lambda seen: int(seen is value)


def _reliability(name: str, part: _Part, rng: Random) -> Template:
    level = rng.choice((0.1, 0.15, 0.2, 0.6))
    threshold: dict[str, Any] = {
        "id": "Fit",
        "activate": level,
        "release": level + rng.choice((0.0, 0.1)),
    }
    if rng.random() < 0.3:
        threshold["hold"] = "1 s"
    mode = rng.choice(("worst_case", "worst_case", "inactive"))
    model = {
        "horizon": "1 s",
        "on_unknown": mode,
        "models": {name: dict(part.model)},
        "thresholds": [threshold],
    }
    file = f"{name}_reliability.yml"
    every = 1000 if rng.random() < 0.1 else 500
    config = Config(name, "Reliability", ("config", file), every)
    slots = []
    for suffix, (reading, rank, good) in part.inputs.items():
        limit = rng.choice((0.7, 1.2) if reading in (FLAG, LEVEL, LIMITED) else (1.2, 1.7))
        slots.append(Slot(f"s_{suffix}", reading, limit, rank=rank, good=good))
        config.input(suffix if part.model["type"] == "markov" else f"{name}_{suffix}", slots[-1])
    files = {file: dump(model), f"{name}_config.yml": config.text()}
    return Template(name, "reliability", files, tuple(slots), {"reliability": ""}, every)
