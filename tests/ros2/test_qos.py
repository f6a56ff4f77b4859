"""Qualities of service on the wire: who meets whom, and what a late listener is told."""

import json
import subprocess
from pathlib import Path

import pytest

from tests.contract.stages import free_domain, on_loopback
from tests.ros2.world import RELEASE, shared

pytestmark = [pytest.mark.slow, pytest.mark.ros]


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    RELEASE.demand()
    env = RELEASE.workspace(shared(tmp_path_factory))
    lock, domain = free_domain()
    words = [RELEASE.python, str(Path(__file__).with_name("qos_pairs.py"))]
    done = subprocess.run(
        words, env={**env, **on_loopback(domain)}, capture_output=True, text=True, check=False
    )
    lock.close()
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def test_our_word_about_a_pair_is_that_of_the_middleware(rows):
    assert len(rows) == 34
    assert sum(row["met"] for row in rows) == 24
    assert [row for row in rows if row["met"] != row["expected"]] == []


def test_only_who_asks_for_what_was_kept_gets_it(rows):
    assert sum(row["kept"] for row in rows) == 3
    assert [row for row in rows if row["late"] != row["kept"]] == []
