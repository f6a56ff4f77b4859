"""ROS 2 from wheels (``script/ros2.sh``), and workspaces that its colcon builds.

Where the setup.bash of a ROS 2 was sourced, that one is tested instead.
"""

import fcntl
import hashlib
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, ROOT, run
from tests.e2e.robot import CLEAN_PATH
from tests.fields import table
from tests.interpreters import CACHE
from tests.ros1.world import demand

FLAGS = (
    "-DCMAKE_C_FLAGS=-O0",
    "-DCMAKE_CXX_FLAGS=-O0",
    f"-DCMAKE_PROJECT_INCLUDE={Path(__file__).with_name('without_cpp.cmake')}",
)
"""Nobody waits for these messages, and no test is written in C++."""
_WHEELS = ROOT / "script" / "ros2_wheels.txt"
_SOURCED = bool(os.environ.get("AMENT_PREFIX_PATH"))


class Release:
    """One ROS 2 of this machine."""

    def __init__(self, name):
        self.name = name
        of = hashlib.sha256(_WHEELS.read_bytes()).hexdigest()[:12]
        self.prefix = CACHE / f"ros2-{name}-{of}"
        self.python = "/usr/bin/python3" if _SOURCED else str(self.prefix / "bin" / "python")

    def why_not(self):
        """Return why it cannot be used here, ``None`` when it can."""
        if _SOURCED or (self.prefix / ".complete").is_file():
            return None
        return f"no ROS 2 {self.name} here: script/ros2.sh {self.name} installs it, or says why not"

    def demand(self):
        """Skip a test where it cannot be used; fail where it must be there."""
        if (reason := self.why_not()) and "EDDI_NO_ROS2" in os.environ:
            pytest.skip(reason)  # its wheels do not fit
        demand(reason)

    def env(self, home):
        """Return the environment of a person whose ROS 2 it is."""
        if _SOURCED:
            return dict(os.environ)
        return {
            "PATH": f"{self.prefix / 'bin'}:{CLEAN_PATH}",
            "HOME": str(home),
            "LANG": "C.UTF-8",
            "AMENT_PREFIX_PATH": str(self.prefix),
            "CMAKE_PREFIX_PATH": str(self.prefix),
            "LD_LIBRARY_PATH": str(self.prefix / "lib"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }

    def colcon(self, place, *words, env=None):
        """Run colcon in a workspace and return what it says."""
        cmake = ("--cmake-args", f"-DPython3_EXECUTABLE={self.python}", *FLAGS)
        done = subprocess.run(
            ["colcon", *words, *(cmake if words[0] == "build" else ())],
            cwd=place,
            env=env or self.env(place),
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert done.returncode == 0, done.stdout
        return done.stdout

    def sourced(self, place):
        """Return the environment after ``source install/setup.bash`` of a workspace."""
        words = ["/bin/bash", "-c", '. "$0" && env -0', str(Path(place) / "install/setup.bash")]
        done = subprocess.run(
            words, env=self.env(place), check=True, capture_output=True, text=True
        )
        return dict(line.split("=", 1) for line in done.stdout.split("\0") if "=" in line)

    def workspace(self, place):
        """Build the example's monitors, once; return the environment there."""

        def generate():
            letters = [w for one in "ab" for w in ("-c", EXAMPLE / f"consert_{one}_config.yml")]
            words = ("-w", place, "-m", EXAMPLE / "two_conserts.xml", *letters)
            done = run("generate", "--platform", "ros2", *words, cwd=place)
            assert done.status == 0, done.err

        return self._built(place, generate)

    def fields(self):
        """Build the messages of all types of fields, once on a machine; return the environment."""
        files = (_WHEELS, *sorted(path for path in table.PACKAGE.rglob("*") if path.is_file()))
        of = hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]
        place = CACHE / f"fields-{self.name}-{of}"
        return self._built(
            place, lambda: shutil.copytree(table.PACKAGE, place / "src" / "field_msgs")
        )

    def _built(self, place, write):
        """Build what a function writes, unless another worker, or run, has done so."""
        place.mkdir(parents=True, exist_ok=True)
        with (place / ".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (place / ".complete").exists():
                for name in ("src", "build", "install"):
                    shutil.rmtree(place / name, ignore_errors=True)
                (place / "src").mkdir()
                write()
                before = contents(place)
                self.colcon(place, "build")
                assert contents(place) == before, "a build writes nothing into the sources"
                (place / ".complete").touch()
        return self.sourced(place)


def contents(place):
    """Return the files of the sources."""
    return {path: path.read_bytes() for path in (place / "src").rglob("*") if path.is_file()}


def shared(tmp_path_factory):
    """Return the folder of the workspace that all workers of a run have in common."""
    base = tmp_path_factory.getbasetemp()
    return (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "ros2"


RELEASE = Release(os.environ.get("EDDI_ROS2", "kilted"))
"""The one that is tested: ``EDDI_ROS2=jazzy script/test tests/contract`` takes another one."""
