"""The monitor on DDS and a robot in C++ with another implementation: Fast DDS of Debian."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.contract.stages import DdsStage, why_no_dds
from tests.ros1.world import demand, until

pytestmark = pytest.mark.slow

SOURCE = Path(__file__).with_name("fastdds_peer.cpp")
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")


class Peer:
    """The program, line by line."""

    def __init__(self, program, domain, log):
        self._log = log
        self._out = log.open("w")
        command = [program, str(domain)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=self._out, stderr=self._out, text=True
        )

    def lines(self):
        return self._log.read_text("utf-8").splitlines()

    def publish(self, value):
        self._process.stdin.write(f"{value:d}\n")
        self._process.stdin.flush()

    def end(self, kill=False):
        if kill:
            self._process.kill()
        self._process.stdin.close()
        status = self._process.wait(10.0)
        self._out.close()
        return status


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    missing = shutil.which("g++") is None or not HEADER.exists()
    reason = "Fast DDS is not here: apt-get install g++ libfastrtps-dev" if missing else None
    demand(reason or why_no_dds())
    made = tmp_path_factory.mktemp("fastdds") / "peer"
    libraries = ["-lfastrtps", "-lfastcdr"]
    subprocess.run(["g++", "-std=c++17", "-o", made, SOURCE, *libraries], check=True)
    return made


def test_every_flip_and_the_death_of_the_robot(program, tmp_path):
    stage = DdsStage(tmp_path)
    peer = None
    try:
        stage.begin()
        stage.start()
        peer = Peer(program, stage.domain, tmp_path / "peer.log")
        until(
            lambda: "active" in peer.lines(), timeout=20.0, what="the guarantees, of a late joiner"
        )
        for value, heard in ((1, "active Slow"), (0, "active")) * 5:
            mark = stage.ear.mark()

            def flipped(value=value, heard=heard):
                peer.publish(value)  # again, until it is seen: it is fresh for 0.8 s
                return peer.lines()[-1] == heard

            until(flipped, what=f"{heard} after {value}")
            stage.until(*heard.split()[1:], after=mark, timeout=2.0)
        changes = [one for one in peer.lines() if one.startswith("active")]
        kept = [one for k, one in enumerate(changes) if k == 0 or changes[k - 1] != one]
        assert kept == ["active", *["active Slow", "active"] * 5]

        until(lambda: peer.publish(1) or peer.lines()[-1] == "active Slow", what="active once more")
        peer.end(kill=True)
        stage.until()
        stage.told("/in/healthy: ", timeout=20.0)
        peer = Peer(program, stage.domain, tmp_path / "again.log")
        until(lambda: "ready" in peer.lines(), what="the robot comes back")
        until(
            lambda: peer.publish(1) or peer.lines()[-1] == "active Slow",
            timeout=40.0,
            what="active again",
        )
        assert peer.end() == 0
    finally:
        if peer is not None and peer._process.poll() is None:
            peer.end(kill=True)
        stage.destroy()
