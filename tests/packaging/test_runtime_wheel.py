"""The distribution `eddi-runtime` serves packages without a copy of it: built, installed, run."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import pytest
from eddi_runtime import __version__

from eddi_scaffold.program.runtime_parts import PARTS
from tests.checkouts import HERE, assert_licensed, run, tree
from tests.cli.command import EXAMPLE
from tests.cli.command import run as eddi
from tests.interpreters import old_python

pytestmark = pytest.mark.slow

PROGRAM = """
from types import SimpleNamespace
from consertb.EDDIInput import EDDIInput
from consertb.EDDIMonitor import EDDIMonitor
import eddi_runtime

monitor = EDDIMonitor()
assert monitor.execute_step(EDDIInput()) == [{"id": "System_A_G0_c2", "active": False}]
output = monitor.execute_step(SimpleNamespace(RtE_A_E0=True))
assert output == [{"id": "System_A_G0_c2", "active": True}]
print(eddi_runtime.__file__)
"""


@dataclass(frozen=True)
class World:
    """An environment of its own with a monitor and the runtime, both installed from wheels."""

    wheels: Path
    site: Path
    python: Path
    package: Path


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    folder = tmp_path_factory.mktemp("runtime")
    skip = shutil.ignore_patterns("__pycache__")
    shutil.copytree(HERE / "runtime_lib", folder / "runtime_lib", ignore=skip)
    wheels = folder / "wheels"
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(wheels)]
    run([*build, "runtime_lib"], folder)

    words = ("--platform", "plain", "-o", folder / "monitors", "--runtime", "installed")
    model = ("-m", EXAMPLE / "two_conserts.xml", "--name", "ConSertB")
    done = eddi("generate", *words, *model, cwd=folder)
    assert done.status == 0, done.err
    package = folder / "monitors" / "consertb"
    before = tree(package)
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    wheel = ["wheel", "--no-deps", "--no-build-isolation", "-w", str(wheels), str(package)]
    run([*pip, *wheel], folder)
    assert tree(package, "build", "consertb.egg-info") == before

    run([sys.executable, "-m", "venv", "--without-pip", str(folder / "venv")], folder)
    python = folder / "venv" / "bin" / "python"
    install = ["--python", str(python), "install", "--no-index", "--find-links", str(wheels)]
    run([*pip, *install, "consertb"], folder)  # brings the runtime: it says that it needs it
    (site,) = (folder / "venv").glob("lib/python*/site-packages")
    installed = {path.name for path in (site / "consertb").iterdir()}
    assert not {"test", ".eddi", "build"} & installed, installed
    return World(wheels, site, python, package)


def test_the_wheel_has_all_parts_and_needs_nothing(world: World) -> None:
    (wheel,) = world.wheels.glob("eddi_runtime-*.whl")
    assert wheel.name == f"eddi_runtime-{__version__}-py3-none-any.whl"
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.partition("/")[0] for name in names} == {
        "eddi_runtime",
        f"eddi_runtime-{__version__}.dist-info",
    }
    assert "eddi_runtime/py.typed" in names
    assert_licensed(world.wheels, "eddi_runtime")
    assert all({f"eddi_runtime/{p}.py", f"eddi_runtime/{p}/__init__.py"} & {*names} for p in PARTS)
    about = metadata.Distribution.at(next(world.site.glob("eddi_runtime-*.dist-info")))
    assert about.metadata["Requires-Python"] == ">=3.8"
    assert about.requires == ["numpy<3,>=1.17; extra == 'numpy'"]


def test_a_monitor_runs_on_it(world: World, tmp_path: Path) -> None:
    alone = {"PYTHONPATH": ""}
    found = run([str(world.python), "-c", PROGRAM], tmp_path, alone).stdout
    assert Path(found).is_relative_to(world.site)
    tests = ["-m", "unittest", "discover", "-s", "test"]
    run([str(world.python), "-B", *tests], world.package, alone)


def test_the_oldest_python_runs_it(world: World, tmp_path: Path) -> None:
    env = {"PYTHONPATH": str(world.site), "PYTHONDONTWRITEBYTECODE": "1"}
    run([old_python(), "-c", PROGRAM], tmp_path, env)


@pytest.mark.parametrize("found", ["none", "0.0.9"])
def test_without_it_the_package_says_what_to_run(world: World, tmp_path: Path, found: str) -> None:
    for name in ("consertb", *(["eddi_runtime"] if found != "none" else [])):
        skip = shutil.ignore_patterns("__pycache__")  # its text would be of the same second
        shutil.copytree(world.site / name, tmp_path / name, ignore=skip)
    if found != "none":
        version = tmp_path / "eddi_runtime" / "monitor.py"
        text = version.read_text("utf-8")
        assert text.count(__version__) == 1
        version.write_text(text.replace(__version__, found), "utf-8")
    command = [sys.executable, "-I", "-S", "-c", f"import sys; sys.path[:0] = [{str(tmp_path)!r}]"]
    command[-1] += "; import consertb.EDDIMonitor"
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        f"ImportError: consertb needs eddi-runtime {__version__} or newer, found: {found}; run "
        f'`python3 -m pip install --upgrade "eddi-runtime>={__version__}"`'
    )
