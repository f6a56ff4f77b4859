"""Whole generated packages, file by file; `pytest --update-golden` writes them anew.

Not compared: the copy of the runtime library, and where the templates lay.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.checkouts import HERE, tree, without_origin
from tests.cli.command import EXAMPLE, run
from tests.kinds.examples import EXAMPLES

pytestmark = pytest.mark.slow

WORKSPACE = HERE / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"
PLAIN = HERE / "tests" / "golden" / "plain"
DDS = HERE / "tests" / "golden" / "dds"
ROS2 = HERE / "tests" / "golden" / "ros2"
MODELS = HERE / "tests" / "golden" / "models"
RUNTIME = HERE / "runtime_lib" / "src" / "eddi_runtime"


def snapshot(folder: Path) -> dict[str, tuple[bool, bytes]]:
    """Read one package as it is compared."""
    files = {name: it for name, it in tree(folder).items() if not _is_copied(folder, name)}
    executable, manifest = files[".eddi/manifest"]
    files[".eddi/manifest"] = (executable, _stable(folder, manifest))
    answers = files[".copier-answers.yml"]
    files[".copier-answers.yml"] = (answers[0], without_origin(answers[1]))
    return files


def _is_copied(folder: Path, name: str) -> bool:
    """Return whether a file of a package is of the runtime library."""
    file = name.removeprefix("src/").removeprefix("eddi_runtime/")
    return folder.name == "eddi_runtime" and (RUNTIME / file).is_file()


def _stable(folder: Path, manifest: bytes) -> bytes:
    """Drop the digest of the whole, which knows the origin, and those of the runtime's files."""
    lines = manifest.decode().splitlines(keepends=True)
    names = ((line, line[17:].rstrip()) for line in lines)
    kept = (line for line, name in names if name != "*" and not _is_copied(folder, name))
    return "".join(kept).encode()


def compare(packages: Path, golden: Path, request: pytest.FixtureRequest) -> None:
    """Compare the packages of a folder, or make them the expected ones."""
    got = {
        folder.name: snapshot(folder) for folder in sorted(packages.iterdir()) if folder.is_dir()
    }
    if request.config.getoption("--update-golden"):
        shutil.rmtree(golden, ignore_errors=True)
        for package, files in got.items():
            for name, (executable, data) in files.items():
                path = golden / package / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
                path.chmod(0o755 if executable else 0o644)
    assert list(got) == sorted(folder.name for folder in golden.iterdir())
    for package, files in got.items():
        expected = tree(golden / package)
        hint = f"{package}: look at the change, then run pytest with --update-golden"
        assert sorted(files) == sorted(expected), hint
        for name, (executable, data) in files.items():
            got_text, wanted = (one.decode("utf-8", "replace") for one in (data, expected[name][1]))
            assert got_text == wanted, f"{name}: {hint}"
            assert data == expected[name][1], f"{name}: {hint}"
            assert executable == expected[name][0], f"{name} executable: {hint}"


def test_workspace_of_the_example(both: Path, request: pytest.FixtureRequest) -> None:
    compare(both, WORKSPACE, request)


SMALL = ("-m", EXAMPLE / "two_conserts.xml", "-c", EXAMPLE / "consert_b_config.yml")


def generate(folder: Path, *words: object) -> None:
    done = run("generate", *words, cwd=folder)
    assert done.status == 0, done.err


def test_dds_package(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    generate(tmp_path, "--platform", "dds", "-o", tmp_path, *SMALL)
    compare(tmp_path, DDS, request)


def test_ros2_packages(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    (tmp_path / "src").mkdir()
    generate(tmp_path, "--platform", "ros2", "-w", tmp_path, *SMALL)
    compare(tmp_path / "src" / "eddi_monitor", ROS2, request)


def test_plain_packages(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """One package of each kind; the ConSert is without a configuration."""
    plain = ("--platform", "plain", "-o")
    (tmp_path / "rover").mkdir()
    generate(tmp_path, *plain, tmp_path / "rover", "-m", MODELS / "rover.yml")
    compare(tmp_path / "rover", PLAIN, request)
    for model, config in (files for kind, files in EXAMPLES.items() if kind != "consert"):
        example = Path(model).parent
        files = ("-m", HERE / "examples" / model, "-c", HERE / "examples" / config)
        (tmp_path / example).mkdir()
        generate(tmp_path, *plain, tmp_path / example, *files)
        compare(tmp_path / example, HERE / "examples" / example / "expected", request)
