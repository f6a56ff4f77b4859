"""A workspace that a file of tests generates once; each test works on a copy."""

import shutil
from pathlib import Path

import pytest


@pytest.fixture
def folder(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "clone"))
