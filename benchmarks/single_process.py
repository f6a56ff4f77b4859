"""Memory and processor time of all monitors in one process, next to one process for each.

Real ROS processes on the loopback interface: 100 ConSerts at 10 Hz, numpy loaded, as by monitors
that need it. Each has two sensors of its own, which send nothing, or at 10 Hz: 2,000 messages a
second. Of separate processes a few are measured, and multiplied. Goals for one process: below 60 MB
resident, below 20 % of a core.

Then what `/why` costs: 50 monitors in one process, of which each reads the one before, in chains of
five; once as they are, once with an `eddi_messages` that has no `Why`. Somebody hears every `/why`,
as `watch` does.

    python benchmarks/single_process.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the world of real ROS processes is that of the tests

from eddi_scaffold import api  # noqa: E402
from eddi_scaffold.kinds.consert import MESSAGES  # noqa: E402
from tests.ros1.world import PYTHON, World, make_messages, until, why_no_ros  # noqa: E402

if TYPE_CHECKING:
    from tests.ros1.world import Master, Process

NUMPY = "import numpy, runpy, sys; runpy.run_path(sys.argv[1], run_name='__main__')"
SEPARATE = 4
"""Processes that are measured, of one for each monitor."""
MODEL = """---
guarantees:
- {id: Works, dimensions: [{Binary: {type: Works}}]}
- {id: Seen, dimensions: [{Binary: {type: Seen}}]}
evidence:
- {id: Sensor, dimension: {Binary: {type: Healthy}}}
- {id: Camera, dimension: {Binary: {type: Sharp}}}
gates: [{id: Both, function: And}]
tree_propagations:
- {from: Sensor, to: Both}
- {from: Camera, to: Both}
- {from: Both, to: Works}
- {from: Sensor, to: Seen}
demands: []
required_services: []
provided_services:
- {id: Service, functional_service_type: T, guarantees: [Works, Seen]}
"""
CONFIG = """
Model: {id: NAME, type: ConSert, frequency: 10, startup_grace: 1, parameters: [{model: NAME.yml}]}
SimulatorOutputs:
- {id: sensor, type: std_msgs.Bool, topic: NAME/sensor}
- {id: camera, type: std_msgs.Bool, topic: NAME/camera}
EDDIInputs:
- {id: Sensor, type: bool, requires: [sensor], max_age: 1.0}
- {id: Camera, type: bool, requires: [camera], max_age: 1.0}
EDDIOutputs: [{id: result, topic: NAME/guarantees}]
"""
SENSORS = """
import sys, rospy
from std_msgs.msg import Bool
rospy.init_node("sensors", anonymous=True)
names = ["{}/{}".format(place, of) for place in sys.argv[1:] for of in ("sensor", "camera")]
topics = [rospy.Publisher(name, Bool, queue_size=1) for name in names]
while not rospy.is_shutdown():
    for topic in topics:
        topic.publish(True)
    rospy.sleep(0.1)
"""
READS_ANOTHER = [
    (
        "{id: camera, type: std_msgs.Bool, topic: NAME/camera}",
        "{id: camera, type: eddi_messages.ConSertOutput, topic: BEFORE/guarantees}",
    ),
    ("requires: [camera],", "requires: [camera], field: 'guarantees[Works].active',"),
]
CHAIN = 5
EAR = """
import sys, time, rospy
rospy.init_node("ear", anonymous=True)
sizes = []
for topic in sys.argv[1:]:
    rospy.Subscriber(topic, rospy.AnyMsg, lambda message: sizes.append(len(message._buff)))
while not rospy.is_shutdown():
    print(sum(sizes), flush=True)
    time.sleep(0.1)
