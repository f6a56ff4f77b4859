"""From the hazards of an EDDI to guarantees: what is linked and known, and what is missing."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.deployments.hazards import HazardRow, HazardTrace, Verification
from eddi_scaffold.deployments.support import WiredMonitor
from eddi_scaffold.deployments.wiring import members_of
from eddi_scaffold.eddi_xml.hazard_analysis import HazardAnalysis
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.assembly import monitors_of
from tests.cli.command import ROOT, run
from tests.data_files import tabled

ROBOT = ROOT / "examples" / "warehouse-robot"
EDDI = (ROBOT / "hazards.xml").read_text("utf-8")
LANDING = ROOT / "tests" / "eddi_xml" / "models" / "landing.xml"
CHAIN = ("warehouse", "lidar", "localisation", "people", "power")


@cache
def monitors() -> list[WiredMonitor]:
    return members_of(monitors_of(None, [ROBOT / "robot.yml"])[0])


def analysis(text: str) -> HazardAnalysis:
    read = read_models(Source("hazards.xml", text.encode())).hazards
    assert read is not None
    return read


def found(text: str) -> list[str]:
    """Return line, code and message of each problem."""
    problems = HazardTrace(analysis(text), monitors()).check()
    return [f"{p.place.line} {p.level} {p.code} {p.message}" for p in problems]


def row(name: str, text: str = EDDI, **verified: Verification) -> HazardRow:
    rows = HazardTrace(analysis(text), monitors(), verified=verified).rows.values()
    return next(row for row in rows if row.item.name == name)


def test_of_five_hazards_three_are_not_linked() -> None:
    assert [text[:12] for text in found(EDDI)] == ["9 error J001", "10 error J00", "11 error J00"]


@tabled
def test_check(old: str, new: str, expected: list[str]) -> None:
    assert old in EDDI
    reported = [text for text in found(EDDI.replace(old, new)) if text not in found(EDDI)]
    assert len(reported) == len(expected)
    for text, pattern in zip(reported, expected, strict=True):
        assert re.fullmatch(pattern, text), text


def test_without_a_guarantee_its_hazards_are_not_linked() -> None:
    """The model has lost it: names of the EDDI are checked."""
    warehouse = next(of for of in monitors() if of.name == "warehouse")
    elements = tuple(of for of in warehouse.facts.elements if of.id != "FullSpeed")
    less = replace(warehouse, facts=replace(warehouse.facts, elements=elements))
    others = [of for of in monitors() if of is not warehouse]
    problems = [*HazardTrace(analysis(EDDI), [*others, less]).check()]
    assert [p.place.line for p in problems if p.code == "J001"] == [7, 9, 10, 11]
    assert {p.message for p in problems if p.code == "J005"} == {
        "guarantee: there is no 'warehouse/FullSpeed'"
    }


def test_what_was_stated_is_in_the_row() -> None:
    hazard = row("HitsPerson")
    assert hazard.item.risks == ("severity S2", "likelihood E4", "controlability C2")
    assert hazard.item.malfunctions == ("DrivesTooFast",)
    assert [of.name for of in hazard.parts] == ["SlowWhenBlind", "SlowsDown"]
    times = row("SlowWhenBlind").item.times
    assert times == {"failureDetectionTime": 2.5, "failureReactionTime": 0.5}


def test_the_chain_reaches_every_source_of_the_robot() -> None:
    support = row("HitsPerson").support
    assert [of.package for of in support] == [*CHAIN]
    ends = {topic for of in support for input_ in of.inputs for topic in input_.topics}
    assert ends >= {"/lidar/nearest", "/wheels/slip", "/camera/features", "/battery/level"}
    assert support[0].inputs[0].method == "EDDIInput.process_PathClear"
    assert support[0].inputs[0].claims == ("lidar.PathClear",)


@tabled
def test_states(verified: dict[str, Verification], expected: list[str]) -> None:
    known = {name: Verification(True, True) for name in CHAIN}
    known |= {name: Verification(**of) for name, of in verified.items()}
    assert row("HitsPerson", **known).states == tuple(expected)


def test_nothing_is_known_of_what_merely_exists() -> None:
    assert row("HitsPerson").states == ("linked", "in time")
    assert row("LosesLoad").states == ("unlinked",)
    late = row("HitsPerson", EDDI.replace('"2500"', '"2199"'))
    assert late.states == ("linked",)
    assert late.worst is not None
    assert round(late.worst.seconds, 9) == 2.2
    proved = {name: Verification(True, True) for name in CHAIN}
    constant = row("HitsPerson", EDDI.replace("/FullSpeed", "/StandStill"), **proved)
    assert constant.states == ("linked",)


def test_a_monitor_that_is_gone_turns_the_rows_that_need_it() -> None:
    proved = {name: Verification(True, True) for name in CHAIN}
    eddi = EDDI.replace(
        '"warehouse/FullSpeed"/>\n        <v', '"warehouse/WalkingPace"/>\n        <v'
    )
    less = [of for of in monitors() if of.name != "people"]
    trace = HazardTrace(analysis(eddi), less, verified=proved)
    states = {of.item.name: of.states for of in trace.rows.values()}
    assert states["HitsPerson"] == ("linked",)
    assert states["HitsShelf"] == ("linked", "proved", "tested", "in time")
    assert [p.code for p in trace.check()] == ["J001", "J001", "J001", "J003"]


def test_refinements_are_followed_up_or_down() -> None:
    """And not from one goal by a common refinement to another one."""
    path = "//@odeProductPackages.0/@requirements"
    goals = "".join(
        f'<requirements name="{name}" isSafetyGoal="true" refinedRequirements="{path}.2"/>'
        for name in ("Stop", "Slow")
    )
    linked = (
        '<keyValueMaps key="eddi.mitigated_by"><values tag="guarantee" '
        'value="warehouse/FullSpeed"/></keyValueMaps></requirements>'
    )
    head, tail = (
        '<i:DDIPackage xmlns:i="i"><odeProductPackages>',
        "</odeProductPackages></i:DDIPackage>",
    )
    below = analysis(f'{head}{goals}<requirements name="See">{linked}{tail}')
    assert below.unlinked() == []
    assert [row.states for row in HazardTrace(below, monitors()).rows.values()] == [("linked",)] * 3
    above = goals.replace("/>", f">{linked}", 1)
    other = analysis(f'{head}{above}<requirements name="See"/>{tail}')
    assert [item.name for item in other.unlinked()] == ["Slow"]
    states = {of.item.name: of.states for of in HazardTrace(other, monitors()).rows.values()}
    assert states == {"Stop": ("linked",), "Slow": ("unlinked",), "See": ("linked",)}


def test_failures_and_traces_lead_to_observers_and_claims() -> None:
    path, case = "//@odeProductPackages", "//@assuranceCasePackages.0/@claims.0"
    eddi = (
        '<i:DDIPackage xmlns:i="i" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">'
        f'<odeProductPackages><hazards name="H" failures="{path}.1/@failureModels.0/@failures.0"/>'
        '</odeProductPackages><odeProductPackages xsi:type="f:FailureLogicPackage">'
        '<failureModels xsi:type="f:FaultTree" name="power"><failures name="F"><keyValueMaps '
        'key="eddi.monitored_by"><values tag="safeml" value="people"/></keyValueMaps></failures>'
        '</failureModels></odeProductPackages><assuranceCasePackages><claims gid="G1"/>'
        f'</assuranceCasePackages><traceabilityPackages><traces odeElement="{path}.0/@hazards.0" '
        f'sacmElement="{case}"/></traceabilityPackages></i:DDIPackage>'
    )
    hazard = row("H", eddi)
    assert hazard.item.claims == ("G1",)
    assert hazard.observers == ("safeml people", "reliability power")
    assert hazard.states == ("observed",)


def test_what_only_observes_withdraws_nothing(tmp_path: Path) -> None:
    (tmp_path / "landing.xml").write_bytes(LANDING.read_bytes())
    result = run("check", "landing.xml", "--hazards", cwd=tmp_path)
    assert result.status == 1
    assert "landing.xml:21: error: no guarantee is linked with hazard FallsOnPerson" in result.err
    assert "no hazard or requirement needs Landing/PreciseLanding [J007]" in result.err
    read = read_models(Source("m.xml", LANDING.read_bytes()))
    assert read.hazards is not None
    (other,) = HazardTrace(read.hazards, []).rows.values()
    assert other.states == ("unlinked",), "no such monitor runs"
    bound = monitors_of(LANDING, [], "motor_watch")[0]
    (seen,) = HazardTrace(read.hazards, [], bound).rows.values()
    assert (seen.states, seen.observers) == (("observed",), ("event motor_watch/hot",))


def test_without_the_option_there_is_one_info(tmp_path: Path) -> None:
    shutil.copy(ROBOT / "hazards.xml", tmp_path)
    result = run("check", "hazards.xml", "-v", cwd=tmp_path)
    assert result.status == 0
    assert result.err.count("[J001]") == result.err.count(": info: ") == 1
    assert "name no guarantee: 3 [J001]" in result.err


def test_to_forget_the_eddi_is_no_success() -> None:
    result = run("check", "robot.yml", "--hazards", cwd=ROBOT)
    assert result.status == 1
    assert "error: there are neither hazards nor requirements [F004]" in result.err


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("warehouse")
    shutil.copytree(ROBOT, folder, dirs_exist_ok=True)
    words = ("-q", "generate", "--platform", "plain", "-o", "out", "-c", "robot.yml")
    assert run(*words, cwd=folder).status == 0
    return folder


@pytest.mark.slow
def test_trace_follows_hazards_to_topics(generated: Path) -> None:
    text = run("trace", "-w", "out", "-m", "hazards.xml", cwd=generated).out
    assert "  hazard HitsPerson (hazards.xml:7): linked, in time\n    severity S2\n" in text
    assert "  hazard LosesLoad (hazards.xml:9): unlinked\n" in text
    assert "    PathClear <- lidar.PathClear (EDDIInput.process_PathClear)\n" in text
    assert not re.search(r"mitigated|\bsafe\b|verified", text)
    document = json.loads(
        run("trace", "-w", "out", "-m", "hazards.xml", "--json", cwd=generated).out
    )
    hazard = document["hazards"][0]
    assert (hazard["states"], hazard["bound"]["bound_s"]) == (["linked", "in time"], 2.2)
    assert set(hazard["support"]) == {of["claim"] for of in document["support"]} - {
        "warehouse.WalkingPace"
    }


@pytest.mark.slow
def test_trace_refuses_what_has_no_hazards(generated: Path) -> None:
    for file, code in (("robot.yml", "F003"), ("gone.xml", "F001"), ("two_conserts.xml", "F004")):
        shutil.copy(ROOT / "examples" / "two-conserts" / "two_conserts.xml", generated)
        result = run("trace", "-w", "out", "-m", file, cwd=generated)
        assert (result.status, result.out) == (2, "")
        assert f"[{code}]" in result.err


@pytest.mark.slow
def test_an_edited_monitor_makes_its_rows_stale(generated: Path, tmp_path: Path) -> None:
    """Only those whose guarantee rests on it: walking pace needs no camera."""
    shutil.copytree(generated, tmp_path, dirs_exist_ok=True)
    eddi = EDDI.replace('<values tag="guarantee" value="warehouse/FullSpeed"/>\n        <v', "<v")
    (tmp_path / "hazards.xml").write_text(eddi, "utf-8")
    with (tmp_path / "out" / "people" / "compiled.py").open("a") as file:
        file.write("# by hand\n")
    words = ("trace", "-w", "out", "-m", "hazards.xml", "--json")
    document = json.loads(run(*words, cwd=tmp_path).out)
    states = {row["name"]: row["states"] for row in document["hazards"]}
    assert states["HitsPerson"] == ["linked", "stale"]
    assert states["HitsShelf"] == ["linked", "in time"]
    assert states["LosesLoad"] == ["unlinked"]
    differs = {of["package"]: of["known"]["differs"] for of in document["support"]}
    assert {package for package, of in differs.items() if of} == {"people"}
