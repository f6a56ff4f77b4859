"""Time from evidence to guarantee between two processes: our node and plain ones.

On ROS 1, on DDS, and on rclpy where that is present.

Ours evaluates a ConSert, checks ages and values and reports on ``/diagnostics``. The peers do not:
at a rate the node of SESAME D7.2 Fig 31, for ``on_change`` a node that answers in its callback,
which is as fast as the transport gets. Both run at once and are asked in turn. Goals on an idle
machine: ``on_change`` p50 below 1 ms and p95 below 5 ms.

With 50 monitors (10 on DDS), each a process, first all of ours run and are asked one after the
other, then as many peers. Ours step and report once a second besides, so that two cores are not
full of that.

    python benchmarks/ros_node.py [--quick] [--json] [--on ros2]
"""

from __future__ import annotations

import argparse
import json
import signal
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the world of real ROS processes is that of the tests

from eddi_scaffold.kinds.consert import MESSAGES  # noqa: E402
from tests.contract.stages import (  # noqa: E402
    CONFIG,
    LOOPBACK,
    DdsStage,
    Ros2Stage,
    environment,
    why_no_dds,
)
from tests.ros1.conftest import tester  # noqa: E402
from tests.ros1.world import PYTHON, Process, World, make_messages, why_no_ros  # noqa: E402
from tests.ros2.world import RELEASE  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from tests.ros1.world import Master

Row = dict[str, object]
Seconds = dict[str, list[float]]

PROGRAMS = ROOT / "benchmarks" / "ros_node_programs.py"
DDS_PROGRAMS = PROGRAMS.with_name("dds_node_programs.py")
ON_CHANGE = {"TESTER_MODE": "on_change"}
CASES: dict[str, tuple[dict[str, str], list[str], list[str], float]] = {
    "ROS 1, rate 10 Hz": ({}, ["_frequency:=10"], ["rate", "10"], 0.1),
    "ROS 1, rate 100 Hz": ({}, ["_frequency:=100"], ["rate", "100"], 0.02),
    "ROS 1, on_change": (ON_CHANGE, ["_frequency:=10"], ["callback"], 0.02),
}
"""Case -> environment and arguments of our node, arguments of the peer, longest pause in s."""
OURS, PEER = "ours", "peer"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer toggles, 5 monitors, one run")
    parser.add_argument("--json", action="store_true")
    worlds = {world.__name__: world for world in (ros1, dds, ros2)}
    parser.add_argument("--on", choices=worlds, action="append", help="all, unless it is given")
    options = parser.parse_args()
    rows = [row for name in options.on or worlds for row in worlds[name](options.quick)]
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def unavailable(cases: Iterable[str], reason: str) -> list[Row]:
    """Return one row per case with the reason why nothing was measured."""
    empty = {"ours_s": None, "peer": None, "peer_s": None, "ratio": None, "reason": reason}
    return [{"case": case, **empty} for case in cases]


class Bench(NamedTuple):
    """A graph with nodes that are asked.

    Attributes:
        start: starts a node of a kind (``ours``, ``peer``) with a namespace.
        ask: command that toggles evidence and measures.
        env: of that command.
    """

    start: Callable[[str, str], Process]
    ask: list[str]
    env: Mapping[str, str]

    def together(self, toggles: int, pause: float) -> Seconds:
        """Return the latencies of one node of each kind, which run at once."""
        return self._measured({OURS: [OURS], PEER: [PEER]}, toggles, pause)

    def crowds(self, count: int, toggles: int, pause: float) -> Seconds:
        """Return the latencies of many nodes of each kind, one kind after the other."""
        found: Seconds = {}
        for kind in (OURS, PEER):
            found |= self._measured({kind: [f"{kind}{k}" for k in range(count)]}, toggles, pause)
        return found

    def _measured(self, names: Mapping[str, list[str]], toggles: int, pause: float) -> Seconds:
        started = [self.start(kind, name) for kind in names for name in names[kind]]
        every = [name for kind in names for name in names[kind]]
        try:
            done = subprocess.run(
                [*self.ask, str(toggles), str(pause), *every],
                env=self.env,
                stdout=subprocess.PIPE,
                text=True,
                check=True,
            )
        finally:
            for process in started:
                process.send(signal.SIGINT)
            for process in started:
                process.destroy()
        seconds: Seconds = json.loads(done.stdout.splitlines()[-1])
        return {kind: [one for name in names[kind] for one in seconds[name]] for kind in names}


def dds(quick: bool) -> list[Row]:
    """Measure nodes on DDS, and plain ones."""
    peer = [sys.executable, str(DDS_PROGRAMS), "callback"]
    return on_graph("DDS", DdsStage, why_no_dds(), peer, quick)


