"""A small real ROS world: masters, nodes and probes, each a process that a test can stop."""

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import xmlrpc.client
from pathlib import Path

import pytest

from eddi_scaffold.kinds import COMMON

HERE = Path(__file__).parent
PYTHON = "/usr/bin/python3"
PROBES = HERE.parent / "probes"
RUNTIME = HERE.parents[1] / "runtime_lib" / "src"
PACKAGES = {
    "tester": HERE / "tester",
    "conserta": HERE.parents[1] / "examples/two-conserts/expected/src/eddi_monitor/conserta",
}


def why_no_ros():
    """Return why ROS 1 cannot be used here, ``None`` when it can."""
    needed = "import rospy, rosmaster, genpy, std_msgs.msg, diagnostic_msgs.msg"
    clean = {"PATH": "/usr/bin:/bin"}
    try:
        tried = subprocess.run(
            [PYTHON, "-c", needed], env=clean, capture_output=True, text=True, check=False
        )
    except OSError as error:
        return f"no ROS 1 here: {error}"
    if tried.returncode == 0:
        return None
    return f"{PYTHON} has no ROS 1: {tried.stderr.strip().splitlines()[-1]}"


def demand(reason):
    """Skip a test for a reason, if there is one; fail where what it needs must be there."""
    if reason and os.environ.get("EDDI_REQUIRE_ROS") == "1":
        pytest.fail(reason)
    if reason:
        pytest.skip(reason)


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def until(condition, timeout=10.0, what="the condition"):
    """Return the first true value of a function."""
    end = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"not within {timeout} s: {what}")
        time.sleep(0.02)


class Process:
    """A child with its own stderr and stdout files; ended by pid, never by name."""

    def __init__(self, command, env, log, **more):
        self.log = Path(log)
        with self.log.open("w") as out:
            self.popen = subprocess.Popen(command, env=env, stdout=out, stderr=out, **more)

    @property
    def text(self):
        return self.log.read_text(errors="replace")

    def send(self, number):
        self.popen.send_signal(number)

    def wait(self, timeout=10.0):
        return self.popen.wait(timeout)

    def end(self, number=signal.SIGINT, timeout=10.0):
        """Ask the process to end and return (status, seconds)."""
        started = time.monotonic()
        if self.popen.poll() is None:
            self.send(number)
        status = self.popen.wait(timeout)
        return status, time.monotonic() - started

    def destroy(self):
        """Leave nothing behind, whatever state the process is in."""
        if self.popen.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                self.send(signal.SIGCONT)
                self.send(signal.SIGINT)
            try:
                self.popen.wait(3.0)
            except subprocess.TimeoutExpired:
                self.popen.kill()
                self.popen.wait()


class Master:
    """A real rosmaster on a free port."""

    def __init__(self, world, port=None):
        self.world = world
        self.port = port or free_port()
        self.uri = f"http://localhost:{self.port}"
        self.process = None

    def start(self):
        self.process = self.world.process(
            [PYTHON, "/usr/bin/rosmaster", "--core", "-p", str(self.port)], self.world.env(self)
        )
        until(lambda: self.call("getPid"), what=f"rosmaster: {self.process.text}")
        return self

    def call(self, method, *arguments):
        """Return the value of a call, ``None`` without an answer or with a refusal."""
        try:
            with xmlrpc.client.ServerProxy(self.uri) as proxy:
                status, _, value = getattr(proxy, method)("/test", *arguments)
        except OSError:
            return None
        return value if status == 1 else None


