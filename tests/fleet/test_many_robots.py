"""Many robots as processes, on a network that fails in every way: no demand outlives its lease.

``pytest tests/fleet/test_many_robots.py --hypothesis-profile=long`` runs 50 for eleven minutes.
"""

from __future__ import annotations

import heapq
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import pytest
from hypothesis import settings

from eddi_scaffold.config.field_types import fields_of
from eddi_scaffold.kinds.consert import BETWEEN_ROBOTS, MESSAGES
from tests.cli.command import run
from tests.data_files import data_text
from tests.package_texts import facts_in
from tests.ros1.world import RUNTIME

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
CONFIG = data_text("fleet/mover_config.yml")


class Size(NamedTuple):
    robots: int
    seconds: float
    frequency: float
    lease: float


LONG = settings.default.max_examples >= 1000
SIZE = Size(50, 660.0, 1.0, 4.0) if LONG else Size(5, 12.0, 5.0, 1.0)


class Relay:
    """What is between the robots: it loses, delays, repeats and reorders, and falls apart."""

    def __init__(self, chance: Random) -> None:
        self.line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
        self.line.bind(("127.0.0.1", 0))
        self.line.settimeout(0.01)
        self.port = self.line.getsockname()[1]
        self.counts = {"words": 0, "lost": 0, "late": 0, "twice": 0, "partitions": 0}
        self._chance, self._robots = chance, {}
        self._parts: dict[str, int] = {}
        self._queue: list[tuple[float, int, tuple[str, int], bytes]] = []
        self._ended = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def end(self) -> None:
        self._ended = True
        self._thread.join()
        self.line.close()

    def _run(self) -> None:
        due = time.monotonic()
        while not self._ended:
            now = time.monotonic()
            if now >= due:
                apart = self._chance.random() < 0.4
                self.counts["partitions"] += apart
                self._parts = {one: self._chance.randrange(3) * apart for one in self._robots}
                due = now + self._chance.uniform(1.0, 8.0)
            while self._queue and self._queue[0][0] <= now:
                _, _, to, data = heapq.heappop(self._queue)
                self.line.sendto(data, to)
            try:
                data, sender = self.line.recvfrom(65536)
            except TimeoutError:
                continue
            if data.startswith(b'{"robot"'):
                self._robots[json.loads(data)["robot"]] = sender
            else:
                self._spread(data, sender, now)

    def _spread(self, data: bytes, sender: tuple[str, int], now: float) -> None:
        chance, counts = self._chance.random, self.counts
        of = next((name for name, where in self._robots.items() if where == sender), None)
        for name, to in self._robots.items():
            counts["words"] += 1
            apart = self._parts.get(name, 0) != self._parts.get(of or "", 0)
            if chance() < (0.7 if apart else 0.05):
                counts["lost"] += 1
                continue
            slow = chance() * 20.0 if apart else chance() * 4.0 if chance() < 0.1 else 0.0
            times = 2 if chance() < 0.05 else 1
            counts["late"] += slow > 0.0
            counts["twice"] += times == 2
            for _ in range(times):
                if slow or times == 2:
                    later = now + slow + chance() * 3.0 * (times - 1)
                    heapq.heappush(self._queue, (later, counts["words"], to, data))
                else:
                    self.line.sendto(data, to)


