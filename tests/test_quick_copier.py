"""The Copier of our tests writes what Copier writes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.command import files_below, template
from tests.fuzz.test_answers_are_data import sound

pytestmark = pytest.mark.slow
_STAGE = re.compile(r"new/[0-9-]+/")
"""The folder of one rendering, which has another name each time."""
_COPIER = """
import json, sys, copier
place, quick, folder, packages = sys.argv[1], sys.argv[2] == "quick", sys.argv[3], sys.argv[4]
more = {"defaults": True, "unsafe": True, "quiet": True, "skip_tasks": True}
if quick:
    from tests.quick_copier import render_faster
    render_faster()
for turn in ("first", "")[not quick:]:  # the second finds everything done already
    for name, answers in json.load(open(packages)).items():
        copier.run_copy(place, f"{folder}{turn}/{name}", answers, **more)
"""


def test_the_same_files(tmp_path: Path) -> None:
    packages = {name: sound("network")[name] for name in ("eddi_messages", "eddi_monitor_launcher")}
    packages |= sound("plain")
    data = tmp_path / "packages.json"
    data.write_text(json.dumps(packages), encoding="utf-8")
    made = []
    for which in ("quick", "own"):
        words = [template().location, which, str(tmp_path / which), str(data)]
        subprocess.run([sys.executable, "-c", _COPIER, *words], check=True)
        files = files_below(tmp_path / which)
        made.append({_STAGE.sub("new/", name): text for name, text in files.items()})
    assert len(made[0]) > 20
    assert made[0] == made[1]
