"""Time of a reliability step: chains compared with ``scipy.linalg.expm``, and fault trees by size.

Ours for chains is all that a node calls: inputs, clock, the belief over the states moved by one
quantum, what lies ahead (failure within the horizon, reliability, mean time to failure), evidence,
result; the peer computes the exponential of the same generator, as each step would need without
what was computed in advance. For trees it is one evaluation of the compiled
diagram, and beside it the sum over all combinations of events where there are few enough. Measured
in turn in one process; reading and compiling is not counted.

    python benchmarks/reliability.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import random
import statistics
import sys
from collections.abc import Callable
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core, for the peers too
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from benchmarks.timing import per_call  # noqa: E402 - from the checkout
from eddi_scaffold.kinds.reliability.chains import Chain, battery_chain, rates_of, rotors_chain  # noqa: E402
from eddi_scaffold.kinds.reliability.decision_diagram import build as diagram_of  # noqa: E402
from eddi_scaffold.kinds.reliability.fault_tree import Gate  # noqa: E402
from eddi_scaffold.kinds.reliability.system import ComponentModel  # noqa: E402
from runtime_lib.tests.reliability.reliability_models import (  # noqa: E402
    battery,
    chain,
    event,
    heat,
    processor,
    rotors,
    tree,
)
from runtime_lib.tests.reliability.reliability_models import monitor as monitor_of  # noqa: E402
from tests.kinds.reliability.trees import compiled  # noqa: E402

STATES = (5, 50, 500)
EVENTS = (10, 100, 300)
_NO_SCIPY = "scipy is not installed"
Action = Callable[[], object]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    runs, seconds = (3, 0.02) if options.quick else (9, 0.2)
    rows = [row for states in STATES for row in rows_of_chain(states, runs, seconds)]
    rows += rows_of_monitors(runs, seconds)
    rows += [row_of_tree(events, runs, seconds) for events in EVENTS]
    rows.append(row_of_large_tree(runs, seconds))
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
        return
    print(f"{'case':<34}{'ours':>12}{'peer':>14}{'ratio':>10}  peer")
    for row in rows:
        peer = "-" if row["peer_s"] is None else f"{1e6 * row['peer_s']:.2f} us"
        ratio = "-" if row["ratio"] is None else f"{row['ratio']:.0f}"
        why = row.get("reason", "")
        ours = f"{1e6 * row['ours_s']:.2f} us"
        print(f"{row['case']:<34}{ours:>12}{peer:>14}{ratio:>10}  {row['peer']} {why}")


def rows_of_chain(states: int, runs: int, seconds: float) -> list[dict[str, Any]]:
    """Return the rows of a random chain with about half of all arcs: its step, and a monitor's."""
    chance = np.random.default_rng(states)
    rates = chance.random((states, states)) * (chance.random((states, states)) < 0.5)
    arcs = [(i, j, float(rates[i, j])) for i in range(states) for j in range(states)]
    seen = [(0, "ok", False), (1, "ok", True)]
    alone = stepping([chain(arcs, states, [states - 1])], {})
    observed = stepping([chain(arcs, states, [states - 1], seen)], {"ok": True})
    names = tuple(map(str, range(states)))
    peer = expm_of(Chain(names, 0, (states - 1,), tuple(arcs)))
    cases = (
        ("whole monitor", alone),
        ("whole monitor, observed", observed),
    )
    return [
        paired(f"{states} states, {name}", ours, "scipy expm", peer, runs, seconds, _NO_SCIPY)
        for name, ours in cases
    ]


def rows_of_monitors(runs: int, seconds: float) -> list[dict[str, Any]]:
    """Return the rows of a hexacopter's rotors, and of a drone: three models in a fault tree."""
    names = [f"rotors_motor_{i}" for i in range(6)]
    hexacopter, cells = rotors("PNPNPN", 1e-5), battery(1e-3)
    cpu = processor(4e4, 1.0, 1.0, **heat(0.3, 51.0, 85.0))
    events = [
        *(event("model", model=name) for name in ("rotors", "battery", "cpu")),
        event("exponential", 1e-4, name="gps"),
        event("exponential", 2e-4, name="vio"),
        event("exponential", 1e-3, name="link", input="link"),
    ]
    loss = tree(events, [Gate("AND", (3, 4)), Gate("OR", (0, 1, 2, 5, 6))])
    working: dict[str, Any] = dict.fromkeys(names, True)
    drone = {**working, "battery_level": 80.0, "cpu_temperature": 60.0, "cpu_utilisation": 0.5}
    drone["tree_link"] = False
    chains = [rotors_chain("PNPNPN", [1e-5] * 6), battery_chain(1e-3, 8e-3, 7e-3, 6.4e-3)]
    peers = [expm_of(one) for one in chains]
    parts = [hexacopter, cells, cpu, loss]
    cases = (
        ("hexacopter, whole monitor", stepping([hexacopter], working), peers[:1]),
        ("drone, whole monitor", stepping(parts, drone), peers),
    )
    return [
        paired(name, ours, "scipy expm", both(there), runs, seconds, _NO_SCIPY)
        for name, ours, there in cases
    ]