class Fleet:
    """The robots, which are killed, stopped and started again."""

    def __init__(self, folder: Path, size: Size, chance: Random) -> None:
        self.folder, self.size, self._chance = folder, size, chance
        self.digest = generated(folder, size)
        self.relay = Relay(chance)
        self._count = 0
        self._clocks = clocks()
        self.running = {f"robot{k}": self.start(f"robot{k}") for k in range(size.robots)}

    def start(self, robot: str) -> subprocess.Popen[bytes]:
        self._count += 1
        texts = {**MESSAGES, **BETWEEN_ROBOTS}
        given = {
            "robot": robot,
            "relay": self.relay.port,
            "frequency": self.size.frequency,
            "lease": self.size.lease,
            "digest": self.digest,
            "folder": str(self.folder),
            "counts": str(self.folder / f"{self._count}.json"),
            "seed": self._count,
            "messages": {name: fields_of(text, "eddi_messages") for name, text in texts.items()},
        }
        clock = []
        if self._clocks:
            clock = ["unshare", "--time", "--monotonic", str(self._chance.randrange(10**6)), "--"]
        command = [*clock, sys.executable, str(HERE / "robot.py"), json.dumps(given)]
        env = {"PATH": os.environ["PATH"], "PYTHONPATH": str(RUNTIME)}
        with (self.folder / f"{self._count}.log").open("wb") as log:
            return subprocess.Popen(command, env=env, stdout=log, stderr=log)

    def live(self) -> dict[str, int]:
        """Let them run for their time; return how often each thing was done to them."""
        done = dict.fromkeys(("killed", "stopped"), 0)
        spared = self.size.robots // 4  # these show whether memory grows
        asleep: list[tuple[float, subprocess.Popen[bytes]]] = []
        end = time.monotonic() + self.size.seconds
        while time.monotonic() < end:
            time.sleep(0.5)
            robot = f"robot{self._chance.randrange(spared, self.size.robots)}"
            what, one = self._chance.random(), self.running[robot]
            if what < 0.15:
                one.kill()
                one.wait()
                done["killed"] += 1
                self.running[robot] = self.start(robot)
            elif what < 0.25 and all(one is not other for _, other in asleep):
                one.send_signal(signal.SIGSTOP)  # the network brings what it has, all at once
                asleep.append((time.monotonic() + self._chance.uniform(0.5, 6.0), one))
                done["stopped"] += 1
            for moment, other in asleep[:]:
                if time.monotonic() >= moment:
                    asleep.remove((moment, other))
                    other.send_signal(signal.SIGCONT)
        return done

    def end(self) -> None:
        for one in self.running.values():
            one.send_signal(signal.SIGCONT)
            one.terminate()
        end = time.monotonic() + 10.0
        while any(one.poll() is None for one in self.running.values()) and time.monotonic() < end:
            time.sleep(0.05)
        for one in self.running.values():
            one.kill()
            one.wait()
        self.relay.end()

    def counts(self) -> dict[str, int]:
        """Return the sum of what all processes saw."""
        files = [json.loads(one.read_text("utf-8")) for one in self.folder.glob("[0-9]*.json")]
        return {key: sum(one[key] for one in files) for key in files[0]} | {"starts": self._count}


def clocks() -> bool:
    """Return whether each process can have a clock of its own here."""
    tried = ["unshare", "--time", "--monotonic", "1000", "--", "true"]
    return bool(shutil.which("unshare")) and not subprocess.run(tried, check=False).returncode


def generated(folder: Path, size: Size) -> str:
    """Generate the package of the robots; return the digest of its model."""
    text = CONFIG.replace("FREQUENCY", str(size.frequency)).replace("LEASE", str(size.lease))
    for digest in ("a" * 64, None):  # the digest of a model does not depend on its configuration
        config = folder / "config.yml"
        found = digest or facts_in(folder / "mover").digest
        config.write_text(text.replace("DIGEST", found), "utf-8")
        place = ("--platform", "dds", "-o", folder)
        done = run("generate", *place, "-m", HERE / "mover.yml", "-c", config, cwd=folder)
        assert done.status == 0, done.err
    return str(found)


def memory(folder: Path, robots: int) -> dict[str, int]:
    """Return the kilobytes that each robot has that was never killed."""
    sizes: dict[str, int] = {}
    for k in range(1, robots // 4 + 1):
        told: dict[str, Any] = json.loads((folder / f"{k}.json").read_text("utf-8"))
        sizes[f"robot{k - 1}"] = told["kilobytes"]
    return sizes


def test_no_demand_outlives_its_lease(tmp_path: Path) -> None:
    fleet = Fleet(tmp_path, SIZE, Random(1))
    early: dict[str, int] = {}
    timer = threading.Timer(SIZE.seconds / 3, lambda: early.update(memory(tmp_path, SIZE.robots)))
    try:
        timer.start()
        done = fleet.live()
    finally:
        timer.join()
        fleet.end()
    counts = fleet.counts()
    print(json.dumps({**counts, **done, **fleet.relay.counts}))
    logs = [one for one in tmp_path.glob("*.log") if b"Traceback" in one.read_bytes()]
    assert not logs, logs[0].read_text("utf-8")
    assert counts["entered"] > counts["steps"] / 20
    assert (counts["expired"], counts["wrong"]) == (0, 0)
    if LONG:
        late = memory(tmp_path, SIZE.robots)
        assert all(late[one] < 1.05 * early[one] for one in early), (early, late)
