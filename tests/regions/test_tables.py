"""Files of numbers, which Copier does not render."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from eddi_scaffold.regions.__main__ import main, place_files

DATA = b"numbers"
TABLES = {"src/own/reference.bin": hashlib.sha256(DATA).hexdigest()}
STAGE = ".eddi/new/1-2"


def test_tables_are_taken_from_their_folder(tmp_path: Path) -> None:
    root, rendering, folder = tmp_path / "own", tmp_path / "own" / STAGE, tmp_path / "folder"
    (rendering / "src/own").mkdir(parents=True)
    folder.mkdir()
    table = rendering / "src/own/reference.bin"
    assert [*place_files(root, rendering, TABLES, None)] == [*TABLES]
    (folder / "reference.bin").write_bytes(b"another one")
    assert [*place_files(root, rendering, TABLES, folder)] == [*TABLES]
    assert not table.exists()
    (folder / "reference.bin").write_bytes(DATA)
    assert [*place_files(root, rendering, TABLES, folder)] == []
    assert table.read_bytes() == DATA
    (root / "src/own").mkdir(parents=True)
    table.rename(root / "src/own/reference.bin")
    assert [*place_files(root, rendering, TABLES, None)] == [], "so is that of the package"
    assert table.exists()
    for name in ("../reference.bin", f"{folder}/reference.bin", ".."):
        assert [*place_files(root, rendering, {name: TABLES["src/own/reference.bin"]}, folder)]


def test_the_command_names_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / STAGE).mkdir(parents=True)
    (tmp_path / STAGE / "a.txt").write_text("text")
    assert main(["sync", str(tmp_path), "1-2", json.dumps(TABLES), ""]) == 2
    assert not (tmp_path / "a.txt").exists(), "nothing is half a package"
    error = capsys.readouterr().err
    assert error.startswith("error: src/own/reference.bin is not there: give its folder"), error
