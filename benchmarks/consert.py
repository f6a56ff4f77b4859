"""Time of a ConSert step: ours, straight-line two-valued Python, and a dictionary interpreter.

Ours is three-valued, reads and checks its inputs and returns the active flags as a tuple. The
straight-line peer is what one would write by hand: it reads the same attributes, trusts their types
and knows True and False only. The interpreter walks dictionaries by id with three values. Ours and
the peer are measured in turn; goal: at least 3 times faster than the compiled wheel of conserts-rs.

    python benchmarks/consert.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import random
import statistics
import sys
import time
import timeit
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_runtime import EDDIInputBase, InputSpec  # noqa: E402 - a benchmark runs from the checkout

from eddi_scaffold.kinds.consert.consert import (  # noqa: E402
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    NumericDimension,
)
from eddi_scaffold.kinds.consert.consert_model import ConSertModel  # noqa: E402
from runtime_lib.tests import conserts  # noqa: E402
from runtime_lib.tests.bound_models import BoundModel  # noqa: E402

SIZES = {1: (2, 2), 30: (61, 2), 300: (601, 10)}
"""Gates -> (inputs, guarantees)."""

WHEEL_NS = {1: 983, 30: 4_743, 300: 78_282}
"""Gates -> ns per step of the wheel of conserts-rs 0.1.6, measured once (CPython 3.11)."""

Step = Callable[[Any], Any]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    runs, seconds = (5, 0.01) if options.quick else (21, 0.05)
    rows = [row for gates in SIZES for row in rows_of(gates, runs, seconds)]
    rows.append(row_of_ages(runs, seconds))
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def rows_of(gates: int, runs: int, seconds: float) -> list[dict[str, object]]:
    """Return every row of one size."""
    bound = model_of(gates, *SIZES[gates])
    assert isinstance(bound.model, ConSertModel)
    monitor, consert = bound.monitor(), bound.model.data
    source = some_inputs(consert)
    straight, interpreted = straight_line(consert), interpreter(consert)
    flags = monitor.step(source)
    assert flags == straight(source) == interpreted(source)
    name = f"{gates} gate{'s' * (gates > 1)}"

    def beside(case: str, ours: Step, peer: str, its: Step) -> dict[str, object]:
        return paired(f"{case}, {name}", ours, peer, its, source, runs, seconds)

    def alone(case: str, ours: Step, reason: str) -> dict[str, object]:
        ours_s = statistics.median(per_call(ours, source, seconds) for _ in range(runs))
        row = {"case": f"{case}, {name}", "ours_s": ours_s, "peer": None, "peer_s": None}
        return row | {"ratio": None, "reason": reason}

    wheel = f"conserts-rs cannot be installed; its wheel once took {WHEEL_NS[gates]} ns"
    return [
        beside("step", monitor.step, "straight-line, two-valued", straight),
        beside("step", monitor.step, "dictionary interpreter", interpreted),
        alone("step", monitor.step, wheel) | {"peer": "conserts-rs 0.1.6"},
        alone("execute_step (list of dicts)", monitor.execute_step, "D7.2 Fig 9 shape"),
        alone("explain all", lambda _: monitor.explain(), "no peer explains"),
        alone(
            "compile",
            lambda _: bound.monitor(),
            "checked and imported, no file",
        ),
    ]


def row_of_ages(runs: int, seconds: float) -> dict[str, object]:
    """Return what it costs per input that plain Python keeps ages: of new messages and a step.

    The peer is the same without: every age is told, as by a node, and no step looks again.
    """
    count = 15
    given = type("EDDIInput", (EDDIInputBase,), {})(
        [InputSpec(f"x{k}", f"x{k}", (f"t{k}",), 0.5) for k in range(count)]
    )
    methods = [(f"x{k}", partial(setattr, given, f"x{k}"), (f"t{k}",)) for k in range(count)]
    loops = [{f"t{k}": [k] for k in range(count)} for _ in range(2)]
    fresh: dict[str, float] = {}

    def update(messages: dict[str, Any]) -> None:
        for name, process, requires in methods:
            given.update(name, process, messages, requires)

    def kept(_: Any) -> None:
        loops.reverse()
        given.begin_processing()
        update(loops[0])
        given.look_again(None)

    def told(_: Any) -> None:
        loops.reverse()
        given.begin_step(fresh)
        update(loops[0])

    pairs = [(per_call(kept, None, seconds), per_call(told, None, seconds)) for _ in range(runs)]
    more = statistics.median(one - other for one, other in pairs) / count
    row = {"case": "ages of plain Python, per input of 15", "ours_s": more, "peer": None}
    return row | {"peer_s": None, "ratio": None, "reason": "above ages that are told; limit 800 ns"}


def paired(
    case: str, ours: Step, peer: str, its: Step, source: Any, runs: int, seconds: float
) -> dict[str, object]:
    """Measure ours and the peer in turn; the ratio is the median of the pairs."""
    pairs = [(per_call(ours, source, seconds), per_call(its, source, seconds)) for _ in range(runs)]
    return {
        "case": case,
        "ours_s": statistics.median(one for one, _ in pairs),
        "peer": peer,
        "peer_s": statistics.median(other for _, other in pairs),
        "ratio": statistics.median(other / one for one, other in pairs),
    }


def per_call(step: Step, source: Any, seconds: float) -> float:
    """Return the seconds of one call, of a loop that takes about ``seconds``."""
    names = {"step": step, "source": source}
    # Time of this process: others on the machine do not count.
    timer = timeit.Timer("step(source)", globals=names, timer=time.process_time)
    number, once = 1, timer.timeit(1)
    while once < seconds:
        number = max(2 * number, int(number * seconds / max(once, 1e-6)))
        once = timer.timeit(number)
    return once / number


def model_of(gates: int, inputs: int, guarantees: int) -> BoundModel:
    """Return a random ConSert that is the same in every run; most evidence is binary."""
    rng = random.Random(gates)
    leaves = [f"evidence_{k}" for k in range(inputs)]
    edges = []
    unused = list(leaves)
    made: list[str] = []
    for k in range(gates):
        count = min(len(unused), -(-(len(unused) + gates - k - 1) // (gates - k)))
        sources = [unused.pop(0) for _ in range(count)]
        sources += rng.sample(made[-4:], min(1, len(made)))
        made.append(f"gate_{k}")
        edges += [[source, made[-1]] for source in sources]
    for k in range(guarantees):
        edges.append([made[-1 - k] if k < len(made) else leaves[0], f"guarantee_{k}"])
    others = {8: conserts.categorical("low", "medium"), 9: conserts.numeric("[0, 5]")}
    bound: BoundModel = conserts.consert(
        [(leaf, others.get(k % 10, conserts.binary())) for k, leaf in enumerate(leaves)],
        gates=[f"{gate}{rng.choice('&|')}" for gate in made],
        guarantees=[f"guarantee_{k}" for k in range(guarantees)],
        edges=edges,
        name="Benchmark",
    )
    return bound


def some_inputs(consert: ConSert) -> EDDIInputBase:
    """Return values of which three of four are good; the others are bad or None in turn."""
    values = {
        BinaryDimension: (True, False),
        CategoricalDimension: ("low", "high"),
        NumericDimension: (2.5, 7.5),
    }
    source: EDDIInputBase = type("EDDIInput", (EDDIInputBase,), {})()
    for k, leaf in enumerate(consert.evidence):
        good, bad = values[type(leaf.dimension)]
        setattr(source, leaf.id, good if k % 4 else None if k % 8 else bad)
    return source


def straight_line(consert: ConSert) -> Step:
    """Return two-valued code as one would write it by hand; None is not True."""
    tests = {
        BinaryDimension: "x.{0} is True",
        CategoricalDimension: "x.{0} in ('low', 'medium')",
        NumericDimension: "x.{0} is not None and 0.0 <= x.{0} <= 5.0",
    }
    lines = ["def step(x):"]
    lines += [
        f"    {leaf.id} = {tests[type(leaf.dimension)].format(leaf.id)}"
        for leaf in consert.evidence
    ]
    lines += [
        f"    {name} = {f' {function.lower()} '.join(sources)}"
        for name, (function, sources) in nodes(consert).items()
    ]
    flags = ", ".join(guarantee.id for guarantee in consert.guarantees)
    names: dict[str, Any] = {}
    exec("\n".join([*lines, f"    return ({flags},)"]), names)
    step: Step = names["step"]
    return step


def nodes(consert: ConSert) -> dict[str, tuple[str, list[str]]]:
    """Return gate or guarantee -> (function, inputs), inputs first."""
    functions: dict[str, str] = {gate.id: gate.function for gate in consert.gates}
    functions |= {guarantee.id: "And" for guarantee in consert.guarantees}
    sources: dict[str, list[str]] = {name: [] for name in functions}
    for edge in consert.tree_propagations:
        sources[edge.target].append(edge.source)
    return {name: (function, sources[name]) for name, function in functions.items()}


def interpreter(consert: ConSert) -> Step:
    """Return a three-valued evaluation that looks everything up by id (FALSE 0, TRUE 2)."""
    graph = nodes(consert)
    guarantees = [guarantee.id for guarantee in consert.guarantees]
    evidence: list[dict[str, Any]] = [
        {"id": leaf.id, "kind": type(leaf.dimension)} for leaf in consert.evidence
    ]

    def judged(kind: type, value: Any) -> int:
        if value is None:
            return 1
        if kind is NumericDimension:
            return 2 if 0 <= value <= 5 else 0
        return 2 if value in (("low", "medium") if kind is CategoricalDimension else (True,)) else 0

    def step(x: Any) -> tuple[bool, ...]:
        values = {}
        for item in evidence:
            values[item["id"]] = judged(item["kind"], getattr(x, item["id"]))
        for name, (function, sources) in graph.items():
            found = [values[source] for source in sources]
            values[name] = min(found) if function == "And" else max(found)
        return tuple(values[name] == 2 for name in guarantees)

    return step


def print_table(rows: list[dict[str, Any]]) -> None:
    print(f"{'case':<42} {'ours':>12}  {'peer':>12} {'ratio':>6}  which peer")
    for row in rows:
        peer = f"{row['peer_s'] * 1e9:>9,.0f} ns" if row["peer_s"] else f"{'-':>12}"
        ratio = f"{row['ratio']:.2f}" if row["ratio"] else "-"
        why = row["peer"] or ""
        reason = f"({row['reason']})" if row.get("reason") else ""
        ours = f"{row['ours_s'] * 1e9:>9,.0f} ns"
        print(f"{row['case']:<42} {ours}  {peer} {ratio:>6}  {why} {reason}".rstrip())


if __name__ == "__main__":
    main()