def both(peers: list[Action | None]) -> Action | None:
    """Return all of the peers as one."""
    actions = [one for one in peers if one is not None]
    if len(actions) < len(peers):
        return None
    return lambda: [one() for one in actions]


def stepping(parts: list[ComponentModel], values: dict[str, Any]) -> Action:
    """Return the step of a monitor with these inputs, 0.1 s after the one before."""
    go = {"id": "go", "activate": 1e-4, "release": 2e-4, "hold": 2.0}
    monitor = monitor_of(parts, values, horizon=0.5, thresholds=[go])
    inputs = SimpleNamespace(**values)
    now = 0

    def step() -> None:
        nonlocal now
        now += 100_000_000
        monitor.execute_step(inputs, now)

    return step


def expm_of(chain: Chain) -> Action | None:
    """Return the exponential that a step would need without what is precomputed."""
    try:
        expm = importlib.import_module("scipy.linalg").expm
    except ImportError:
        return None
    rates = np.array(rates_of(chain))
    matrix = 0.5 * (rates - np.diag(rates.sum(axis=1)))
    return lambda: expm(matrix)


def row_of_tree(events: int, runs: int, seconds: float) -> dict[str, Any]:
    """Return the row of a tree of votes, ANDs and ORs in which every tenth event is shared."""
    chance = random.Random(events)
    gates: list[Gate] = []
    leaves = list(range(events))
    for start in range(0, events, 5):
        group = leaves[start : start + 5]
        if start and chance.random() < 0.5:
            group.append(chance.randrange(max(0, start - 5), start))
        kind = chance.choice(("AND", "VOTE", "OR"))
        gates.append(Gate(kind, tuple(group), 2))
    level = [events + i for i in range(len(gates))]
    while len(level) > 1:
        above = []
        for start in range(0, len(level), 4):
            kind = "OR" if chance.random() < 0.5 else "AND"
            gates.append(Gate(kind, tuple(level[start : start + 4])))
            above.append(events + len(gates) - 1)
        level = above
    diagram = diagram_of(events, gates, level[0])
    evaluate = compiled(diagram, events).failure
    q = [chance.random() * 1e-2 for _ in range(events)]
    peer = (lambda: enumerated(gates, q)) if events <= 10 else None
    case = f"tree, {events} events, {len(diagram.nodes)} nodes"
    reason = "too many combinations"
    return paired(case, lambda: evaluate(q), "enumeration", peer, runs, seconds, reason)


def row_of_large_tree(runs: int, seconds: float) -> dict[str, Any]:
    """Return the row of a vote of 200 out of 400, whose sums are not written out."""
    gates = [Gate("VOTE", tuple(range(400)), 200)]
    diagram = diagram_of(400, gates, 400)
    evaluate = compiled(diagram, 400).failure
    q = [0.4 + i / 4000 for i in range(400)]

    def loop() -> float:
        values = [0.0, 1.0]
        for variable, high, low in diagram.nodes:
            values.append(q[variable] * values[high] + (1.0 - q[variable]) * values[low])
        return values[diagram.root]

    case = f"tree, 400 events, {len(diagram.nodes)} nodes"
    return paired(case, lambda: evaluate(q), "a loop over the nodes", loop, runs, seconds, "")


def enumerated(gates: list[Gate], q: list[float]) -> float:
    """Return the sum over all combinations of events."""
    total = 0.0
    for state in product((0, 1), repeat=len(q)):
        values = list(state)
        for gate in gates:
            count = sum(values[i] for i in gate.of)
            need = {"AND": len(gate.of), "OR": 1, "VOTE": gate.k}[gate.type]
            values.append(int(count >= need))
        if values[-1]:
            weight = 1.0
            for p, happened in zip(q, state, strict=True):
                weight *= p if happened else 1.0 - p
            total += weight
    return total


def paired(
    case: str, ours: Action, name: str, peer: Action | None, runs: int, seconds: float, why: str
) -> dict[str, Any]:
    """Return the medians of runs in turn."""
    mine, theirs = [], []
    for _ in range(runs):
        mine.append(per_call(ours, seconds))
        if peer is not None:
            theirs.append(per_call(peer, seconds))
    row: dict[str, Any] = {"case": case, "ours_s": statistics.median(mine), "peer": name}
    if peer is None:
        return row | {"peer_s": None, "ratio": None, "reason": why}
    ratios = [b / a for a, b in zip(mine, theirs, strict=True)]
    return row | {"peer_s": statistics.median(theirs), "ratio": statistics.median(ratios)}


if __name__ == "__main__":
    main()
