"""Time of a step of a Bayesian network monitor, beside pgmpy and pyAgrum.

Ours is the whole step: inputs are read and judged, posteriors inferred, D7.2's data classes built.
The peers get evidence that is ready and give lists of numbers. Evidence varies from step to step;
"seen" is when the states were seen before and their posteriors are remembered.
Goals: 100 times faster than what D7.2's generated code does with pgmpy on up to 40 nodes, and
ahead of pyAgrum's LazyPropagation everywhere.

    python benchmarks/bayesian_network.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import itertools
import json
import random
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_runtime.bayesian_network import BayesianNetworkMonitor  # noqa: E402 - runs from the checkout

from benchmarks import bayesian_network_peers as peers  # noqa: E402
from benchmarks.bayesian_network_peers import Evidence, Net  # noqa: E402
from benchmarks.timing import per_call  # noqa: E402
from eddi_scaffold.kinds.bayesian_network.compile import compile_network  # noqa: E402
from eddi_scaffold.kinds.bayesian_network.inference_plan import Width, width_of  # noqa: E402
from eddi_scaffold.kinds.bayesian_network.network import Shape  # noqa: E402
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions  # noqa: E402
from eddi_scaffold.program.input_expressions import BoundInput  # noqa: E402
from eddi_scaffold.program.monitor_text import Declaration  # noqa: E402
from eddi_scaffold.program.running import module_of  # noqa: E402
from runtime_lib.tests.bound_models import text_of  # noqa: E402

CRITICAL = [0.2, 0.8, 0.1, 0.9, 0.05, 0.95, 0.5, 0.5, 0.25, 0.75, 0.1, 0.9]
CRITICAL += [0.7, 0.3, 0.4, 0.6, 0.2, 0.8, 0.9, 0.1, 0.65, 0.35, 0.45, 0.55]
PEDESTRIAN = Net(
    [4, 3, 2],
    [[], [], [0, 1]],
    [
        [0.25] * 4,
        [0.34, 0.33, 0.33],
        CRITICAL,
    ],
)
CASES = 40
_IMPORT = """
import sys, time
sys.path.insert(0, {path!r})
start = time.process_time()
{text}
spent = time.process_time() - start
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
print(spent, status["VmRSS"].split()[0])
"""
IMPORTS = {
    "ours": "import eddi_runtime.bayesian_network",
    "ours with numpy": "import eddi_runtime.bayesian_network.arrays",
    "pgmpy, as generated": "import pgmpy.inference, pgmpy.models, pgmpy.readwrite",
    "pyAgrum LazyPropagation": "import pyagrum",
}


class Methods:
    """The methods of a package: two written by hand, one as it was generated."""

    def __init__(self) -> None:
        self.dra_data: Any = None

    def update_dra_data(self, dra_data: Any) -> None:
        """Take over what the step was given."""
        self.dra_data = getattr(dra_data, "data", dra_data)

    def node_n0(self) -> tuple[bool, dict[str, float]]:
        """Say in which state the node is."""
        outcomes = dict.fromkeys(("s0", "s1", "s2", "s3"), 0.0)
        outcomes[self.dra_data.n0] = 1.0
        return False, outcomes

    def node_n1(self) -> tuple[bool, dict[str, float]]:
        """Say in which state the node is."""
        outcomes = dict.fromkeys(("s0", "s1", "s2"), 0.0)
        outcomes[self.dra_data.n1] = 1.0
        return False, outcomes

    def node_n2(self) -> tuple[bool, dict[str, float]]:
        """Say nothing, as generated."""
        is_bn_output = False
        outcome_s0 = 0.0
        outcome_s1 = 0.0
        return is_bn_output, {"s0": outcome_s0, "s1": outcome_s1}


class Task(NamedTuple):
    """What is asked of a network in each step."""

    name: str
    net: Net
    outputs: tuple[int, ...]
    observed: tuple[int, ...]
    missing: float
    virtual: float
    hooks: object = None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for task in tasks():
        rows += rows_of(task, runs=3 if options.quick else 9, quick=options.quick)
    rows += [growth(100_000 if options.quick else 1_000_000)]
    rows += list(imports(3 if options.quick else 7))
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def tasks() -> Iterator[Task]:
    yield Task("pedestrian 3/2/1", PEDESTRIAN, (2,), (0, 1), 0.0, 0.0)
    yield Task("pedestrian 3/2/1, 30 % virtual", PEDESTRIAN, (2,), (0, 1), 0.0, 0.3)
    yield Task("pedestrian 3/2/1, methods", PEDESTRIAN, (2,), (0, 1), 0.0, 0.0, Methods())
    yield from variants("chain", peers.chain(30))
    yield from variants("grid", peers.grid(6, 6))
    yield from variants("grid", peers.grid(12, 12), few=True)
    for name in peers.SHIPPED:
        net = peers.shipped(name)
        if net is not None:
            yield from variants(name, net, few=len(net.cards) > 40)


def variants(name: str, net: Net, *, few: bool = False) -> Iterator[Task]:
    count = len(net.cards)
    nodes = random.Random(count).sample(range(count), count)
    inputs = min(count // 2, 15)
    for outputs, missing, virtual in [(1, 0.0, 0.0), (1, 0.25, 0.0), (3, 0.0, 0.0), (1, 0.0, 0.3)]:
        if few and (missing or virtual):
            continue
        title = f"{name} {count}/{inputs}/{outputs}"
        title += f", {missing:.0%} missing".replace("%", " %") if missing else ""
        title += ", 30 % virtual" if virtual else ""
        observed = tuple(sorted(nodes[3 : 3 + inputs]))
        yield Task(title, net, tuple(sorted(nodes[:outputs])), observed, missing, virtual)


def rows_of(task: Task, runs: int, *, quick: bool) -> Iterator[dict[str, Any]]:
    """Measure ours and each peer in turn; the ratio is the median of the pairs."""
    evidence = evidence_of(task)
    kind = module_of(compiled(task), task.name).Monitor
    start = time.perf_counter()
    monitor = kind(task.hooks)
    load_s = time.perf_counter() - start
    monitor.remembered = 0  # what was seen before is inferred again
    sources = [source_of(task, one) for one in evidence]
    common = {
        "ours_p99_s": percentile_99(monitor, sources, 2_000 if quick else 20_000),
        "load_s": load_s,
        "largest_table": largest_table(task),
    }
    ours = endless(monitor.execute_step, sources)
    for name, make in peers.PEERS.items():
        try:
            infer = make(task.net, task.outputs)
        except ImportError:
            row: dict[str, Any] = alone(task.name, name, ours, runs)
        else:
            compare(monitor, infer, task, evidence[0])
            row = paired(task.name, name, ours, endless(infer, evidence), runs)
            if name.startswith("pgmpy") and len(task.outputs) == 1 and not task.virtual:
                yield row | common
                again = endless(monitor_of(task).execute_step, sources)
                row = paired(f"{task.name}, seen", name, again, endless(infer, evidence), runs)
        yield row | common


def paired(
    case: str, peer: str, ours: Callable[[], object], its: Callable[[], object], runs: int
) -> dict[str, Any]:
    pairs = [(per_call(ours, 0.02), per_call(its, 0.1)) for _ in range(runs)]
    return {
        "case": case,
        "ours_s": statistics.median(one for one, _ in pairs),
        "peer": peer,
        "peer_s": statistics.median(other for _, other in pairs),
        "ratio": statistics.median(other / one for one, other in pairs),
    }


def alone(case: str, peer: str, ours: Callable[[], object], runs: int) -> dict[str, Any]:
    row = {
        "case": case,
        "ours_s": statistics.median(per_call(ours, 0.02) for _ in range(runs)),
        "peer": peer,
    }
    return row | {"peer_s": None, "ratio": None, "reason": "the peer is not installed"}


def evidence_of(task: Task) -> list[Evidence]:
    """Return evidence for some steps, the same in every run; all of it is possible."""
    rng = random.Random(len(task.observed))
    found: list[Evidence] = []
    for _ in range(CASES):
        states = peers.sampled(task.net, rng)
        case: dict[int, int | Sequence[float]] = {}
        for node in task.observed:
            if rng.random() < task.missing:
                continue
            case[node] = states[node]
            if rng.random() < task.virtual:
                case[node] = [rng.uniform(0.05, 1.0) for _ in range(task.net.cards[node])]
        found.append(case)
    return found


def compiled(task: Task) -> str:
    observed = tuple(f"n{node}" for node in task.observed)
    outputs = tuple(f"n{node}" for node in task.outputs)
    direct, width = {name: name for name in observed}, Width(0, ())
    options = NetworkOptions(outputs, observed, (), direct, (), width)
    inputs = tuple(BoundInput(name, name) for name in observed)
    declaration = Declaration("Benchmark", "", inputs)
    parts = compile_network(peers.network_of(task.net), options, declaration)
    return text_of("bayesian_network", parts, declaration)


def monitor_of(task: Task) -> BayesianNetworkMonitor:
    made: BayesianNetworkMonitor = module_of(compiled(task), task.name).Monitor(task.hooks)
    return made


def largest_table(task: Task) -> int:
    net = task.net
    shape = Shape(
        tuple(map(str, range(len(net.cards)))), tuple(net.cards), tuple(map(tuple, net.parents))
    )
    return width_of(shape, task.outputs, task.observed).largest


def source_of(task: Task, evidence: Evidence) -> SimpleNamespace:
    """Return an object with one attribute per input: a state's name, or likelihoods.

    What is missing is None, as in the generated ``EDDIInput``.
    """
    values: dict[str, object] = dict.fromkeys(f"n{k}" for k in task.observed)
    values.update((f"n{k}", f"s{v}" if isinstance(v, int) else v) for k, v in evidence.items())
    return SimpleNamespace(**values)


def compare(
    monitor: BayesianNetworkMonitor, infer: peers.Infer, task: Task, evidence: Evidence
) -> None:
    """Check that both give the same result before they are timed."""
    (output,) = monitor.execute_step(source_of(task, evidence))
    rows: Any = infer(evidence)
    for node, row in zip(output.output_nodes, rows, strict=True):
        for outcome, value in zip(node.outcomes, row, strict=True):
            assert abs(outcome.value - value) < 1e-9, (task.name, node, row)


def endless(step: Callable[[Any], object], given: Sequence[Any]) -> Callable[[], object]:
    """Return a function that takes the next of the given things in each call."""
    values = itertools.cycle(given)
    return lambda: step(next(values))


def percentile_99(monitor: BayesianNetworkMonitor, sources: Sequence[Any], steps: int) -> float:
    step, clock, found = monitor.execute_step, time.perf_counter_ns, []
    for _, source in zip(range(steps), itertools.cycle(sources), strict=False):
        start = clock()
        step(source)
        found.append(clock() - start)
    return sorted(found)[int(len(found) * 0.99)] / 1e9


def growth(steps: int) -> dict[str, Any]:
    """Return how much memory many steps leave behind; there is no peer."""
    task = next(one for one in variants("grid", peers.grid(6, 6)) if "virtual" in one.name)
    monitor = monitor_of(task)
    call = endless(monitor.execute_step, [source_of(task, one) for one in evidence_of(task)])
    for _ in range(steps // 10):
        call()
    before, start = resident(), time.process_time()
    for _ in range(steps):
        call()
    spent = time.process_time() - start
    return {
        "case": f"{task.name}: {steps:,} steps",
        "ours_s": spent / steps,
        "peer": None,
        "peer_s": None,
        "ratio": None,
        "reason": f"memory grew by {(resident() - before) / 1024:.0f} KiB",
    }


def resident() -> int:
    """Return the resident memory of this process in bytes (Linux)."""
    import resource

    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize()


def imports(runs: int) -> Iterator[dict[str, Any]]:
    """Return time and memory of importing each library in a fresh interpreter."""
    found = {name: imported(text, runs) for name, text in IMPORTS.items()}
    for mine, peer in itertools.product(list(IMPORTS)[:2], list(IMPORTS)[2:]):
        (ours_s, ours_mib), (peer_s, peer_mib) = found[mine], found[peer]
        assert ours_s is not None
        row = {"case": f"import ({mine})", "ours_s": ours_s, "peer": peer, "peer_s": peer_s}
        memory = {"ours_mib": ours_mib, "peer_mib": peer_mib}
        if peer_s is None:
            yield row | {"ratio": None, "reason": "it is not installed"} | memory
        else:
            reason = f"{ours_mib:.0f} and {peer_mib:.0f} MiB resident"
            yield row | {"ratio": peer_s / ours_s, "reason": reason} | memory


def imported(text: str, runs: int) -> tuple[float | None, float | None]:
    """Return (median seconds, MiB resident afterwards), None when it cannot be had."""
    script = _IMPORT.format(path=str(ROOT / "runtime_lib" / "src"), text=text)
    seconds, memory = [], 0.0
    for _ in range(runs):
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
        if done.returncode:
            return None, None
        spent, kib = done.stdout.split()
        seconds.append(float(spent))
        memory = float(kib) / 1024
    return statistics.median(seconds), memory


def print_table(rows: Sequence[dict[str, Any]]) -> None:
    print(
        f"{'case':<36} {'ours':>10} {'p99':>10} {'load':>8} {'peer':>12} {'ratio':>7}  which peer"
    )
    for row in rows:
        p99 = f"{row['ours_p99_s'] * 1e6:>7,.1f} us" if "ours_p99_s" in row else f"{'-':>10}"
        load = f"{row['load_s'] * 1e3:>5,.0f} ms" if "load_s" in row else f"{'-':>8}"
        peer = f"{row['peer_s'] * 1e6:>9,.0f} us" if row["peer_s"] else f"{'-':>12}"
        ratio = f"{row['ratio']:.1f}" if row["ratio"] else "-"
        reason = f"({row['reason']})" if row.get("reason") else ""
        ours = f"{row['ours_s'] * 1e6:>7,.1f} us"
        line = (
            f"{row['case']:<36} {ours} {p99} {load} {peer} {ratio:>7}  {row['peer'] or ''} {reason}"
        )
        print(line.rstrip())


if __name__ == "__main__":
    main()
