"""The trace table: each element of the model, where it stands, and what it became."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from tests.cli.command import EXAMPLE, ROOT, run

GENERATED = EXAMPLE / "expected"


def test_the_json_and_the_text() -> None:
    printed = json.loads(run("trace", "-w", GENERATED, "--json", cwd=EXAMPLE).out)["packages"]
    assert [of["package"] for of in printed] == ["conserta", "consertb"]
    assert all(len(of["sha256"]) == 64 for of in printed)
    assert set(printed[0]["elements"][0]) == {
        *("element", "id", "file", "line", "path", "code", "topics", "links")
    }
    text = run("trace", "conserta", cwd=GENERATED / "src/eddi_monitor").out
    assert text.splitlines()[0] == "conserta: consert ConSertA"
    assert "two_conserts.xml:30" in text


def test_damaged_answers_are_no_traceback(tmp_path: Path) -> None:
    package = tmp_path / "conserta"
    shutil.copytree(GENERATED / "src" / "eddi_monitor" / "conserta", package)
    answers = package / ".copier-answers.yml"
    answers.write_text(answers.read_text("utf-8").replace("topic_text:", "topic_txt:"), "utf-8")
    result = run("trace", package, cwd=tmp_path)
    assert result.status == 2, result.err
    assert "the answers of the package are damaged: KeyError('topic_text') [T005]" in result.err


def test_what_the_configuration_says_has_no_place_in_the_model(tmp_path: Path) -> None:
    robot = ROOT / "examples" / "warehouse-robot"
    words = ("-c", robot / "robot.yml", "--name", "localisation")
    run("-q", "generate", "--platform", "plain", "-o", ".", *words, cwd=tmp_path)
    text = run("trace", "localisation", cwd=tmp_path).out
    assert re.search(r"\n  threshold +PoseIsGood +\(configuration\)\n", text)
    assert ":-" not in text
    drone = run("trace", "-w", ROOT / "examples" / "drone" / "expected", cwd=tmp_path).out
    assert re.search(r"\n  threshold +RtE_continue +\(configuration\)\n", drone)
