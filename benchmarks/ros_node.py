"""Time from evidence to guarantee between two processes: our node and plain ones.

On ROS 1, on DDS, and on rclpy where that is present.

Ours evaluates a ConSert, checks ages and values and reports on ``/diagnostics``. The peers do not:
at a rate the node of SESAME D7.2 Fig 31, for ``on_change`` a node that answers in its callback,
which is as fast as the transport gets. Both run at once and are asked in turn. Goals on an idle
machine: ``on_change`` p50 below 1 ms and p95 below 5 ms.

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
from tests.contract.stages import (  # noqa: E402
    CONFIG,
    DdsStage,
    Ros2Stage,
    environment,
    why_no_dds,
    why_no_rclpy,
)
from tests.ros1 import models  # noqa: E402
from tests.ros1.world import PYTHON, Process, World, make_messages, why_no_ros  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterable

    from tests.ros1.world import Master

PROGRAMS = ROOT / "benchmarks" / "ros_node_programs.py"
DDS_PROGRAMS = PROGRAMS.with_name("dds_node_programs.py")
CASES: dict[str, tuple[dict[str, str], list[str], list[str], float]] = {
    "rate 10 Hz": ({}, ["_frequency:=10"], ["rate", "10"], 0.1),
    "rate 100 Hz": ({}, ["_frequency:=100"], ["rate", "100"], 0.02),
    "on_change": ({"TESTER_MODE": "on_change"}, ["_frequency:=10"], ["callback"], 0.02),
}
"""Case -> environment and arguments of our node, arguments of the peer, longest pause in s."""
DDS_CASE, ROS2_CASE = "DDS, on_change", "rclpy, on_change"

Row = dict[str, object]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer toggles, one run")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = [row for world in (ros1, dds, ros2) for row in world(options.quick)]
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def unavailable(cases: Iterable[str], reason: str) -> list[Row]:
    """Return one row per case with the reason why nothing was measured."""
    empty = {"ours_s": None, "peer": None, "peer_s": None, "ratio": None, "reason": reason}
    return [{"case": case, **empty} for case in cases]


def dds(quick: bool) -> list[Row]:
    """Measure the node on DDS, and a plain one."""
    reason = why_no_dds()
    if reason:
        return unavailable([DDS_CASE], reason)
    peer = [sys.executable, str(DDS_PROGRAMS), "callback"]
    return on_graph(DDS_CASE, DdsStage, peer, quick)


def ros2(quick: bool) -> list[Row]:
    """Measure the node on rclpy, and a plain one; who asks both speaks DDS by itself."""
    reason = why_no_rclpy() or why_no_dds()
    if reason:
        return unavailable([ROS2_CASE], reason)
    peer = [PYTHON, str(PROGRAMS.with_name("ros2_node_programs.py"))]
    return on_graph(ROS2_CASE, Ros2Stage, peer, quick)


def on_graph(
    case: str, make: type[DdsStage | Ros2Stage], peer: list[str], quick: bool
) -> list[Row]:
    """Measure two nodes of a ROS 2 graph."""
    with tempfile.TemporaryDirectory() as folder:
        config = Path(folder) / "config.yml"
        on_change = CONFIG.read_text("utf-8").replace("frequency: 20", "mode: on_change")
        config.write_text(on_change, "utf-8")
        stage = make(Path(folder), config)
        asking = [sys.executable, str(DDS_PROGRAMS), "measure", "20" if quick else "300"]
        try:
            stage.start("/ours")
            stage.process(peer, stage.env())
            done = subprocess.run(
                [*asking, "0.02", "ours", "peer"],
                env=environment(stage.domain, folder),
                capture_output=True,
                text=True,
                check=True,
            )
        finally:
            stage.destroy()
    return rows_of(case, [json.loads(done.stdout.splitlines()[-1])])


def ros1(quick: bool) -> list[Row]:
    reason = why_no_ros()
    if reason:
        return unavailable(CASES, reason)
    toggles, runs = (20, 1) if quick else (100, 3)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        world = World(folder, make_messages(Path(folder) / "messages", MESSAGES))
        model = Path(folder) / "tester.py"
        model.write_text(models.compiled(models.tester(30.0)))
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
        world.node(master, "tester", f"compiled:={model}", "__ns:=/ours", *arguments, env=env),
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
    peer = "D7.2 node, rospy.Rate" if case.startswith("rate") else "answer at once"
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
