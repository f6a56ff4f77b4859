"""The Copier of our tests writes what Copier writes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import copier
import pytest

from tests.cli.command import files_below, template
from tests.fuzz.test_answers_are_data import sound

pytestmark = pytest.mark.slow
_STAGE = re.compile(r"new/[0-9-]+/")
"""The folder of one rendering, which has another name each time."""


@pytest.mark.parametrize("which", ["network", "plain"])
def test_the_same_files(which: str, tmp_path: Path) -> None:
    place = template().location
    for name, answers in sound(which).items():
        data = tmp_path / f"{name}.yml"
        data.write_text(json.dumps(answers), encoding="utf-8")
        for folder in ("first", "quick"):  # the second finds everything done already
            into = tmp_path / folder / name
            copier.run_copy(
                place, into, data=answers, defaults=True, unsafe=True, quiet=True, skip_tasks=True
            )
        words = ["copy", "--trust", "--skip-tasks", "--defaults", "--quiet", "--data-file"]
        command = [sys.executable, "-m", "copier", *words, data, place, tmp_path / "own" / name]
        subprocess.run(command, check=True)
    found, own = (
        {_STAGE.sub("new/", name): data for name, data in files_below(tmp_path / which).items()}
        for which in ("quick", "own")
    )
    assert len(found) > 20
    assert found == own
