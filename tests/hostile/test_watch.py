"""The watch sees what a command could change."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.hostile.watch import changes, look

CHANGES = {
    "file": ("printf B >file; touch -d @1 file", "touch -d @2 file", "chmod 755 file"),
    "below": ("touch below/new && rm below/new",),
    "link": ("ln -sfn below link",),
    "below/pipe": ("mkfifo below/pipe",),
}


@pytest.mark.parametrize(
    ("name", "act"), [(name, act) for name in CHANGES for act in CHANGES[name]]
)
def test_every_change_is_seen(
    name: str, act: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    os.system("printf A >file; mkdir below; ln -s file link; touch -d @1 file below")
    before = look(tmp_path)
    assert changes(before, look(tmp_path)) == []
    os.system(act)
    assert name in changes(before, look(tmp_path))
