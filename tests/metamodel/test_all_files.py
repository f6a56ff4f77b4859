"""What the commands print about each file: nothing is lost in silence, and nothing cries wolf."""

import re
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.links import links_of
from eddi_scaffold.eddi_xml.parsing import XMI
from eddi_scaffold.kinds.bayesian_network.cross_check import posteriors
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import run
from tests.data_files import data_text
from tests.kinds.bayesian_network.networks import joined, running
from tests.metamodel.expected import FOLDER, cases, expected, models
from tests.metamodel.test_random import NOT_THESE

WRONG = re.compile(r"\[(X010|X011)\]")
KINDS = {
    "consert": "consert",
    "bayesian_network": "bayesian_network",
    "fault_tree": "reliability",
    "markov_chain": "reliability",
    "state_machine": "state_machine",
}
"""Kind of a model in an EDDI -> that of its monitor."""
SEVERE = re.compile(r": (warning|error): ")


def printed(file: str, kinds: set[str]) -> str:
    commands = [["check", "--verbose"], ["show", "--verbose"]]
    commands += [["compose"]] if kinds == {"consert"} else []
    results = [run(*command, file, cwd=FOLDER) for command in commands]
    return "\n".join(result.out + result.err for result in results)


@pytest.mark.parametrize("file", list(expected()))
def test_what_is_said_of_each_file(file: str) -> None:
    case = expected()[file]
    text = printed(file, {model["kind"] for model in case["read"]})
    assert not WRONG.search(text)
    if case["read"]:
        reading = read_models(read_source(FOLDER / file))
        checked = [model.check() for model in reading.models]
        problems = [*reading.problems, *(problem for of in checked for problem in of)]
        assert not {problem.case for problem in problems} & NOT_THESE
    severe = [one for one in case.get("say", ()) if one.get("severity") == "error"]
    assert (": error: " in text) == bool(severe)
    for one in case.get("say", ()):
        assert all(word in text for word in one["words"]), one
        if "severity" in one:
            said = [line for line in text.splitlines() if SEVERE.search(line)]
            assert any(all(word in line for word in one["words"]) for line in said), one
    wanted = [(KINDS[one["kind"]], one["name"]) for one in case["read"]]
    found = read_models(read_source(FOLDER / file)).models if wanted else ()
    in_order = sorted((model.place.line or 0, model.kind, model.name) for model in found)
    assert [(kind, name) for _, kind, name in in_order] == wanted
    document, _ = read_document(read_source(FOLDER / file))
    assert document is not None
    every = list(document.document.iter())
    beside = [one for one in every if one.tag == f"{{{XMI}}}XMI" or "href" in one.attrib]
    assert len(every) - len(beside) == case["objects"]
    for model in case["read"]:
        assert not re.search(rf"{re.escape(model['name'])}[^\n]* not read", text)


def names_of(file: str) -> dict[str, list[str]]:
    """Return what each element is linked with, the nearest first."""
    document, _ = read_document(read_source(FOLDER / file))
    assert document is not None
    return {one.id: [link.name for link in one.links] for one in links_of(document).values()}


def test_links_lead_out_of_a_model_and_along_traces() -> None:
    names = names_of("13_all_in_one.xml")
    for element, wanted in expected()["13_all_in_one.xml"]["links"].items():
        assert set(wanted) <= {name.partition(" (")[0] for name in names[element]}
    assert names["CameraFit"] == ["SR-1"]
    assert names["GpsFit"][0] == "SR-GPS"
    assert "SR-GPS" not in names["ReturnHome"][:2]


CASES = cases("bayesian_network")


@pytest.mark.parametrize(("file", "want"), CASES, ids=[file for file, _ in CASES])
def test_content_outputs_and_posteriors(file: str, want: dict[str, Any]) -> None:
    (model,) = (one for one in models(file) if one.name == want["name"])
    assert {node.id: list(node.states) for node in model.data.nodes} == want["nodes"]
    assert {node.id: list(node.parents) for node in model.data.nodes} == want["parents"]
    assert dict(model.data.known) == want.get("evidence", {"Wind": None})
    monitor, problems = joined(model)
    assert monitor is not None, problems
    assert list(monitor.model.settings.outputs) == want["targets"]
    for row in want["posteriors"]:
        found = posteriors(running(monitor), row["given"])
        for node, states in row["of"].items():
            assert list(found[node]) == pytest.approx(list(states.values()), rel=1e-9, abs=1e-15)


def test_what_the_condition_reads_is_the_first_candidate(tmp_path: Path) -> None:
    (tmp_path / "c.yml").write_text(data_text("metamodel/topics.yml"), "utf-8")
    model = FOLDER / "01_consert_minimal.xml"
    drafted = run("connect", str(model), "-o", "c.yml", "--dry-run", cwd=tmp_path).out
    lines = [line.removeprefix("+").strip() for line in drafted.splitlines()]
    first = lines.index("- id: BatteryFit") + 1
    assert lines[first] == (
        "# connect: the EDDI names the event battery above 30 % (battery.percentage > 0.3)"
    )
    assert 'from: "bat.percentage == TODO"' in lines[first + 2]
    assert "from: fit.data" in lines[first + 3]
    assert lines[first + 4].startswith("from: TODO")


def test_the_event_of_another_monitor_is_taken(tmp_path: Path) -> None:
    text = (FOLDER / "01_consert_minimal.xml").read_text("utf-8")
    text = text.replace('name="battery above 30 %"', 'name="enough"')
    system = text.index(">", text.index("<systems ")) + 1
    (tmp_path / "m.xml").write_text(
        text[:system] + data_text("metamodel/watch.xml") + text[system:]
    )
    (tmp_path / "watch.yml").write_text(data_text("metamodel/watch_config.yml"))
    drafted = run("connect", "m.xml", "--name", "Rover", "--with", "watch.yml", cwd=tmp_path)
    assert "taken" in drafted.out, drafted.out + drafted.err
    assert "enough fulfils it" in drafted.out
