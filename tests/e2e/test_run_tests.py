"""`catkin_make run_tests` says what it cannot test."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, run

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def test_without_rostest_it_says_so(tmp_path: Path) -> None:
    if shutil.which("catkin_make", path="/usr/bin") is None:
        pytest.skip("no catkin here")
    made, only = tmp_path / "made", tmp_path / "only"
    (made / "src").mkdir(parents=True)
    sources = ("-m", EXAMPLE / "two_conserts.xml", "-c", EXAMPLE / "consert_b_config.yml")
    assert run("generate", "-w", made, *sources, cwd=tmp_path).status == 0
    shutil.copytree(made / "src" / "eddi_monitor" / "consertb", only / "src" / "consertb")
    command = ["/usr/bin/catkin_make", "-DPYTHON_EXECUTABLE=/usr/bin/python3", "run_tests"]
    done = subprocess.run(
        [*command, "-DCMAKE_DISABLE_FIND_PACKAGE_rostest=TRUE"],
        cwd=only,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    said = "consertb is NOT TESTED: install rostest (Debian: librostest-dev), then build again"
    assert said in done.stdout
    assert "CMake Warning" not in done.stderr.replace("CMAKE_DISABLE_FIND_PACKAGE", "")
