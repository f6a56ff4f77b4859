"""ROS as a person uses it: roscore, roslaunch, rostopic pub and echo, each a real process."""

import contextlib
import os
import re
import signal
import subprocess
import xmlrpc.client
from pathlib import Path

import yaml

from tests.ros1.world import Process, free_port, until

CLEAN_PATH = "/usr/sbin:/usr/bin:/sbin:/bin"
COLOURS = re.compile(r"\x1b\[[0-9;]*m|\x1b\][^\x07]*\x07")
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
STARTED = re.compile(r"process\[(\S+)-\d+\]: started with pid \[(\d+)\]")


def clean_env(home):
    """Return the environment of a person at a freshly opened terminal, with a home of its own."""
    return {"PATH": CLEAN_PATH, "HOME": str(home), "LANG": "C.UTF-8", "PYTHONUNBUFFERED": "1"}


def sourced(setup, home):
    """Return the environment after ``source setup.bash``."""
    done = subprocess.run(
        ["/bin/bash", "-c", '. "$0" && env -0', str(setup)],
        env=clean_env(home),
        check=True,
        capture_output=True,
        text=True,
    )
    return dict(line.split("=", 1) for line in done.stdout.split("\0") if "=" in line)


class Roscore:
    """A real roscore on a free port, with logs of its own."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.folder.mkdir()
        self.process = None

    def start(self):
        for attempt in (1, 2):  # another program may take the free port first
            self._start(free_port())
            with contextlib.suppress(AssertionError):
                until(self._ready, 30.0, "roscore")
                return self
            self.stop()
            assert attempt == 1, self.process.text
        return self

    def _start(self, port):
        self.ros_env = {
            "ROS_MASTER_URI": f"http://localhost:{port}",
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(self.folder),
            "ROS_LOG_DIR": str(self.folder / "log"),
        }
        env = {**clean_env(self.folder), **self.ros_env}
        self.process = Process(["roscore", "-p", str(port)], env, self.folder / "roscore.log")

    def _ready(self):
        assert self.process.popen.poll() is None, self.process.text
        return "/rosout" in self.nodes()

    def nodes(self):
        """Return the names of all nodes that the master knows."""
        with contextlib.suppress(OSError):
            with xmlrpc.client.ServerProxy(self.ros_env["ROS_MASTER_URI"]) as master:
                _, _, system = master.getSystemState("/test")
            return {name for kind in system for _, names in kind for name in names}
        return set()

    def stop(self):
        end(self.process)


class Run:
    """``roslaunch eddi_monitor_launcher eddi.launch`` in a sourced workspace, and who listens."""

    TOPICS = ("/conserta/guarantees", "/consertb/guarantees", "/diagnostics")
    LAUNCH = ("eddi.launch",)

    def __init__(self, core, env, folder):
        self.core = core
        self.env = {**env, **core.ros_env}  # after sourcing: setup.bash keeps an old master
        self.folder = Path(folder)
        self.folder.mkdir()
        self.processes = []
        self.echoes = {}
        self.read = {}  # topic -> messages: what is asked for again and again is parsed once
        self.launch = None

    def __enter__(self):
        try:
            for topic in self.TOPICS:  # before the monitors, to hear their first word
                self.echoes[topic] = self._start("rostopic", "echo", topic)
            self.launch = self._start("roslaunch", "eddi_monitor_launcher", *self.LAUNCH)
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_):
        self.end()

    def _start(self, *command):
        log = self.folder / f"{len(self.processes)}.log"
        process = Process(command, self.env, log)
        self.processes.append(process)
        return process

    def command(self, *command):
        """Run a command of ROS to its end and return its output."""
        return subprocess.run(
            command, env=self.env, check=True, capture_output=True, text=True
        ).stdout

    def publish(self, topic):
        """Let ``rostopic pub`` send a true value ten times a second; return the process."""
        return self._start("rostopic", "pub", "-r", "10", topic, "std_msgs/Bool", "data: true")

    def messages(self, topic):
        """Return the complete messages that ``rostopic echo`` has printed so far."""
        text = self.echoes[topic].text
        whole = "".join(line for line in text.splitlines(True) if not line.startswith("WARNING"))
        read, parts = self.read.setdefault(topic, []), whole.split("---\n")[:-1]
        read += [yaml.load(part, _LOADER) for part in parts[len(read) :]]
        return list(read)

    def states(self, topic):
        """Return guarantee id -> active for each message of a topic."""
        return [
            {item["id"]: item["active"] for item in message["guarantees"]}
            for message in self.messages(topic)
        ]

    def wait_for(self, topic, state, patience):
        """Wait until a topic says exactly this."""
        try:
            until(lambda: self._came(topic, state), patience, f"{topic}: {state}")
        except AssertionError as late:
            last = self.states(topic)[-1:]
            raise AssertionError(f"{late}; last: {last}\n{self.launch_text()}") from None

    def _came(self, topic, state):
        assert self.launch.popen.poll() is None, self.launch_text()
        return state in self.states(topic)[-1:]

    def diagnosis(self, node):
        """Return the newest key and value pairs of a node on ``/diagnostics``."""
        for array in reversed(self.messages("/diagnostics")):
            for status in array["status"]:
                if status["hardware_id"] == node:
                    return {pair["key"]: pair["value"] for pair in status["values"]}
        return {}

    def wait_for_input(self, node, name, patience):
        """Wait until a node says that an input has come."""
        came = ("ok", "latched")
        until(lambda: self.diagnosis(node).get(name) in came, patience, f"{node} {name}")

    def launch_text(self):
        """Return what roslaunch and the nodes have printed."""
        return COLOURS.sub("", self.launch.text)

    def end(self):
        """End every process as with Ctrl-C, roslaunch first; nothing may be left."""
        launched = [self.launch] if self.launch else []
        for process in [*launched, *self.processes]:
            end(process)
        nodes = STARTED.findall(self.launch_text()) if self.launch else []
        left = [(name, int(pid)) for name, pid in nodes if _is_alive(int(pid))]
        for _, pid in left:
            os.kill(pid, signal.SIGKILL)
        assert not left, left


def end(process):
    """Press Ctrl-C; roslaunch and roscore need seconds to end their own children."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.end(timeout=30.0)
    process.destroy()


def _is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
