"""A graph with the same monitor on it, once for each transport: real nodes, real middleware."""

import contextlib
import os
import shutil
import socket
import sys
from pathlib import Path

from eddi_scaffold.kinds.consert import MESSAGES
from tests.cli.command import run
from tests.ros1.world import (
    PROBES,
    PYTHON,
    RUNTIME,
    World,
    active,
    make_messages,
    until,
    why_no_ros,
)
from tests.ros2.world import RELEASE

HERE = Path(__file__).parent
CONFIG = HERE / "rover_config.yml"
LOOPBACK = HERE / "loopback.xml"
FAULT = "        if mode.data == 'raise':\n            raise ValueError('on purpose')\n"
SLOW_START = """
        import os, time
        if os.environ.get('SLOW_START'):
            print('begun', flush=True)
            time.sleep(float(os.environ['SLOW_START']))
"""
NAMES = ("/rover", "/robot1/rover")


class Stage(World):
    """What each test runs on."""

    core = None

    def begin(self):
        """Start what all tests use together."""
        self.ear, self.source = self.new_probe(), self.new_probe()
        self.ear.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        for name in NAMES:
            self.ear.subscribe(f"{name}/guarantees")

    def feed(self, source, topic, kind, values, *, hz=10, **more):
        """Have a probe publish a value again and again, until ``stop``."""
        source.do("every", topic=topic, kind=kind, fields={"data": values}, hz=hz, **more)

    def verdicts(self, after, name="/rover"):
        """Return the sets of active guarantees in their order, each change once, as a text.

        Before, none was active.
        """
        found = ["none"]
        for event in self.ear.outputs(f"{name}/guarantees", after):
            said = "+".join(sorted(active(event))) or "none"
            if found[-1:] != [said]:
                found.append(said)
        return " ".join(found)

    def until(self, *guarantees, name="/rover", after=None, timeout=10.0):
        """Wait until exactly these guarantees are active."""
        self.ear.active(f"{name}/guarantees", set(guarantees), timeout, after)

    def told(self, words, name="/rover", after=None, timeout=10.0):
        """Wait until the diagnostics of a node have some words; return (message, values)."""
        _, message, values = self.ear.diagnostics(
            name, lambda level, text, values: words in text, timeout, after
        )
        return message, values

    def start(self, namespace="/", *parameters):
        """Start a node."""
        return self.process(self.command(namespace, *parameters), self.env(self.core))

    def start_simulated(self, namespace):
        """Start a node whose steps are at the time of /clock."""
        return self.start(namespace, "use_sim_time:=true")

    def clock(self, seconds):
        """Let it be so late."""
        fields = {"clock": {"sec": int(seconds), "nanosec": int(seconds % 1 * 1e9)}}
        self.source.publish("/clock", "rosgraph_msgs/Clock", fields)


class Ros1Stage(Stage):
    """ROS 1: a master of its own."""

    def __init__(self, folder):
        super().__init__(folder, make_messages(folder / "messages", MESSAGES))
        (folder / "src").mkdir()
        self.package = generated(folder, "src/eddi_monitor/rover", "-w", folder, code="src/rover")
        self.core = self.master()

    def env(self, master, messages=None):
        given = super().env(master, messages)
        return {**given, "PYTHONPATH": f"{self.package / 'src'}:{given['PYTHONPATH']}"}

    def new_probe(self):
        return self.probe(self.core)

    def start_simulated(self, namespace):
        """Start a node whose steps are at the time of /clock."""
        self.core.call("setParam", "/use_sim_time", True)
        node = self.start(namespace)
        until(lambda: "monitor of" in node.text, what="the first line of the log")
        self.core.call("setParam", "/use_sim_time", False)
        return node

    def clock(self, seconds):
        """Let it be so late."""
        fields = {"clock": {"secs": int(seconds), "nsecs": int(seconds % 1 * 1e9)}}
        self.source.publish("/clock", "rosgraph_msgs/Clock", fields)

    def command(self, namespace, *parameters):
        given = ("watchdog_period:=0.5", *parameters)  # how soon it is told what the master knows
        words = [f"__ns:={namespace}", *(f"_{one}" for one in given)]
        return [PYTHON, str(self.package / "scripts/RosNode.py"), *words]


