"""Time from evidence to guarantee between two ROS processes: our node and plain rospy nodes.

Ours evaluates a ConSert, checks ages and values and reports on ``/diagnostics``. The peers do not:
at a rate the node of SESAME D7.2 Fig 31, for ``on_change`` a node that answers in its callback,
which is as fast as rospy gets. Both run at once and are asked in turn. Goals on an idle machine:
``on_change`` p50 below 1 ms and p95 below 5 ms.

    python benchmarks/ros_node.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the world of real ROS processes is that of the tests

from eddi_scaffold.kinds.consert.messages import MESSAGES  # noqa: E402
from tests.ros1 import models  # noqa: E402
from tests.ros1.world import PYTHON, Process, World, make_messages, why_no_ros  # noqa: E402

if TYPE_CHECKING:
    from tests.ros1.world import Master

PROGRAMS = ROOT / "benchmarks" / "ros_node_programs.py"
CASES: dict[str, tuple[dict[str, str], list[str], list[str], float]] = {
    "rate 10 Hz": ({}, ["_frequency:=10"], ["rate", "10"], 0.1),
    "rate 100 Hz": ({}, ["_frequency:=100"], ["rate", "100"], 0.02),
    "on_change": ({"TESTER_MODE": "on_change"}, ["_frequency:=10"], ["callback"], 0.02),
}
"""Case -> environment and arguments of our node, arguments of the peer, longest pause in s."""

Row = dict[str, object]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer toggles, one run")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    reason = why_no_ros()
    rows = unavailable(reason) if reason else measured(options.quick)
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def unavailable(reason: str) -> list[Row]:
    """Return one row per case with the reason why nothing was measured."""
    empty = {"ours_s": None, "peer": None, "peer_s": None, "ratio": None, "reason": reason}
    return [{"case": case, **empty} for case in CASES]


def measured(quick: bool) -> list[Row]:
    toggles, runs = (20, 1) if quick else (100, 3)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        world = World(folder, make_messages(Path(folder) / "messages", MESSAGES))
        model = Path(folder) / "model.json"
        model.write_text(models.finished(models.tester(30.0)))
        try:
            master = world.master()
            for case in CASES:
                pairs = [one_run(world, master, model, case, toggles) for _ in range(runs)]
                rows.extend(rows_of(case, pairs))
        finally:
            world.destroy()
    return rows


def one_run(
    world: World, master: Master, model: Path, case: str, toggles: int
) -> dict[str, list[float]]:
    """Return the latencies of our node and of the peer, in seconds."""
    env, arguments, peer, pause = CASES[case]
    started: list[Process] = [
        world.node(master, "tester", f"_model:={model}", "__ns:=/ours", *arguments, env=env),
        world.process([PYTHON, str(PROGRAMS), *peer, "__ns:=/peer"], world.env(master)),
    ]
    try:
        done = subprocess.run(
            [PYTHON, str(PROGRAMS), "measure", str(toggles), str(pause), "ours", "peer"],
            env=world.env(master),
            capture_output=True,
            text=True,
            check=True,
        )
    finally:
        for process in started:
            process.destroy()
    seconds: dict[str, list[float]] = json.loads(done.stdout.splitlines()[-1])
    return seconds


def rows_of(case: str, pairs: list[dict[str, list[float]]]) -> list[Row]:
    """Return the median over the runs of p50, p95 and the worst."""
    peer = "answer in the callback" if case == "on_change" else "D7.2 node, rospy.Rate"
    rows: list[Row] = []
    for name, share in (("p50", 0.5), ("p95", 0.95), ("worst", 1.0)):
        ours, theirs = ([quantile(pair[who], share) for pair in pairs] for who in ("ours", "peer"))
        ratio = statistics.median(b / a for a, b in zip(ours, theirs, strict=True))
        rows.append(
            {
                "case": f"{case} {name}",
                "ours_s": statistics.median(ours),
                "peer": peer,
                "peer_s": statistics.median(theirs),
                "ratio": ratio,
            }
        )
    return rows


def quantile(seconds: list[float], share: float) -> float:
    """Return the value that a share of all values does not exceed."""
    ordered = sorted(seconds)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def print_table(rows: list[Row]) -> None:
    print(f"{'case':<20}{'ours':>12}  {'peer':<24}{'peer':>12}{'ratio':>8}")
    for row in rows:
        if row["ours_s"] is None:
            print(f"{row['case']:<20}not measured: {row['reason']}")
            continue
        print(
            f"{row['case']:<20}{milliseconds(row['ours_s'])}  {row['peer']:<24}"
            f"{milliseconds(row['peer_s'])}{row['ratio']:>8.2f}"
        )


def milliseconds(seconds: object) -> str:
    return f"{float(str(seconds)) * 1e3:9.2f} ms"


if __name__ == "__main__":
    main()
