"""The generator from a clean clone of this repository, released under a version tag of its own."""

import os
import subprocess
import sys
from pathlib import Path

from tests.checkouts import keep_compiled

HERE = Path(__file__).parents[2]
# Newer than any release that the clone brings along: copier takes the newest tag.
FIRST, SECOND = "v900.0.0", "v900.1.0"
_SECOND_LOOK = {
    "copier_templates/eddi_input.py.jinja": (
        '"""One attribute for each input of the monitor."""',
        '"""One attribute for each input of the monitor, second version."""',
    ),
    "copier_templates/ros1_monitor/.eddi/new/{{ stage }}/scripts/RosNode.py.jinja": (
        '"""ROS 1 node of the monitor',
        '"""Second version of the ROS 1 node of the monitor',
    ),
    "copier_templates/ros1_monitor/.eddi/new/{{ stage }}/CMakeLists.txt.jinja": (
        "catkin_package()\n",
        "catkin_package()  # second version\n",
    ),
}


def git(folder, *words):
    done = subprocess.run(["git", *words], cwd=folder, check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"git {' '.join(words)}: {done.stderr}"
    return done.stdout


class Generator:
    """A clone that serves as the program and as the template, like an installed checkout.

    Attributes:
        path: the clone.
    """

    def __init__(self, folder):
        self.path = Path(folder)
        git(HERE, "clone", "--quiet", str(HERE), str(self.path))
        git(self.path, "tag", FIRST)
        keep_compiled(self.path)
        self.examples = self.path / "examples" / "two-conserts"

    def release_second_version(self):
        """Change texts in an editable and in two generated files, and tag that."""
        for name, (old, new) in _SECOND_LOOK.items():
            path = self.path / name
            text = path.read_text()
            assert text.count(old) == 1, (name, old)
            path.write_text(text.replace(old, new))
        git(self.path, "commit", "--quiet", "--all", "--message", "Second version")
        git(self.path, "tag", SECOND)

    def run(self, *words):
        """Run ``eddi-scaffold`` and return what it said."""
        paths = [self.path, self.path / "runtime_lib" / "src"]
        env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths))}
        return _run(
            [sys.executable, "-m", "eddi_scaffold", *map(str, words)], env, self.path.parent
        )

    def generate(self, workspace, model, *configs):
        options = [word for config in configs for word in ("-c", config)]
        return self.run("generate", "-w", workspace, "-m", model, *options)

    def update(self, package, data_file=None):
        """Run plain ``copier update --trust``, with new answers when the model changed."""
        data = ["--data-file", str(data_file)] if data_file else []
        command = [sys.executable, "-m", "copier", "update", "--trust", "--defaults", *data]
        return _run([*command, package.name], dict(os.environ), package.parent)


def _run(command, env, folder):
    done = subprocess.run(command, env=env, cwd=folder, check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr
