"""``regions`` and ``status`` on packages that lost their records."""

from __future__ import annotations

import shutil
from pathlib import Path

from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.handwritten import inventory
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.platforms import platforms

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-conserts" / "two_conserts.xml"


def test_a_package_without_its_records_needs_a_look(tmp_path: Path) -> None:
    platform = platforms()["plain"]
    monitors, problems = monitors_of(EXAMPLE, [], "ConSertB")
    packages = assemble(monitors, platform, tmp_path, problems).packages
    write_packages(tmp_path, packages, own_template())
    assert {entry.status.review for entry in inventory(tmp_path)} == {False}
    shutil.rmtree(tmp_path / "consertb" / ".eddi")
    (entry,) = inventory(tmp_path)
    assert (entry.status.state, entry.status.review) == ("broken", True)
    assert entry.file == str(tmp_path / "consertb" / ".eddi")
