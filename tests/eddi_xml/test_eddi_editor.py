"""Files of EDDI-Editor: the same models as from EMF, one event where copies are meant."""

import os
import re
import subprocess
from copy import deepcopy
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.eddi_xml.survey import survey
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.kinds.reliability.lowering import lower_tree
from eddi_scaffold.kinds.reliability.show import at_start
from eddi_scaffold.kinds.reliability.system import FaultTree, Law
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import ABSENT, FOREIGN, ORACLES, data_text, tabled

DATA = ORACLES / "state_machines"
EXPECTED = yaml.safe_load((DATA / "eddi_editor_expected.yml").read_text("utf-8"))["files"]
MIRROR = Path(".mirror", "Dependable-Intelligent-Systems-Lab+EDDI-Editor", "repo")
REPOSITORY = Path(os.environ.get("EDDI_EDITOR_REPOSITORY", FOREIGN.parents[1] / MIRROR))
"""The git directory of EDDI-Editor with the commit below; nothing of it is part of the project."""
COMMIT = "8cc49bb8"


@cache
def public(file: str) -> Source:
    """Return a file of EDDI-Editor's repository, or skip the test where that is absent."""
    if not (REPOSITORY / "objects").is_dir():
        pytest.skip(f"{ABSENT}: set EDDI_EDITOR_REPOSITORY to a git directory of EDDI-Editor")
    command = ["git", "-C", str(REPOSITORY), "show", f"{COMMIT}:{file}"]
    return Source(file, subprocess.run(command, check=True, capture_output=True).stdout)


def reported(reading: ReadResult) -> list[str]:
    return [
        f"{p.place.line}{f':{p.place.col}' if p.place.col else ''} {p.case} {p.message}"
        for p in reading.problems
        if not p.case.startswith("R004")  # rates have no unit in these files
    ]


def tree_of(model: Model) -> FaultTree:
    content = model.data.components[model.data.top].content
    assert isinstance(content, FaultTree)
    return content


def tree_model(source: Source) -> Model:
    (model,) = [m for m in read_models(source).models if m.kind == "reliability"]
    return model


def p_fail(model: Model, hours: float) -> float:
    return at_start(replace(model.data, horizon=float(hours))).p_fail


def cut_sets(model: Model) -> set[frozenset[str]]:
    tree = tree_of(model)
    law = Law("exponential", (1.0,))  # where the file has none
    events = {name: replace(event, law=event.law or law) for name, event in tree.events.items()}
    lowered = lower_tree(model.name, replace(tree, events=events))
    sets = lowered.cut_sets
    assert sets is not None
    return {frozenset(lowered.events[i].name for i in one) for one in sets}


@pytest.mark.parametrize("file", sorted(path.name for path in DATA.glob("*.[ij][ds]*")))
def test_the_same_models_as_from_emf(file: str) -> None:
    """Names, flags, order, actions, triggers; what triggers mean; trees with their laws."""
    ours = {m.kind: m for m in read_models(read_source(DATA / file)).models}
    name = file.partition(".")[0]
    emf = {m.kind: m for m in read_models(read_source(DATA / f"{name}.emf.xml")).models}
    assert {kind: (m.name, m.data) for kind, m in ours.items()} == {
        kind: (m.name, m.data) for kind, m in emf.items()
    }
    assert ours.keys() == {"state_machine"} | ({"reliability"} if name == "pumps" else set())
    assert all(m.place.line for m in ours.values())


def test_a_basic_event_in_two_places_is_one_event() -> None:
    """Each place has an element with an Id of its own: as events of their own 3.5 times less."""
    model = tree_model(read_source(DATA / "pumps.id.xml"))
    assert len(tree_of(model).events) == 4  # of five elements
    assert cut_sets(model) == {
        frozenset({"Plant::Valve.stuck"}),
        frozenset({"Plant::Power.lost"}),
        frozenset({"Plant::PumpA.stopped", "Plant::PumpB.stopped"}),
    }
    for hours, expected in (
        (1, 6.0058181439207056e-05),
        (10, 0.000605801468034774),
        (100, 0.006563752798523909),
        (1000, 0.10248115197421756),
    ):
        assert p_fail(model, hours) == pytest.approx(expected, rel=1e-12, abs=0)


def test_what_a_tree_may_hold() -> None:
    """A vote, a state of a chain in its `SubModels`, cut sets; a list that says the tree again."""
    reading = read_models(Source("m.xml", data_text("eddi_xml/eddi_editor.xml").encode()))
    assert not reported(reading)
    tree, chain = reading.models
    assert tree.outline()[-3:] == ["    x  model M", "    y  p 0.1", "    z  p 0.2"]
    assert chain.name == "M"
    assert not tree.check()


@pytest.mark.parametrize("case", EXPECTED, ids=lambda case: Path(case["file"]).stem)
def test_public_trees(case: dict[str, Any]) -> None:
    source = public(case["file"])
    assert source.sha256 == case["sha256"]
    reading = read_models(source)
    if not case.get("read", True):
        assert [p.case for p in reading.problems] == ["F003.root"]  # F003.other by its first bytes
        return
    assert not has_errors(reading.problems)
    trees = [model for model in reading.models if model.kind == "reliability"]
    assert len(trees) == case["fault_trees"]
    if not trees:
        return
    model = trees[-1]
    tree = tree_of(model)
    assert (len(tree.gates), len(tree.events)) == (case["gates"], case["basic_events"])
    ids = dict(re.findall(rb'<Failure Id="(\d+)" name="([^"]*)" originType="Int', source.data))
    names = {int(id_): name.decode() for id_, name in ids.items()}
    if case["rates"]:
        expected = {names[id_]: rate for id_, rate in case["rates"].items()}
        laws = {name: event.law for name, event in tree.events.items()}
        assert {name: law.values[0] for name, law in laws.items() if law} == expected
        assert {frozenset(names[i] for i in one) for one in case["cut_sets"]} == cut_sets(model)
        assert not [p for p in model.check() if p.code == "R013"]  # those that the file states
    else:
        assert sorted(map(len, cut_sets(model))) == sorted(map(len, case["cut_sets"]))
    for hours, expected in case.get("p", {}).items():
        assert p_fail(model, hours) == pytest.approx(expected, rel=1e-12, abs=0)
    if "stated" in case:
        stated = case["stated"]
        assert f"{p_fail(model, stated['agrees_at']):.6g}" == str(stated["unavailability"])


@tabled
def test_public_counts(
    file: str, systems: int, failures: int, tree: list[int], machine: list[int], actions: int
) -> None:
    source = public(file)
    document, problems = read_document(source)
    assert document is not None
    assert not has_errors(problems)
    counts = [model["counts"] for model in survey(document)["models"]]
    trees = [c for c in counts if "gates" in c]
    assert [[c["gates"], c["basic_events"]] for c in trees] == ([tree] if tree else [])
    texts = {text for root in document.roots for text in select(root, "*/events/@condition")}
    machines = [[c["states"], c["transitions"]] for c in counts if "transitions" in c]
    triggers = sum(len(select(root, "*/events")) for root in document.roots)
    assert [[*m, triggers, len(texts)] for m in machines] == ([machine] if machine else [])
    root = document.roots[0]
    assert len(select(root, "descendant::systems | descendant::subSystems")) == systems
    assert len(select(root, "descendant::failures | descendant::hazards")) == failures
    uses = " ".join(select(root, "descendant::states/@onEntry | descendant::states/@onExit"))
    assert len(uses.split()) == actions


def edited(file: str, edits: dict[str, str]) -> bytes:
    text = (DATA / file).read_text("utf-8")
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new, 1)
    return text.encode()


@tabled
def test_problems(file: str, edits: dict[str, str], expected: list[str]) -> None:
    assert reported(read_models(Source(file, edited(file, edits)))) == expected


@tabled
def test_laws(type_: str, first: str, second: str, kind: str, value: float) -> None:
    """Laws as the converter from HiP-HOPS writes them; rates are per hour."""
    edits = {
        'type="Constant"': f'type="{type_}"',
        'name="Failure Rate" value="0.0002"': first,
        'name="Repair Rate" value="0"': second,
    }
    model = tree_model(Source("pumps.id.xml", edited("pumps.id.xml", edits)))
    assert tree_of(model).events["Plant::PumpA.stopped"].law == Law(kind, (value,))


def test_the_worse_of_two_rates_counts() -> None:
    """Each element of an event holds its rate again; in one of them it was changed."""
    for rate in ("1E-05", "0.5"):
        data = edited("pumps.id.xml", {"5E-05": rate})
        model = tree_model(Source("pumps.id.xml", data))
        expected = Law("exponential", (max(float(rate), 5e-5),))
        assert tree_of(model).events["Plant::Power.lost"].law == expected


@tabled
def test_json_that_is_cut_off_or_deep(text: str) -> None:
    reading = read_models(Source("m.json", f'{text}\n"states": ['.encode()))
    assert [p.case for p in reading.problems] == ["X001.yaml"]


@given(st.integers(0, 10_000), st.sampled_from(["remove", "rename", "twice", "bare", "moved"]))
def test_a_changed_element_gives_models_or_says_where(number: int, change: str) -> None:
    root = etree.fromstring((DATA / "pumps.id.xml").read_bytes())
    elements = list(root.iter())[1:]
    element = elements[number % len(elements)]
    parent = element.getparent()
    assert parent is not None
    match change:
        case "remove":
            parent.remove(element)
        case "rename":
            element.tag = f"{element.tag}x"
        case "twice":
            parent.append(deepcopy(element))
        case "bare":
            element.attrib.clear()
        case "moved":
            root.append(element)
    reading = read_models(Source("m.xml", etree.tostring(root)))
    problems = [*reading.problems, *reading.unread]
    assert all(p.place.line for p in problems)
    assert reading.models or problems or not list(root.iter("FaultTree", "StateMachine"))


def test_triggers_of_a_public_machine_are_causes_of_its_tree() -> None:
    (machine,) = (
        m
        for m in read_models(public("SESAME_Sim/ode_simple_drone_3.xml")).models
        if m.kind == "state_machine"
    )
    texts = {trigger.text for trigger in machine.data.triggers}
    assert machine.data.causes.keys() == texts
    basic = {name for gate in machine.data.gates.values() for name in gate.of}
    assert len(basic - machine.data.gates.keys()) == 3
    assert len(machine.inputs()) == 3


def test_hip_hops_has_the_same_root() -> None:
    data = b"<Model><Name>x</Name><Perspectives/></Model>"
    assert [p.case for p in read_models(Source("m.xml", data)).problems] == ["F003.other"]
