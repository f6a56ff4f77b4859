"""Time of one step of a conditional event: ours, rtamt and reelay, and over window lengths.

100 Hz, windows of 10 s (1,000 samples) unless the case has another length. Ours is `Engine.step`
with raw values, as a monitor calls it; ours and the peer are measured in turn, over equal samples.
rtamt (discrete time) and reelay have no windowed mean, maximum or deviation, so those cases have no
peer. Goals: at least 100 times rtamt, ahead of reelay, under 3 us for SESAME D7.2's examples, and
the same at 0.1 s and 60 s (the peer of these cases is ours at 0.1 s).

    python benchmarks/event.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import itertools
import json
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_scaffold.conditions.analysis import analyse  # noqa: E402
from eddi_scaffold.conditions.standalone import generate  # noqa: E402
from eddi_scaffold.program.running import Engine  # noqa: E402 - runs from the checkout

RATE = 100
PERIOD = 10**9 // RATE
COMPARED = {
    "x > 100": ("x > 100", "(x > 100)", "{x > 100}"),
    "ONCE 10 s": ("ONCE(x > 100, 10s)", "once[0:10s](x > 100)", "once[0:1000]{x > 100}"),
    "TIME 10 s": (
        "TIME(x > 50, 10s)",
        "historically[0:10s](x > 50)",
        "historically[0:1000]{x > 50}",
    ),
}
"""Case -> the condition for us, for rtamt, for reelay."""
ALONE = {
    "AVERAGE 10 s": "AVERAGE(x, 10s) > 100",
    "STDDEV 10 s": "STDDEV(x, 10s) > 100",
    "MEDIAN 10 s": "MEDIAN(x, 10s) > 100",
    "D7.2 example 1": "AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)",
    "D7.2 example 2": "MAX(temp1,10s) + MAX(temp2,10s) / 2 > AVERAGE(core,10s)",
}
FLAT = ("MAX", "AVERAGE", "STDDEV", "RATE")
LENGTHS = ("0.1s", "1s", "10s", "60s")

Run = Callable[[int], float]
"""Number of steps -> seconds of one step."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    runs, steps = (3, 2_000) if options.quick else (11, 12_000)
    rows = list(rows_of(runs, steps))
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def rows_of(runs: int, steps: int) -> Iterable[dict[str, Any]]:
    """Yield every row."""
    for case, (ours, for_rtamt, for_reelay) in COMPARED.items():
        for name, peer, text in (("rtamt", rtamt, for_rtamt), ("reelay", reelay, for_reelay)):
            try:
                its = peer(text)
            except ImportError as problem:
                yield alone(case, engine(ours), runs, steps) | {
                    "peer": name,
                    "reason": str(problem),
                }
                continue
            yield paired(case, engine(ours), name, its, runs, steps)
    for case, ours in ALONE.items():
        reason = "neither rtamt nor reelay can express it"
        yield alone(case, engine(ours), runs, steps) | {"reason": reason}
    for function, length in itertools.product(FLAT, LENGTHS[1:]):
        long, short = (engine(f"{function}(x, {one}) > 100") for one in (length, LENGTHS[0]))
        # long enough that the window is full and turns
        yield paired(f"{function} {length}", long, "ours at 0.1 s", short, runs, max(steps, 9_000))
    python = engine(ALONE["D7.2 example 2"])
    compiler = shutil.which("gcc")
    if compiler is None:
        yield alone("D7.2 example 2 in C", python, runs, steps) | {"reason": "there is no gcc"}
    else:
        with tempfile.TemporaryDirectory() as folder:
            c = c_program(ALONE["D7.2 example 2"], Path(folder), compiler)
            yield paired("D7.2 example 2 in C", c, "ours in Python", python, runs, steps)


