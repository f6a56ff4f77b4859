"""What a person gets who generates the cart of the README: few files, few lines."""

from __future__ import annotations

from pathlib import Path

from tests.cli.command import ROOT, run

START = ROOT / "copier_templates" / "start"
MOST_FILES, MOST_LINES = 13, 350


def test_the_package_of_the_cart_is_small(tmp_path: Path) -> None:
    """Not counted are its tests and the text of its model."""
    (tmp_path / "src").mkdir()
    words = ("generate", "-w", tmp_path, "-c", START / "cart_config.yml")
    assert run(*words, cwd=tmp_path).status == 0
    package = tmp_path / "src/eddi_monitor/cart"
    paths = (path.relative_to(package) for path in package.rglob("*") if path.is_file())
    files = [path for path in paths if path.parts[0] != "test" and path.parts[0] != "config"]
    assert len(files) <= MOST_FILES, sorted(files)
    lines = {path: len((package / path).read_bytes().splitlines()) for path in files}
    assert sum(lines.values()) <= MOST_LINES, lines
