"""Catkin workspaces as a person builds them."""

import hashlib
import os
import shutil
from pathlib import Path

from tests.checkouts import run
from tests.cli.command import run as eddi
from tests.e2e.robot import clean_env, sourced

_INTERPRETER = "-DPYTHON_EXECUTABLE=/usr/bin/python3"
_BUILT = "build/\ndevel/\ninstall/\nlogs/\n.catkin_tools/\n.catkin_workspace\n"


class Workspace:
    """A workspace root."""

    def __init__(self, path, home, *, languages=False):
        self.path = Path(path)
        self.home = Path(home)
        self._build_env = clean_env(home)
        if not languages:  # most of the time of a build
            self._build_env["ROS_LANG_DISABLE"] = "gencpp:genlisp"
        (self.path / "src").mkdir(parents=True)
        (self.path / ".gitignore").write_text(_BUILT)

    @property
    def packages(self):
        return self.path / "src" / "eddi_monitor"

    def eddi_input(self, package):
        return self.packages / package / "src" / package / "EDDIInput.py"

    def contents(self):
        """Return package -> digest of all its files, and of the modes that catkin looks at."""
        folders = sorted(path for path in self.packages.iterdir() if path.is_dir())
        return {folder.name: _digest(folder) for folder in folders}

    def generate(self, model, *configs, words=()):
        """Generate in this process."""
        options = [word for config in configs for word in ("-c", config)]
        done = eddi("generate", "-w", self.path, "-m", model, *options, *words, cwd=self.path)
        assert done.status == 0, done.err

    def catkin_make(self, *targets):
        return self._build(["catkin_make", "-j2", _INTERPRETER, *targets])

    def catkin_build(self):
        self._build(["catkin", "init"])
        return self._build(["catkin", "build", "--no-status", "-j2", "--cmake-args", _INTERPRETER])

    def _build(self, command):
        alone = ["env", "-i", *(f"{name}={value}" for name, value in self._build_env.items())]
        done = run([*alone, *command], self.path)
        return done.stdout + done.stderr

    def devel_env(self):
        return sourced(self.path / "devel" / "setup.bash", self.home)

    def move_install(self, target):
        """Move the install space away, delete all that it came from, and return its environment."""
        (self.path / "install").rename(target)
        for name in ("src", "build", "devel"):
            shutil.rmtree(self.path / name)
        return sourced(Path(target) / "setup.bash", self.home)


def _digest(folder):
    found = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            executable = os.access(path, os.X_OK)
            found.update(f"{path.relative_to(folder)} {executable}\n".encode() + path.read_bytes())
    return found.hexdigest()
