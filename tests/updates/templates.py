"""A template repository with version tags, made from this checkout; no version looks alike."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]
_PARTS = ("copier.yml", "copier_templates", "eddi_scaffold", "runtime_lib", "pyproject.toml")
_INPUT = "copier_templates/eddi_input.py.jinja"
_MONITOR = "copier_templates/ros1_monitor"
_METHOD = (
    "    def process_{{ input.attribute }}"
    "(self{% for name in input.arguments %}, {{ name }}{% endfor %}):\n"
)
_IMPORTS = "{% for line in input_imports %}\n"
_PROCESSING = "\n    def processing(self, simulator_outputs):\n"

# An empty text is the end of the file.
# Second look: signature lines, docstrings and the lines round the markers change.
_SECOND = {
    _INPUT: (
        ('"""One attribute for each', '"""Second look: one attribute for each'),
        (
            _METHOD,
            _METHOD.replace("):\n", ", *_):\n") + '        """Set `{{ input.attribute }}`."""\n',
        ),
        (
            "        {{ input.region_begin }}\n",
            "        # your code\n        {{ input.region_begin }}\n",
        ),
        ('        """Call the method of each', '        """Second look: call the method of each'),
    ),
    f"{_MONITOR}/package.xml.jinja": (
        (
            "  <exec_depend>rospy</exec_depend>\n",
            "  <exec_depend>rospy</exec_depend>\n  <doc_depend>doxygen</doc_depend>\n",
        ),
    ),
    f"{_MONITOR}/CMakeLists.txt.jinja": (("VERSION 3.10.0", "VERSION 3.16.0"),),
    f"{_MONITOR}/launch/eddi_monitor.launch.jinja": (('default="1" doc', 'default="2" doc'),),
    f"{_MONITOR}/README.md.jinja": (("", "\nSecond look.\n"),),
    f"{_MONITOR}/scripts/RosNode.py.jinja": (
        ("class RosNode", "SECOND_LOOK = True\n\n\nclass RosNode"),
    ),
}

# Third look: another import, a new method, lines behind the end marker.
_THIRD = {
    _INPUT: (
        (
            '"""One attribute for each input of the monitor."""',
            '"""What the monitor reads (third look)."""',
        ),
        (_IMPORTS, f"import logging\n\n{_IMPORTS}"),
        (
            "        {{ input.region_end }}\n",
            "        {{ input.region_end }}\n        logging.debug('third look')\n",
        ),
        (
            _PROCESSING,
            '\n    def look(self):\n        """Return the look."""\n        return 3\n'
            + _PROCESSING,
        ),
    ),
    f"{_MONITOR}/package.xml.jinja": (
        ('<package format="3">', '<package format="3"><!-- third look -->'),
    ),
    f"{_MONITOR}/CMakeLists.txt.jinja": (
        ("catkin_package()\n", "catkin_package()\n# third look\n"),
    ),
    f"{_MONITOR}/README.md.jinja": (("", "\nThird look.\n"),),
}

_LOOKS = ({}, _SECOND, _THIRD)
VERSIONS = 9


@dataclass(frozen=True)
class Templates:
    """A git repository; version ``n`` (from 1) is tagged ``v0.n.0`` and has look ``n % 3``."""

    path: Path

    def tag(self, version: int) -> str:
        return f"v0.{version}.0"


def git(folder: Path, *words: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *words],
        check=True,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
    )
    return done.stdout


def make_templates(path: Path, versions: int = VERSIONS, *, tags: bool = True) -> Templates:
    """Copy the working tree's templates and tools, and commit and tag them in several looks."""
    _copy(path)
    git(path, "init", "-q", "-b", "main")
    for version in range(1, versions + 1):
        new_version(path, version)
        if tags:
            git(path, "tag", f"v0.{version}.0")
    return Templates(path)


def new_version(path: Path, version: int) -> None:
    """Commit the look of one version."""
    names = {name for look in _LOOKS for name in look}
    for name in names:
        shutil.copy(CHECKOUT / name, path / name)
    for name, changes in _LOOKS[(version - 1) % 3].items():
        text = (path / name).read_text()
        for old, new in changes:
            assert not old or text.count(old) == 1, (
                f"{name} has no single {old!r} any more: adapt this test's looks"
            )
            text = text.replace(old, new) if old else text + new
        (path / name).write_text(text)
    git(path, "add", "-A", "-f")
    git(path, "commit", "-q", "--allow-empty", "-m", f"version {version}")


def _copy(path: Path) -> None:
    path.mkdir(parents=True)
    ignored = shutil.ignore_patterns(
        "__pycache__", "*.pyc", "*.egg-info", ".hypothesis", "templates.bundle"
    )
    for part in _PARTS:
        source = CHECKOUT / part
        if source.is_dir():
            shutil.copytree(source, path / part, symlinks=True, ignore=ignored)
        else:
            shutil.copy(source, path / part)
