"""How long a publisher that ends without a word is counted, as docs/how-to/ros2.md says it."""

import subprocess
from pathlib import Path

import pytest

from tests.contract.stages import free_domain, on_loopback
from tests.ros2.world import RELEASE

pytestmark = [pytest.mark.slow, pytest.mark.ros]

PROGRAM = Path(__file__).with_name("gone.py")


def test_a_publisher_that_is_killed_is_gone_after_its_lease(tmp_path):
    RELEASE.demand()
    usual, started = ("FASTDDS_DEFAULT_PROFILES_FILE", "CYCLONEDDS_URI"), []
    for profile in (True, False):  # both at once
        lock, domain = free_domain()
        env = {**RELEASE.env(tmp_path), **on_loopback(domain)}
        if not profile:
            env = {name: value for name, value in env.items() if name not in usual}
            env["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        words = [RELEASE.python, str(PROGRAM)]
        process = subprocess.Popen(words, env=env, stdout=subprocess.PIPE, text=True)
        started.append((process, lock))
    said = [(process.communicate()[0], process.returncode) for process, _ in started]
    for _, lock in started:
        lock.close()
    assert [status for _, status in said] == [0, 0]
    short, long = (float(text) for text, _ in said)
    assert 0.5 < short < 5.0  # a lease of 2 s
    lease = 10.0 if "cyclone" in env.get("RMW_IMPLEMENTATION", "") else 20.0
    assert lease - 4.0 < long < lease + 4.0