"""
Row = dict[str, object]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="10 monitors, shorter")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    reason = why_no_ros()
    count, few, seconds = (10, 10, 3.0) if options.quick else (100, 50, 15.0)
    rows: list[Row] = [{"reason": reason}] if reason else measured(count, seconds)
    rows += [] if reason else cost_of_why(few, seconds)
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
        return
    for row in rows:
        print("  ".join(f"{key} {value}" for key, value in row.items()))


def measured(count: int, seconds: float) -> list[Row]:
    names = [f"monitor_{number:03d}" for number in range(count)]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        world = World(folder, make_messages(folder / "messages", MESSAGES))
        try:
            packages = generated(folder / "workspace", names)
            one = [packages / "eddi_monitor_launcher" / "scripts" / "EDDIMonitors.py"]
            few = [packages / name / "scripts" / "RosNode.py" for name in names[:SEPARATE]]
            rows: list[Row] = []
            for said, heard in (("no sensor sends", []), ("all sensors send", names)):
                master = world.master()
                if heard:
                    world.process([PYTHON, "-c", SENSORS, *heard], world.env(master))
                for case, programs in (("one process", one), ("one process each", few)):
                    row = cost(world, master, packages, programs, names, seconds)
                    factor = 1 if programs is one else count / len(few)
                    figures = {key: round(value * factor, 1) for key, value in row.items()}
                    rows.append({"case": f"{count} monitors, {said}, {case}", **figures})
            return rows
        finally:
            world.destroy()


def cost_of_why(count: int, seconds: float) -> list[Row]:
    names = [f"monitor_{number:03d}" for number in range(count)]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        messages = {case: make_messages(folder / case, MESSAGES) for case in ("with", "without")}
        (index,) = messages["without"].glob("*/msg/__init__.py")
        lines = index.read_text().splitlines(keepends=True)
        index.write_text("".join(line for line in lines if "Why" not in line))
        world = World(folder, messages["with"])
        try:
            packages = generated(folder / "workspace", names, CHAIN)
            program = [packages / "eddi_monitor_launcher" / "scripts" / "EDDIMonitors.py"]
            rows: list[Row] = []
            for heard, sensors in (("no sensor sends", []), ("all sensors send", names)):
                percents = []
                for case, world.messages in messages.items():
                    master = world.master()
                    if sensors:
                        world.process([PYTHON, "-c", SENSORS, *sensors], world.env(master))
                    topics = [f"/{name}/guarantees/why" for name in names]
                    ear = world.process([PYTHON, "-c", EAR, *topics], world.env(master))
                    row = cost(world, master, packages, program, names, seconds, ear)
                    percents.append(row["percent"])
                    figures = {key: round(value, 1) for key, value in row.items()}
                    rows.append({"case": f"{count} monitors, {heard}, {case} /why", **figures})
                rows[-2]["ratio"] = round(percents[0] / percents[1], 2)
            return rows
        finally:
            world.destroy()


def generated(folder: Path, names: list[str], chain: int = 1) -> Path:
    """Generate all monitors into a workspace, and return the folder of the packages."""
    (folder / "src").mkdir(parents=True)
    configs = []
    for number, name in enumerate(names):
        (folder / f"{name}.yml").write_text(MODEL)
        config = CONFIG
        for old, new in READS_ANOTHER if number % chain else ():
            assert old in config
            config = config.replace(old, new.replace("BEFORE", names[number - 1]))
        configs.append(folder / f"{name}_config.yml")
        configs[-1].write_text(config.replace("NAME", name))
    api.generate(folder, None, configs, single_process=True)
    return folder / "src" / "eddi_monitor"


def cost(
    world: World,
    master: Master,
    packages: Path,
    programs: list[Path],
    names: list[str],
    seconds: float,
    ear: Process | None = None,
) -> dict[str, float]:
    """Return memory in MB and share of a core in percent of some processes together.

    And how many bytes a second come to an ear.
    """
    env = world.env(master)
    env["PYTHONPATH"] += os.pathsep + os.pathsep.join(str(packages / n / "src") for n in names)
    command = [PYTHON, "-c", NUMPY]
    started = [world.process([*command, str(program)], env) for program in programs]
    last = names[-1] if len(started) == 1 else names[len(started) - 1]
    try:
        until(lambda: registered(master, f"/{last}/guarantees"), 120.0, started[-1].text)
        time.sleep(3.0)
        before, begin = sum(map(ticks, started)), time.monotonic()
        bytes_before = int(ear.text.split()[-1]) if ear else 0
        time.sleep(seconds)
        used = (sum(map(ticks, started)) - before) / os.sysconf("SC_CLK_TCK")
        percent = 100.0 * used / (time.monotonic() - begin)
        figures = {"MB": sum(map(resident, started)), "percent": percent}
        if ear:
            figures["bytes/s"] = (int(ear.text.split()[-1]) - bytes_before) / seconds
        return figures
    finally:
        for process in started:
            process.destroy()


def registered(master: Master, topic: str) -> bool:
    state = master.call("getSystemState")
    return state is not None and topic in dict(state[0])


def ticks(process: Process) -> int:
    fields = Path(f"/proc/{process.popen.pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def resident(process: Process) -> float:
    status = Path(f"/proc/{process.popen.pid}/status").read_text()
    (line,) = (one for one in status.splitlines() if one.startswith("VmRSS:"))
    return int(line.split()[1]) / 1024


if __name__ == "__main__":
    main()