def samples(count: int) -> list[float]:
    """Return the same rising and falling values in every run."""
    rng = random.Random(1)
    return [50.0 + 40.0 * (k // 300 % 2) + rng.uniform(-5, 5) for k in range(count)]


def engine(text: str) -> Run:
    """Return our run of an event; it goes on from call to call, so that windows stay full."""
    analysis = analyse(text, rate=RATE)
    assert analysis.program is not None, analysis.problems
    step = Engine(analysis.program).step
    kinds = [variable.type.kind for variable in analysis.variables if variable.type]
    times = itertools.count(PERIOD, PERIOD)

    def run(count: int) -> float:
        rows = [[x if kind == "number" else True for kind in kinds] for x in samples(count)]
        pairs = list(zip(rows, times, strict=False))[:count]
        start = time.process_time()
        for values, t in pairs:
            step(t, values)
        return (time.process_time() - start) / count

    run(6_500)  # fill windows of a minute
    return run


def rtamt(text: str) -> Run:
    """Return rtamt's run.

    Raises:
        ImportError: it is not installed.
    """
    import rtamt as library

    monitor = library.StlDiscreteTimeSpecification()
    monitor.declare_var("x", "float")
    monitor.set_sampling_period(PERIOD // 10**6, "ms", 0.1)
    monitor.spec = text
    monitor.parse()
    numbers = itertools.count()

    def run(count: int) -> float:
        rows = [(next(numbers), [("x", x)]) for x in samples(count)]
        start = time.process_time()
        for k, values in rows:
            monitor.update(k, values)
        return (time.process_time() - start) / count

    run(1_100)
    return run


def reelay(text: str) -> Run:
    """Return reelay's run.

    Raises:
        ImportError: it is not installed.
    """
    import reelay as library

    monitor = library.discrete_timed_monitor(pattern=text, condense=False)

    def run(count: int) -> float:
        rows: list[Mapping[str, float]] = [{"x": x} for x in samples(count)]
        start = time.process_time()
        for row in rows:
            monitor.update(row)
        return (time.process_time() - start) / count

    run(1_100)
    return run


def c_program(text: str, folder: Path, compiler: str) -> Run:
    """Return the run of the generated C, by a loop over the same samples."""
    analysis = analyse(text, rate=RATE)
    for name, source in generate(analysis, "c", "bench").items():
        (folder / name).write_text(source, "utf-8")
    arguments = ", ".join("x" for _ in analysis.variables)
    (folder / "loop.c").write_text(
        f"""#include "bench_event.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
static bench_t m;
int main(int argc, char **argv)
{{
    long k, count = argc > 1 ? atol(argv[1]) : 0;
    int64_t t = 0;
    unsigned sum = 0;
    clock_t start;
    bench_reset(&m);
    for (k = -6500; k < count; k++) {{
        double x = 50.0 + 40.0 * (double)((k + 6500) / 300 % 2) + (double)(k * 7919 % 997) / 100.0;
        if (k == 0) {{
            start = clock();
        }}
        t += {PERIOD};
        sum += (unsigned)bench_step(&m, t, {arguments});
    }}
    printf("%.9g %u\\n", (double)(clock() - start) / CLOCKS_PER_SEC, sum);
    return 0;
}}
""",
        "utf-8",
    )
    program = folder / "bench"
    flags = ["-std=c99", "-O2", "-ffp-contract=off"]
    sources = [str(folder / "bench_event.c"), str(folder / "loop.c")]
    subprocess.run([compiler, *flags, *sources, "-o", str(program), "-lm"], check=True)

    def run(count: int) -> float:
        steps = count * 100  # the clock of C is coarse
        done = subprocess.run(
            [str(program), str(steps)], capture_output=True, text=True, check=True
        )
        return float(done.stdout.split()[0]) / steps

    return run


def paired(case: str, ours: Run, peer: str, its: Run, runs: int, steps: int) -> dict[str, Any]:
    """Measure ours and the peer in turn; the ratio is the median of the pairs."""
    few = max(200, steps // 10) if peer == "rtamt" else steps
    pairs = [(ours(steps), its(few)) for _ in range(runs)]
    return {
        "case": case,
        "ours_s": statistics.median(one for one, _ in pairs),
        "peer": peer,
        "peer_s": statistics.median(other for _, other in pairs),
        "ratio": statistics.median(other / one for one, other in pairs),
    }


def alone(case: str, ours: Run, runs: int, steps: int) -> dict[str, Any]:
    """Measure ours where there is no peer."""
    ours_s = statistics.median(ours(steps) for _ in range(runs))
    return {"case": case, "ours_s": ours_s, "peer": None, "peer_s": None, "ratio": None}


def print_table(rows: list[dict[str, Any]]) -> None:
    print(f"{'case':<22} {'ours':>11} {'peer':>12} {'ratio':>8}  which peer")
    for row in rows:
        peer = f"{row['peer_s'] * 1e9:>9,.0f} ns" if row["peer_s"] else f"{'-':>12}"
        ratio = f"{row['ratio']:.2f}" if row["ratio"] else "-"
        reason = f"({row['reason']})" if row.get("reason") else ""
        ours = f"{row['ours_s'] * 1e9:>8,.0f} ns"
        print(f"{row['case']:<22} {ours} {peer} {ratio:>8}  {row['peer'] or ''} {reason}".rstrip())


if __name__ == "__main__":
    main()
