"""Plain Copier without answers: a place to start, or a sentence that says what is missing."""

import subprocess
from pathlib import Path

import pytest

from tests.checkouts import HERE
from tests.cli.command import run

pytestmark = pytest.mark.slow


def copy(*words: object) -> subprocess.CompletedProcess[str]:
    command = ["copier", "copy", "--trust", "--defaults", "--vcs-ref", "HEAD", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_without_answers_it_makes_the_cart(tmp_path: Path) -> None:
    done = copy(HERE, tmp_path / "new")
    assert done.returncode == 0
    assert "eddi-scaffold answers" in done.stderr
    assert run("check", "cart_config.yml", cwd=tmp_path / "new").status == 0


def test_a_monitor_without_answers_ends_in_a_sentence(tmp_path: Path) -> None:
    done = copy("-d", "template=plain_monitor", HERE, tmp_path / "new")
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "`eddi-scaffold answers -m MODEL -o answers.yml`" in done.stderr.splitlines()[-1]
    assert not (tmp_path / "new").exists()
