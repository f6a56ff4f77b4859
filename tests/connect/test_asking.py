"""``connect --interactive`` on a real terminal: keys in, a configuration out."""

from __future__ import annotations

import os
import pty
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from tests.cli.command import ROOT, run

TOPICS = """SimulatorOutputs:
- {id: speed, type: std_msgs.Float64, topic: /vehicle/speed}
- {id: distance, type: std_msgs.Float64, topic: /pedestrian/distance}
"""
ENTER = "\r"


def answered(keys: list[tuple[str, str]], *words: str, cwd: Path) -> int:
    """Run a command on a terminal; type each text when what is before it has appeared."""
    ours, theirs = pty.openpty()
    environment = {
        **os.environ,
        "TERM": "xterm",
        "PYTHONPATH": str(ROOT),
        "PROMPT_TOOLKIT_NO_CPR": "1",
    }
    command = [sys.executable, "-m", "eddi_scaffold", *words]
    process = subprocess.Popen(
        command, cwd=cwd, env=environment, stdin=theirs, stdout=theirs, stderr=theirs
    )
    os.close(theirs)
    timer = threading.Timer(30, process.kill)
    timer.start()
    seen = ""
    try:
        while True:
            seen += os.read(ours, 4096).decode("utf-8", "replace")
            if keys and keys[0][0] in seen:
                _, text = keys.pop(0)
                os.write(ours, text.encode())
                seen = ""
    except OSError:  # the other end is closed
        pass
    finally:
        timer.cancel()
        os.close(ours)
    assert not keys, seen
    return process.wait()


@pytest.mark.slow
def test_answers_are_written_as_if_typed(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "pedestrian", tmp_path, dirs_exist_ok=True)
    config = tmp_path / "draft.yml"
    config.write_text(TOPICS, "utf-8")
    keys = [
        ("AV_Shuttle_Speed (float) is", ENTER),
        ("max_age of AV_Shuttle_Speed", f"0.5{ENTER}"),
        ("max_age of Distance_to_Pedestrian", ENTER),
    ]
    words = ("connect", "pedestrian.xml", "-o", "draft.yml", "--interactive")
    assert answered(keys, *words, cwd=tmp_path) == 0
    text = config.read_text("utf-8")
    assert TOPICS in text
    assert (
        "  - id: AV_Shuttle_Speed\n    requires: [speed]\n    field: data\n    max_age: 0.5\n"
        in text
    )
    assert "    max_age: TODO  # TODO seconds: no rate of /pedestrian/distance is known\n" in text
    assert run(*words[:-1], cwd=tmp_path).err.endswith("draft.yml is up to date\n")


@pytest.mark.parametrize("words", [(), ("-o", "draft.yml")])
def test_nothing_asks_without_a_terminal(words: tuple[str, ...], tmp_path: Path) -> None:
    shutil.copy(ROOT / "examples" / "pedestrian" / "pedestrian.xml", tmp_path)
    failed = run("connect", "pedestrian.xml", "--interactive", *words, cwd=tmp_path)
    assert (failed.status, "--interactive" in failed.err) == (2, True)
    assert [path.name for path in tmp_path.iterdir()] == ["pedestrian.xml"]