class Probe:
    """A process on the graph that the test steers; see `tests/probes`."""

    def __init__(self, command, env, log):
        self._events = []
        self._more = threading.Condition()
        with log.open("w") as errors:
            self.popen = subprocess.Popen(
                command,
                env=env,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                bufsize=1,
            )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.wait(lambda event: event["event"] == "ready")

    def _read(self):
        for line in self.popen.stdout:
            with contextlib.suppress(ValueError):
                event = json.loads(line)
                with self._more:
                    self._events.append(event)
                    self._more.notify_all()

    def do(self, what, **arguments):
        self.popen.stdin.write(json.dumps({"do": what, **arguments}) + "\n")
        self.popen.stdin.flush()

    def mark(self):
        """Return a position: ``wait(after=...)`` passes over what came before."""
        with self._more:
            return len(self._events)

    def events(self, after=0):
        with self._more:
            return self._events[after:]

    def wait(self, wanted, timeout=10.0, after=0):
        """Return the first event for which ``wanted`` is true."""
        end = time.monotonic() + timeout
        with self._more:
            seen = after
            while True:
                for event in self._events[seen:]:
                    if wanted(event):
                        return event
                seen = len(self._events)
                left = end - time.monotonic()
                if left <= 0:
                    last = self._events[after:][-3:]
                    raise AssertionError(f"not within {timeout} s; last events: {last}")
                self._more.wait(left)

    def publish(self, topic, kind, fields, *, latch=False, connected=False):
        mark = self.mark()
        options = {"latch": latch, "connected": connected}
        self.do("publish", topic=topic, kind=kind, fields=fields, **options)
        return self.wait(lambda e: e["event"] == "published" and e["topic"] == topic, after=mark)

    def subscribe(self, topic, kind="eddi_messages/ConSertOutput"):
        self.do("subscribe", topic=topic, kind=kind)

    def active(self, topic, expected, timeout=10.0, after=None):
        """Wait until the newest output says exactly these guarantees are active."""
        mark = self.mark() if after is None else after
        return self.wait(
            lambda e: e["event"] == "message" and e["topic"] == topic and active(e) == expected,
            timeout,
            mark,
        )

    def outputs(self, topic, after=0):
        return [e for e in self.events(after) if e["event"] == "message" and e["topic"] == topic]

    def diagnostics(self, hardware, wanted, timeout=10.0, after=None):
        """Wait for a status of one node and return (level, message, values)."""

        def fits(event):
            if event["event"] != "message" or event["topic"] != "/diagnostics":
                return False
            found = status_of(event, hardware)
            return found is not None and wanted(*found)

        mark = self.mark() if after is None else after
        return status_of(self.wait(fits, timeout, mark), hardware)

    def destroy(self):
        if self.popen.poll() is None:
            self.popen.send_signal(signal.SIGCONT)
            self.popen.kill()
        self.popen.wait()
        self._reader.join()
        self.popen.stdin.close()
        self.popen.stdout.close()


def active(event):
    """Return the ids of the active guarantees of an output."""
    return {item["id"] for item in event["data"]["guarantees"] if item["active"]}


def status_of(event, hardware):
    for status in event["data"]["status"]:
        if status["hardware_id"] == hardware:
            values = {pair["key"]: pair["value"] for pair in status["values"]}
            return status["level"], status["message"], values
    return None


class World:
    """Everything that one test (or one test run) started, and how to end it."""

    def __init__(self, folder, messages):
        self.folder = Path(folder)
        self.messages = messages
        self._count = 0
        self._things = []

    def new_log(self):
        self._count += 1
        return self.folder / f"{self._count}.log"

    def env(self, master, messages=None):
        paths = [messages or self.messages, RUNTIME]
        paths += [path / "src" for path in PACKAGES.values()]
        return {
            "PATH": "/usr/sbin:/usr/bin:/sbin:/bin",
            "HOME": str(self.folder),
            "LANG": "C.UTF-8",
            "PYTHONPATH": os.pathsep.join(map(str, paths)),
            "PYTHONUNBUFFERED": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
            "ROS_MASTER_URI": master.uri,
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(self.folder),
            "ROS_LOG_DIR": str(self.folder / "log"),
        }

    def process(self, command, env):
        process = Process(command, env, self.new_log())
        self._things.append(process)
        return process

    def master(self, port=None):
        return Master(self, port).start()

    def probe(self, master, messages=None):
        return self.probe_of([PYTHON, str(PROBES / "ros1.py")], self.env(master, messages))

    def probe_of(self, command, env):
        probe = Probe(command, env, self.new_log())
        self._things.append(probe)
        return probe

    def node(self, master, package, *arguments, script=None, env=None):
        """Start the node of a package; ``compiled:=PATH`` says which monitor the tester has."""
        path = script or PACKAGES[package] / "scripts" / "RosNode.py"
        words = [str(one) for one in arguments]
        models = [one for one in words if one.startswith("compiled:=")]
        command = [PYTHON, str(path), *(one for one in words if one not in models)]
        given = {"COMPILED": "".join(models).partition(":=")[2], **(env or {})}
        return self.process(command, {**self.env(master), **given})

    def destroy(self):
        for thing in reversed(self._things):
            thing.destroy()
        left = [t.popen.pid for t in self._things if t.popen.poll() is None]
        assert not left, left


def make_messages(folder, texts, name="eddi_messages"):
    """Generate ROS's own Python classes of a package with Debian's genpy, no catkin."""
    texts = {**COMMON, **texts} if name == "eddi_messages" else texts
    package = Path(folder) / name
    sources = Path(folder) / "msg"
    sources.mkdir(parents=True)
    (package / "msg").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    for message, text in texts.items():
        (sources / f"{message}.msg").write_text(text)
    files = [str(sources / f"{message}.msg") for message in sorted(texts)]
    command = [PYTHON, "/usr/lib/genpy/genmsg_py.py", "-p", name]
    command += ["-I", f"{name}:{sources}", "-I", "std_msgs:/usr/share/std_msgs/msg"]
    command += ["-o", str(package / "msg")]
    clean = {"PATH": "/usr/bin:/bin"}
    subprocess.run([*command, *files], env=clean, check=True, stdout=sys.stderr)
    subprocess.run([*command, "--initpy"], env=clean, check=True, stdout=sys.stderr)
    return Path(folder)
