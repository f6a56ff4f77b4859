"""A template repository with three tags, made from this checkout; no version looks alike."""

from __future__ import annotations

import compileall
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from py_compile import PycInvalidationMode

CHECKOUT = Path(__file__).parents[2]
_PARTS = ("copier.yml", "copier_templates", "eddi_scaffold", "runtime_lib", "pyproject.toml")
_TASKS = ("regions",)
_STAGE = "copier_templates/ros1_monitor/.eddi/new/{{ stage }}"
_CHANGES = {
    "copier_templates/eddi_input.py.jinja": (
        ("        self.setup()\n", "        self.version = 2\n        self.setup()\n"),
    ),
    f"{_STAGE}/launch/eddi_monitor.launch.jinja": (
        ('output="screen"\n', 'output="screen" required="false"\n'),
    ),
    f"{_STAGE}/CMakeLists.txt.jinja": (("config launch ", "config launch test "),),
    f"{_STAGE}/package.xml.jinja": (
        (
            "  <exec_depend>rospy</exec_depend>\n",
            "  <exec_depend>rospy</exec_depend>\n  <exec_depend>sensor_msgs</exec_depend>\n",
        ),
    ),
}
TAGS = {"first": "v0.1.0", "second": "v0.2.0", "third": "v0.3.0"}


@dataclass(frozen=True)
class Templates:
    """A git repository with the tags of ``TAGS``.

    ``second`` changes generated text outside and inside of regions; ``third`` also has a new file
    ``helpers.py`` beside ``EDDIInput.py``, and no ``node_test.py`` any more.
    """

    path: Path


def git(folder: Path, *words: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *words],
        check=True,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
    )
    return done.stdout


def make_templates(path: Path) -> Templates:
    """Copy the working tree's templates, with what Copier's tasks are of the programs."""
    path.mkdir(parents=True)
    ignored = shutil.ignore_patterns("__pycache__", "*.pyc", "*.egg-info", ".hypothesis", "tests")
    for part in _PARTS:
        source = CHECKOUT / part
        if source.is_dir():
            shutil.copytree(source, path / part, symlinks=True, ignore=ignored)
        else:
            shutil.copy(source, path / part)
    for template in (CHECKOUT / "copier_templates").glob("*/.eddi/new/*/test"):
        here = path / template.relative_to(CHECKOUT)
        shutil.copytree(template, here, dirs_exist_ok=True)
    for folder in (path / "eddi_scaffold").iterdir():
        if folder.is_dir() and folder.name not in _TASKS:
            shutil.rmtree(folder)
    for folder, depth in (("", 0), *((name, 9) for name in _TASKS)):
        compileall.compile_dir(  # else each task compiles its modules anew
            path / "eddi_scaffold" / folder,
            maxlevels=depth,
            quiet=1,
            invalidation_mode=PycInvalidationMode.UNCHECKED_HASH,
        )
    git(path, "init", "-q", "-b", "main")
    _commit(path, "first")
    for name, changes in _CHANGES.items():
        text = (path / name).read_text()
        for old, new in changes:
            assert text.count(old) == 1, f"{name} has no single {old!r}: adapt these changes"
            text = text.replace(old, new)
        (path / name).write_text(text)
    _commit(path, "second")
    (path / _STAGE / "test/node_test.py.jinja").unlink()
    helpers = path / _STAGE / "src/{{ package }}/helpers.py"
    helpers.write_text('"""Generated."""\n')
    _commit(path, "third")
    return Templates(path)


def _commit(path: Path, tag: str) -> None:
    git(path, "add", "-A", "-f")
    git(path, "commit", "-q", "-m", tag)
    git(path, "tag", TAGS[tag])
