"""One checkout and one workspace for all tests of what is generated."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.checkouts import Checkout, checkout


@pytest.fixture(scope="session")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """A clean, untagged checkout."""
    return checkout(tmp_path_factory.mktemp("clone") / "eddi-scaffold")


@pytest.fixture(scope="session")
def both(clone: Checkout, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with both monitors of the example, generated at once."""
    return generate(clone, tmp_path_factory.mktemp("both"), "a", "b")


def generate(clone: Checkout, workspace: Path, *letters: str, status: int = 0) -> Path:
    """Generate monitors of the example and return the folder of their packages."""
    (workspace / "src").mkdir(exist_ok=True)
    configs = [
        word
        for letter in letters
        for word in ("-c", clone.example / f"consert_{letter}_config.yml")
    ]
    model = clone.example / "two_conserts.xml"
    clone.eddi("-q", "generate", "-w", workspace, "-m", model, *configs, status=status)
    return workspace / "src" / "eddi_monitor"
