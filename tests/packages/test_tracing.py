"""The trace table: each element of the model, where it stands, and what it became."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
from pathlib import Path

from tests.cli.command import EXAMPLE, ROOT, run
from tests.package_texts import facts_in

GENERATED = EXAMPLE / "expected"


def test_every_element_is_in_the_table_with_its_place() -> None:
    printed = run("trace", "-w", GENERATED, "--json", cwd=EXAMPLE).out
    conserta, consertb = json.loads(printed)["packages"]
    assert (conserta["package"], consertb["package"]) == ("conserta", "consertb")
    rows = {row["id"]: row for row in conserta["elements"]}
    assert list(rows) == [
        *("RtE_A_D0", "RtE_A_E0", "System_A_AND"),
        *("System_A_G0", "System_A_G1", "ServiceA", "ServiceB"),
    ]
    lines = (EXAMPLE / "two_conserts.xml").read_text("utf-8").splitlines()
    for name in ("RtE_A_D0", "RtE_A_E0", "System_A_AND", "System_A_G1"):
        assert f'"{name}"' in lines[rows[name]["line"] - 1]
        assert rows[name]["path"].startswith("//@odeProductPackages.0/@conSerts.0/@")
    assert rows["RtE_A_E0"]["code"] == "EDDIInput.process_RtE_A_E0"
    assert rows["RtE_A_E0"]["topics"] == "/rte/e0a"
    assert rows["System_A_G0"]["element"] == "guarantee"
    facts = facts_in(GENERATED / "src/eddi_monitor/conserta")
    assert (conserta["sha256"], conserta["model_sha256"]) == (facts.file_sha256, facts.digest)
    assert conserta["outputs"] == ["conserta/guarantees"]


def test_the_csv_and_the_text() -> None:
    printed = run("trace", "-w", GENERATED, "--csv", cwd=EXAMPLE).out
    table = list(csv.DictReader(io.StringIO(printed)))
    assert {row["package"] for row in table} == {"conserta", "consertb"}
    assert all(len(row["sha256"]) == 64 for row in table)
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


def test_monitors_of_every_kind_have_their_elements_with_their_places(tmp_path: Path) -> None:
    robot = ROOT / "examples" / "warehouse-robot"
    configs = [word for path in sorted(robot.glob("*_config.yml")) for word in ("-c", path)]
    run("-q", "generate", "--platform", "plain", "-o", ".", *configs, cwd=tmp_path)
    tables = json.loads(run("trace", "-w", ".", "--json", cwd=tmp_path).out)["packages"]
    found = {
        table["kind"]: [
            " ".join(map(str, (row["element"], row["id"], row["file"], row["line"], row["topics"])))
            for row in table["elements"]
        ]
        for table in tables
    }
    assert found["event"] == [
        "event PathClear lidar.events 5 ",
        "input nearest None None /lidar/nearest",
    ]
    assert found["safeml"] == [
        "reference reference_sample.csv detector.yml None ",
        "input frame None None /camera/features",
    ]
    assert found["reliability"] == [
        *("component battery power.yml 5 ", "component drives power.yml 6 "),
        *("component power power.yml 7 ", "threshold LastsTheShift power.yml None "),
        "input battery_level None None /battery/level",
        "input drives_available None None /drives/available",
    ]
    assert "threshold PoseIsGood None None " in found["bayesian_network"]
    text = run("trace", "localisation", cwd=tmp_path).out
    assert re.search(r"\n  threshold +PoseIsGood +\(configuration\)\n", text)
    assert ":-" not in text
    drone = run("trace", "-w", ROOT / "examples" / "drone" / "expected", cwd=tmp_path).out
    assert re.search(r"\n  threshold +RtE_continue +\(configuration\)\n", drone)
