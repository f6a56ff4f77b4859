"""The parts of the node that need no graph, under the interpreter that has rospy."""

import subprocess

import pytest

from tests.ros1.world import HERE, PYTHON, Master

pytestmark = pytest.mark.ros


def test_parts(world):
    parts = HERE / "parts.py"
    ran = subprocess.run(
        [PYTHON, str(parts)],
        env=world.env(Master(world)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.count("passed check_") == parts.read_text().count("\ndef check_") > 0
