"""The public surface: what programs and generated packages may import, and that it works."""

from __future__ import annotations

import importlib
import re
import runpy
import shutil
from pathlib import Path
from typing import Any

import eddi_runtime
import pytest

from eddi_scaffold import api
from tests.checkouts import HERE

EXAMPLE = HERE / "examples" / "two-conserts"
MODEL, CONFIG = EXAMPLE / "two_conserts.xml", EXAMPLE / "consert_a_config.yml"
SCRIPT: dict[str, Any] = runpy.run_path(str(HERE / "script" / "reference.py"))
RUNTIME = HERE / "runtime_lib" / "src" / "eddi_runtime"
ONLY_IN_ROS = {
    "eddi_runtime.transports.ros1": "transports/ros1/__init__.py",
    "eddi_runtime.transports.ros2": "transports/ros2/__init__.py",
    "eddi_runtime.transports.ros2.lifecycle": "transports/ros2/lifecycle.py",
}
"""Modules that cannot be imported elsewhere -> their files."""
IMPORT = re.compile(r"^\s*from (eddi_runtime[\w.]*) import ([\w, ]+)", re.MULTILINE)


def test_what_is_public() -> None:
    """A change here is a change of the interface: the CHANGELOG must have it."""
    assert sorted(api.__all__) == [
        *("EddiError", "Model", "Place", "Problem", "ReadResult", "WriteResult"),
        *("check", "generate", "load", "run"),
    ]
    assert sorted(eddi_runtime.__all__) == [
        *("EDDIInputBase", "FORMAT", "InputSpec", "InputState", "ModelError", "Monitor"),
        *("__version__", "by_id", "by_key", "by_name", "given", "joined", "look_again", "needs"),
    ]
    assert all(hasattr(api, name) for name in api.__all__)
    assert all(hasattr(eddi_runtime, name) for name in eddi_runtime.__all__)


def test_templates_import_what_is_public() -> None:
    found = {
        (module, name.strip().partition(" ")[0])
        for path in (HERE / "copier_templates").rglob("*.jinja")
        for module, names in IMPORT.findall(path.read_text("utf-8"))
        for name in names.split(",")
    }
    assert ("eddi_runtime.transports.ros1", "reported") in found
    for module, name in found - {("eddi_runtime.transports.ros1.host", "Host")}:
        if module in ONLY_IN_ROS:
            text = (RUNTIME / ONLY_IN_ROS[module]).read_text("utf-8")
            assert f'"{name}"' in text or f"class {name}(" in text
        else:
            assert hasattr(importlib.import_module(module), name)


def test_both_packages_are_typed() -> None:
    for package in (HERE / "eddi_scaffold", HERE / "runtime_lib" / "src" / "eddi_runtime"):
        assert (package / "py.typed").is_file()


def test_load_and_check() -> None:
    reading = api.load(MODEL)
    assert [model.name for model in reading.models] == ["ConSertA", "ConSertB"]
    assert not [problem for problem in api.check([MODEL, CONFIG]) if problem.level == "error"]
    with pytest.raises(api.EddiError) as refused:
        api.load(EXAMPLE / "nothing.xml")
    assert [problem.code for problem in refused.value.problems] == ["F001"]


def test_generate_and_run(tmp_path: Path) -> None:
    outcome = api.generate(tmp_path, MODEL, [CONFIG], "plain", dry_run=True)
    assert not any(tmp_path.iterdir())
    outcome = api.generate(tmp_path, MODEL, [CONFIG], "plain")
    assert (tmp_path / "conserta" / "EDDIInput.py").read_bytes()
    assert "conserta/EDDIInput.py" in outcome.changes
    again = api.generate(tmp_path, MODEL, [CONFIG], "plain")
    assert (dict(again.changes), again.attention) == ({}, False)
    rows = list(api.run(EXAMPLE / "recording.csv", MODEL, CONFIG))
    assert rows[0]["t"] == 0.0
    assert {"t", "outputs"} <= set(rows[0])


def test_files_may_be_texts_and_one_file_alone(tmp_path: Path) -> None:
    assert api.load(str(MODEL)).models == api.load(MODEL).models
    for one in (MODEL, str(MODEL), iter([MODEL])):
        assert api.check(one) == api.check([MODEL])
    for number, config in enumerate((CONFIG, str(CONFIG), [str(CONFIG)])):
        folder = tmp_path / str(number)
        assert api.generate(str(folder), str(MODEL), config, "plain").changes
        assert (folder / "conserta" / "EDDIInput.py").is_file()
    words = (EXAMPLE / "recording.csv", MODEL, CONFIG)
    assert list(api.run(*map(str, words))) == list(api.run(*words))


def test_generate_needs_a_workspace(tmp_path: Path) -> None:
    sources = tmp_path / "src"
    sources.mkdir()
    for folder in (tmp_path / "nowhere", sources):
        with pytest.raises(api.EddiError) as refused:
            api.generate(folder, MODEL, [CONFIG])
        assert [problem.code for problem in refused.value.problems] == ["G007"]
    assert [*tmp_path.rglob("*")] == [sources]


@pytest.mark.parametrize(
    ("files", "rows", "code"),
    [
        ((), "0,true,true", "G015"),
        ((MODEL,), "0,true,true", "G005"),
        ((MODEL, CONFIG), "0,true,true\n1700000000,true,true", "I019"),  # nobody waits for this
    ],
)
def test_what_cannot_be_run(files: tuple[Path, ...], rows: str, code: str, tmp_path: Path) -> None:
    recording = tmp_path / "recording.csv"
    recording.write_text(f"t,RtE_A_D0,RtE_A_E0\n{rows}\n", "utf-8")
    with pytest.raises(api.EddiError) as refused:
        next(api.run(recording, *files))
    assert [problem.code for problem in refused.value.problems] == [code]


def test_the_reference_is_up_to_date() -> None:
    page = (HERE / "docs" / "reference" / "python.md").read_text("utf-8")
    assert page == SCRIPT["document"]()
    assert not re.findall(r"(?m)^#+ (.+)\n\n```python\n(?:.+\n)+```\n\n+(?:#|\Z)", page)


def test_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (HERE / "docs" / "how-to" / "python.md").read_text("utf-8")
    (program,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    shutil.copytree(EXAMPLE, tmp_path / "demo")
    (tmp_path / "demo" / "monitors").mkdir()
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "docs/how-to/python.md", "exec"), {})
    assert (tmp_path / "demo" / "monitors" / "conserta" / "README.md").is_file()