class DdsStage(Stage):
    """DDS on loopback, without multicast."""

    def __init__(self, folder, config=CONFIG):
        super().__init__(folder, None)
        place = ("--platform", "dds", "-o", folder)
        self.package = generated(folder, "rover", *place, code=".", config=config)
        shutil.rmtree(folder / "eddi_runtime")
        (folder / "eddi_runtime").symlink_to(RUNTIME / "eddi_runtime")
        self.lock, self.domain = free_domain()

    def env(self, master=None, messages=None):
        return environment(self.domain, self.folder)

    def new_probe(self):
        command = [sys.executable, str(PROBES / "dds.py")]
        return self.probe_of(command, self.env())

    def command(self, namespace, *parameters):
        return [sys.executable, "-m", "rover", *ros_args(namespace, parameters)]

    def destroy(self):
        super().destroy()
        self.lock.close()


class Ros2Stage(Stage):
    """ROS 2 on loopback, with the messages of a workspace that its colcon has built."""

    def __init__(self, folder, config=CONFIG, below=None):
        super().__init__(folder, None)
        (folder / "src").mkdir()
        place = ("--platform", "ros2", "-w", folder)
        self.package = generated(
            folder, "src/eddi_monitor/rover", *place, code="rover", config=config
        )
        around = RELEASE.workspace(below or folder.with_name("below"))
        self.lock, self.domain = free_domain()
        paths = [str(self.package), str(RUNTIME), around.get("PYTHONPATH", "")]
        own = {"PYTHONPATH": os.pathsep.join(paths), **on_loopback(self.domain)}
        self.environment = {**around, **own}

    def env(self, master=None, messages=None):
        return self.environment

    def new_probe(self):
        return self.probe_of([RELEASE.python, str(PROBES / "ros2.py")], self.environment)

    def command(self, namespace, *parameters):
        return [RELEASE.python, "-m", "rover.RosNode", *ros_args(namespace, parameters)]

    def destroy(self):
        super().destroy()
        self.lock.close()


def on_loopback(domain):
    """Return the environment in which a node of ROS 2 stays on this machine, on any DDS.

    Whoever dies without a word is missed after 2 s, and not after 10 (Cyclone) or 20 (Fast DDS).
    """
    return {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",  # that is: these files say it
        "CYCLONEDDS_URI": LOOPBACK.as_uri(),
        "FASTDDS_DEFAULT_PROFILES_FILE": str(HERE / "fastdds.xml"),
        "PYTHONUNBUFFERED": "1",
    }


def ros_args(namespace, parameters):
    """Return what a node of ROS 2 is given."""
    given = [word for one in parameters for word in ("-p", one)]
    return ["--ros-args", "-r", f"__ns:={namespace}", *given]


def generated(folder, package, *place, code, config=CONFIG):
    """Return the package of the monitor, with a line that somebody wrote."""
    done = run("generate", *place, "-m", HERE / "rover.yml", "-c", config, cwd=folder)
    assert done.status == 0, done.err
    made = folder / package
    module = made / code / "EDDIInput.py"
    text = module.read_text("utf-8")
    for line, where in (
        ("        self.Mode = mode.data\n", FAULT + "{}"),
        ("        self.Healthy = None\n", "{}" + SLOW_START),
    ):
        assert text.count(line) == 1
        text = text.replace(line, where.format(line))
    module.write_text(text, "utf-8")
    return made


def environment(domain, *folders):
    """Return that of a process on loopback which may import what is in the folders."""
    return {
        **os.environ,
        "PYTHONPATH": ":".join(map(str, (*folders, RUNTIME))),
        "PYTHONUNBUFFERED": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        "ROS_DOMAIN_ID": str(domain),
        "CYCLONEDDS_URI": LOOPBACK.as_uri(),
    }


def free_domain():
    """Return a domain that no other test of this machine uses, and what keeps it."""
    for domain in range(1, 100):
        lock = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError):
            lock.bind(f"\0eddi-dds-{domain}")
            return lock, domain
        lock.close()
    raise AssertionError("no free domain")


def why_no_dds():
    """Return why DDS cannot be used here, ``None`` when it can."""
    try:
        import cyclonedds.domain  # noqa: F401
    except ImportError as error:
        return f"no DDS here: {error}"
    return None


STAGES = {
    "ros1": (Ros1Stage, why_no_ros),
    "dds": (DdsStage, why_no_dds),
    "ros2": (Ros2Stage, RELEASE.why_not),
}
