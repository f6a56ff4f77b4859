"""Files that tests read: our own oracles, and other people's models where this machine has them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from inspect import signature
from pathlib import Path

import pytest
import yaml

ORACLES = Path(__file__).parent / "data" / "oracles"
FOREIGN = Path(os.environ.get("EDDI_FOREIGN_DATA", Path(__file__).parents[2] / "shared" / "data"))
"""Other people's models, which are not part of the project; see ``left_out``."""

ABSENT = "other people's models are not on this machine"


def data_file(name: str) -> Path:
    """Return the path of an oracle or of a foreign file, or skip the test where that is absent."""
    path = ORACLES / name
    if path.exists():
        return path
    if not (FOREIGN / name).exists():
        pytest.skip(f"{ABSENT}: {name}")
    return FOREIGN / name


def data_text(name: str) -> str:
    """Return a text that tests write: a model, a configuration, an old file, what is expected."""
    return (Path(__file__).parent / "data" / "texts" / name).read_bytes().decode()


def write_files(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    """Put files into a folder, which may be a new one, and return it."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return folder


def tabled(test: Callable[..., None]) -> Callable[..., None]:
    """Run a test for each row under its name in the YAML file beside it: its first parameters."""
    file = Path(test.__code__.co_filename).with_suffix(".yml")
    tables = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
    table = tables[test.__name__.removeprefix("test_")]
    rows = [row if isinstance(row, list) else [row] for row in table]
    return pytest.mark.parametrize([*signature(test).parameters][: len(rows[0])], rows)(test)


def left_out(reasons: list[str]) -> str | None:
    """Return the line that a run ends with where tests were skipped for want of foreign files."""
    count = sum(ABSENT in reason for reason in reasons)
    return f"{count} tests left out: {ABSENT} ({FOREIGN})" if count else None
