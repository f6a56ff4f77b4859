"""A report of a whole robot: what is deleted or changed turns exactly its rows."""

from __future__ import annotations

import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from tests.cli.command import ROOT, run

ROBOT = ROOT / "examples" / "warehouse-robot"
VOID = {"meta", "br", "path", "rect", "ellipse", "polygon", "line", "circle"}

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("robot")
    shutil.copytree(ROBOT, place, dirs_exist_ok=True)
    words = ("generate", "--platform", "plain", "-o", "monitors", "-c", "robot.yml")
    assert run("-q", *words, cwd=place).status == 0
    faults = run(
        "inject", "robot.yml", "--inputs", "faults.csv", "--phases", "1", "--json", cwd=place
    )
    (place / "faults.json").write_text(faults.out, "utf-8")
    return place


@pytest.fixture
def robot(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "robot"))


def report(robot: Path, status: int = 1) -> dict[str, str]:
    """Write a report; return the state of each item by its id."""
    words = ("report", "-o", "monitors", "-m", "hazards.xml", "--inject", "faults.json")
    result = run(*words, cwd=robot)
    assert result.status == status, result.err
    needs = json.loads((robot / "report" / "needs.json").read_text("utf-8"))
    return {id_: of["status"] for id_, of in needs["versions"]["1.0"]["needs"].items()}


class _Page(HTMLParser):
    """Checks that elements are closed, and collects what a browser would load."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: set[str] = set()
        self.links: set[str] = set()
        self.loaded: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open += [] if tag in VOID else [tag]
        named: dict[str, Any] = dict(attrs)
        self.ids |= {named["id"]} & {*named.values()} if "id" in named else set()
        self.links |= {named["href"]} if "href" in named else set()
        self.loaded |= {of for name, of in named.items() if name in ("src", "data", "srcset")}

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag


def test_the_page_needs_nothing_else(robot: Path) -> None:
    states = report(robot)
    text = (robot / "report" / "report.html").read_text("utf-8")
    parsed = _Page()
    parsed.feed(text)
    assert parsed.open == []
    assert parsed.loaded == set()
    assert {link.removeprefix("#") for link in parsed.links} <= parsed.ids
    assert "<script" not in text
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org/)", text)
    assert len(text) < 100_000
    assert states["HAZARD_HITSPERSON"] == "linked, proved, tested, in time"
    assert states["HAZARD_LOSESLOAD"] == "unlinked"
    assert states["GUARANTEE_WAREHOUSE_FULLSPEED"].startswith("proved, tested")


def test_the_same_inputs_give_the_same_files(robot: Path) -> None:
    report(robot)
    before = {path.name: path.read_bytes() for path in (robot / "report").iterdir()}
    report(robot)
    assert before == {path.name: path.read_bytes() for path in (robot / "report").iterdir()}
    assert {*before} == {
        *("report.html", "needs.json", "conf.py", "case.reqif"),
        *("case.gsn.yaml", "case.sacm.xml", "junit.xml"),
    }


def changed(robot: Path) -> dict[str, tuple[str, str]]:
    """Return the items whose state is not that of the untouched robot."""
    untouched = ROW_STATES.setdefault("states", {})
    now = report(robot)
    ids = untouched.keys() | now.keys()
    return {
        id_: (untouched.get(id_, ""), now.get(id_, ""))
        for id_ in ids
        if untouched.get(id_) != now.get(id_)
    }


ROW_STATES: dict[str, dict[str, str]] = {}


def test_what_is_gone_turns_its_rows(robot: Path) -> None:
    ROW_STATES["states"] = report(robot)
    hazards = robot / "hazards.xml"
    text = hazards.read_text("utf-8")
    # a link: only the hazard and the goal that have it through the measure
    hazards.write_text(text.replace("warehouse/FullSpeed", "warehouse/StandStill", 1), "utf-8")
    turned = changed(robot)
    assert {*turned} == {"HAZARD_HITSPERSON", "REQUIREMENT_SLOWWHENBLIND"} | {
        id_ for id_ in turned if "STANDSTILL" in id_
    }
    hazards.write_text(text, "utf-8")
    # a test: the vectors of the power are not those of its model
    vectors = robot / "monitors" / "power" / "test" / "vectors.json"
    kept = vectors.read_bytes()
    vectors.write_bytes(kept.replace(b"true", b"false", 1))
    turned = changed(robot)
    assert turned["TESTCASE_POWER_VECTORS"][1] == "failed"
    assert "tested" not in turned["HAZARD_HITSPERSON"][1]
    assert "TESTCASE_LIDAR_VECTORS" not in turned
    vectors.write_bytes(kept)
    # a line of the compiled text: that monitor differs, nothing else does
    compiled = robot / "monitors" / "lidar" / "compiled.py"
    compiled.write_text(compiled.read_text("utf-8").replace("1.5", "1.4"), "utf-8")
    turned = changed(robot)
    assert turned["TESTCASE_LIDAR_VECTORS"][1] in ("differs", "not proved")
    assert turned["HAZARD_HITSPERSON"][1] == "linked, stale"
    assert "TESTCASE_POWER_VECTORS" not in turned


def test_a_monitor_that_is_gone_leaves_its_hazards_without_a_proof(robot: Path) -> None:
    shutil.rmtree(robot / "monitors" / "warehouse")
    states = report(robot)
    assert states["HAZARD_HITSPERSON"] == "unlinked"
    assert not any("WAREHOUSE" in id_ for id_ in states)


def test_a_file_of_something_else_is_refused(robot: Path) -> None:
    (robot / "faults.json").write_text('{"rows": [{"monitor": "lidar"}], "monitors": []}')
    words = ("report", "-o", "monitors", "--inject", "faults.json")
    result = run(*words, cwd=robot)
    assert result.status == 2
    assert "this is no result of injected faults" in result.err
    assert not (robot / "report").exists()


def test_names_of_a_model_are_text(robot: Path) -> None:
    hazards = robot / "hazards.xml"
    name = "&lt;script&gt;alert(1)&lt;/script&gt; {{ 7*7 }} &quot; onload=&quot;x"
    text = hazards.read_text("utf-8").replace('name="LosesLoad"', f'name="{name}"')
    hazards.write_text(text, "utf-8")
    states = report(robot)
    page = (robot / "report" / "report.html").read_text("utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; {{ 7*7 }}" in page
    assert not re.search(r"<[^>]* onload=", page)
    assert states["HAZARD_SCRIPT_ALERT_1_SCRIPT_7_7_ONLOAD_X"] == "unlinked"