def ros2(quick: bool) -> list[Row]:
    """Measure nodes on rclpy, and plain ones; who asks both speaks DDS by itself."""
    peer = [RELEASE.python, str(PROGRAMS.with_name("ros2_node_programs.py"))]
    return on_graph("rclpy", Ros2Stage, RELEASE.why_not() or why_no_dds(), peer, quick)


def on_graph(
    on: str,
    make: type[DdsStage | Ros2Stage],
    reason: str | None,
    peer: list[str],
    quick: bool,
) -> list[Row]:
    """Measure nodes of a ROS 2 graph."""
    count, toggles = (5, 20) if quick else (10, 300)  # each of them has to find each other
    alone, crowd = f"{on}, on_change", f"{on}, {count} monitors"
    if reason:
        return unavailable([alone, crowd], reason)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        config, network = folder / "config.yml", folder / "loopback.xml"
        on_change = CONFIG.read_text("utf-8").replace("frequency: 20", "mode: on_change")
        config.write_text(on_change, "utf-8")
        text = LOOPBACK.read_text("utf-8").replace(">30<", ">99<")  # as many processes
        network.write_text(text.replace("<LeaseDuration>2s</LeaseDuration>", ""), "utf-8")
        (folder / "stage").mkdir()
        stage = make(folder / "stage", config)
        more = {"CYCLONEDDS_URI": network.as_uri()}

        def start(kind: str, name: str) -> Process:
            rate = "frequency:=1.0" if name != kind else "frequency:=10.0"
            command = stage.command(f"/{name}", rate) if kind == OURS else [*peer, name]
            return stage.process(command, {**stage.env(), **more})

        asking = [sys.executable, str(DDS_PROGRAMS), "measure"]
        bench = Bench(start, asking, {**environment(stage.domain, place), **more})
        try:
            return [
                *rows_of(alone, [bench.together(toggles, 0.02)]),
                *rows_of(crowd, [bench.crowds(count, 10, 0.02)]),
            ]
        finally:
            stage.destroy()


def ros1(quick: bool) -> list[Row]:
    """Measure nodes on ROS 1, and plain ones."""
    reason, count = why_no_ros(), 5 if quick else 50
    crowd = f"ROS 1, {count} monitors"
    if reason:
        return unavailable([*CASES, crowd], reason)
    toggles, runs = (20, 1) if quick else (100, 3)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        world = World(folder, make_messages(Path(folder) / "messages", MESSAGES))
        model = Path(folder) / "tester.py"
        model.write_text(tester(30.0).text())
        try:
            master = world.master()
            for case, (env, words, peer, pause) in CASES.items():
                bench = on_master(world, master, [f"compiled:={model}", *words], env, peer)
                rows += rows_of(case, [bench.together(toggles, pause) for _ in range(runs)])
            words = [f"compiled:={model}", "_frequency:=1"]
            bench = on_master(world, master, words, ON_CHANGE, ["callback"])
            rows += rows_of(crowd, [bench.crowds(count, 10, 0.02)])
        finally:
            world.destroy()
    return rows


def on_master(
    world: World, master: Master, words: list[str], env: dict[str, str], peer: list[str]
) -> Bench:
    """Return what measures nodes of ROS 1.

    Args:
        world: where they run.
        master: of them.
        words: arguments of our node.
        env: of our node, besides the usual.
        peer: arguments of the program of the peer.
    """

    def start(kind: str, name: str) -> Process:
        place = f"__ns:=/{name}"
        if kind == OURS:
            return world.node(master, "tester", place, *words, env=env)
        return world.process([PYTHON, str(PROGRAMS), *peer, place], world.env(master))

    return Bench(start, [PYTHON, str(PROGRAMS), "measure"], world.env(master))


def rows_of(case: str, pairs: list[Seconds]) -> list[Row]:
    """Return the median over the runs of p50, p95 and the worst."""
    peer = "D7.2 node, rospy.Rate" if ", rate" in case else "answer at once"
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
    print(f"{'case':<26}{'ours':>12}  {'peer':<24}{'peer':>12}{'ratio':>8}")
    for row in rows:
        if row["ours_s"] is None:
            print(f"{row['case']:<26}not measured: {row['reason']}")
            continue
        print(
            f"{row['case']:<26}{milliseconds(row['ours_s'])}  {row['peer']:<24}"
            f"{milliseconds(row['peer_s'])}{row['ratio']:>8.2f}"
        )


def milliseconds(seconds: object) -> str:
    return f"{float(str(seconds)) * 1e3:9.2f} ms"


if __name__ == "__main__":
    main()
