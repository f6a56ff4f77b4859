"""The runtime and the generated packages run on the robot's Python, and agree on a version."""

from __future__ import annotations

import ast
import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import eddi_runtime
import pytest

import eddi_scaffold
from tests.checkouts import HERE, PLAIN_PACKAGES, run
from tests.interpreters import CACHE, SINCE, old_python

RUNTIME = HERE / "runtime_lib" / "src" / "eddi_runtime"
EXPECTED = HERE / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
GOLDEN = HERE / "tests" / "golden"
FOLDERS = (RUNTIME, EXPECTED, GOLDEN / "dds", GOLDEN / "ros2", *PLAIN_PACKAGES)
ON_THE_ROBOT = sorted(path for folder in FOLDERS for path in folder.rglob("*.py"))


PROGRAM_TEXT = {
    *("exec", "eval", "compile", "__import__", "builtins", "__builtins__"),
    *("importlib", "pkgutil", "runpy", "marshal", "pickle"),
}
"""What makes a program of data, or chooses a module by a computed name."""


@pytest.mark.parametrize("path", ON_THE_ROBOT, ids=lambda path: str(path.relative_to(HERE)))
def test_python_3_8_that_makes_no_program_text(path: Path) -> None:
    names = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"), feature_version=(3, 8))):
        if isinstance(node, ast.Name):
            names.add(node.id)
        elif isinstance(node, ast.Import):
            names.update(alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            names.add(str(node.module).partition(".")[0])
    assert not names & PROGRAM_TEXT


def test_library_of_python_3_8() -> None:
    """Vermin knows since when each call of the standard library exists."""
    vermin = Path(sys.executable).with_name("vermin")
    if not vermin.exists():
        pytest.skip("vermin is not installed")
    options = ["--no-tips", f"--target={SINCE}-", "--violations"]
    run([str(vermin), *options, *map(str, FOLDERS)], HERE)


@pytest.fixture(scope="session")
def old_pytest() -> Path:
    """Return a Python 3.8 with pytest, installed once."""
    python = old_python()
    home = CACHE / f"python{SINCE}"
    ready = home / "ready-with-timeout"
    if not ready.exists():
        shutil.rmtree(home, ignore_errors=True)
        plugins = ["hypothesis==6.113.*", "pytest-timeout==2.3.*"]  # pyproject.toml names them
        wanted = ["pytest==8.3.*", *plugins, "numpy==1.24.*"]
        pip = [str(home / "bin" / "python"), "-m", "pip", "install", "--no-compile", "--quiet"]
        for command in ([python, "-m", "venv", str(home)], [*pip, *wanted]):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                reason = done.stderr.strip().splitlines()[-1:] or ["no reason given"]
                pytest.skip(f"Python {SINCE} is here, pytest for it cannot be had: {reason[0]}")
        ready.touch()
    return home / "bin" / "python"


@pytest.mark.slow
def test_runtime_tests_pass_on_python_3_8(old_pytest: Path) -> None:
    """Of the runtime by itself; what a test compiles first, newer Pythons compile."""
    options = ["-q", "-p", "no:cacheprovider", "-c", str(HERE / "pyproject.toml"), "-m", "not slow"]
    command = [str(old_pytest), "-m", "pytest", *options, str(HERE / "runtime_lib" / "tests")]
    done = run(command, HERE, {"PYTHONDONTWRITEBYTECODE": "1", "PYTEST_ADDOPTS": ""})
    assert re.search(r"^\d+ passed", done.stdout, re.MULTILINE), done.stdout


@pytest.mark.slow
def test_packages_do_the_same_on_python_3_8(old_pytest: Path, tmp_path: Path) -> None:
    for package in PLAIN_PACKAGES:
        shutil.copytree(package, tmp_path / package.name)
    shutil.copytree(RUNTIME, tmp_path / "eddi_runtime")
    script = HERE / "tests" / "rules" / "replayed.py"
    here, there = (
        json.loads(run([str(python), str(script), str(tmp_path)], HERE, {"PYTHONPATH": ""}).stdout)
        for python in (sys.executable, old_pytest)
    )
    assert here.keys() == there.keys()
    for package in here:
        different = [
            (step, one, other)
            for step, (one, other) in enumerate(zip(here[package], there[package], strict=True))
            if not alike(one, other)
        ]
        assert not different, (package, different[0])
        assert len({json.dumps(step) for step in here[package]}) > 10, "each step is the same"


def alike(one: object, other: object) -> bool:
    """Return whether two outputs are equal, floats but for the last digits."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-12) or (math.isnan(one) and math.isnan(other))
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    return one == other


def test_no_template_makes_program_text() -> None:
    """Those as well that no example renders, such as a launcher of all monitors."""
    words = "|".join(sorted(PROGRAM_TEXT))
    used = re.compile(rf"(?<![\w.])(?:{words})(?=\()|\bimport (?:{words})\b|\bfrom (?:{words})\b")
    templates = [path for path in (HERE / "copier_templates").rglob("*.py.jinja") if path.is_file()]
    assert len(templates) > 20
    assert not [path for path in templates if used.search(path.read_text("utf-8"))]


def test_one_version() -> None:
    version = eddi_scaffold.__version__
    assert eddi_runtime.__version__ == version
    manifest = (EXPECTED / "eddi_runtime" / "package.xml").read_text("utf-8")
    assert f"<version>{version}</version>" in manifest
    assert f"\nversion: {version}\n" in (HERE / "CITATION.cff").read_text("utf-8")
    assert f"\n## [{version}]" in (HERE / "CHANGELOG.md").read_text("utf-8")
