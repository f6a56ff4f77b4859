"""One workspace for all tests of what is generated."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, run


@pytest.fixture(scope="session")
def both(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with both monitors of the example, generated at once."""
    return generate(tmp_path_factory.mktemp("both"), "a", "b")


def generate(workspace: Path, *letters: str) -> Path:
    """Generate monitors of the example and return the folder of their packages."""
    (workspace / "src").mkdir(exist_ok=True)
    configs = [word for one in letters for word in ("-c", EXAMPLE / f"consert_{one}_config.yml")]
    words = ("-w", workspace, "-m", EXAMPLE / "two_conserts.xml", *configs)
    done = run("generate", *words, cwd=workspace)
    assert done.status == 0, done.err
    return workspace / "src" / "eddi_monitor"
