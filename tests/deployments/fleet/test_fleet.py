"""A deployment file: what it says of robots and demands, and what is checked of it."""

import shutil
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.deployments.fleet import Fleet, read_whole_fleet
from eddi_scaffold.deployments.fleet_checks import diagram
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.yaml_text.nodes import read_map
from tests.cli.command import ROOT, run
from tests.diagnosed import assert_reported

EXAMPLE = ROOT / "examples" / "two-robots"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(EXAMPLE, tmp_path / "two-robots"))


def whole(folder: Path, text: str) -> Fleet:
    (folder / "deployment.yml").write_text(text, "utf-8")
    fleet, problems = read_whole_fleet(read_source(folder / "deployment.yml"), checked_models)
    assert fleet is not None, problems
    return fleet


def offered(fleet: Fleet) -> dict[str, list[str]]:
    return {
        f"{binding.user.name}.{binding.demand}": [
            f"{o.provider.name}.{o.guarantee}" for o in binding.fulfilments
        ]
        for binding in fleet.bindings
    }


ROBOTS = """\
Robots:
  - {name: cart, monitors: [{config: cart_config.yml}]}
  - {name: arm, monitors: [{config: arm_config.yml}]}
  - {name: lift, monitors: [{config: arm_config.yml}]}
  - {name: far, master: "http://far:11311", monitors: [{config: arm_config.yml}]}
  - {name: truck, namespace: /, monitors: [{config: cart_config.yml}]}
"""


@pytest.mark.parametrize(
    ("binding", "expected"),
    [
        ("robot: cart, from: [lift]", {"cart": ["lift/arm.Parked"]}),
        ("robot: cart, from: lift", {"cart": ["lift/arm.Parked"]}),
        ("robot: cart", {"cart": ["arm/arm.Parked", "lift/arm.Parked"]}),
        (
            "from: any, monitor: cart, guarantee: Parked",
            {key: ["arm/arm.Parked", "lift/arm.Parked"] for key in ("cart", "truck")},
        ),
    ],
)
def test_who_may_fulfil_a_demand(
    binding: str, expected: dict[str, list[str]], folder: Path
) -> None:
    text = f"{ROBOTS}Bindings: [{{demand: ArmIsParked, {binding}}}]\n"
    found = offered(whole(folder, text))
    assert found == {f"{name}/cart.ArmIsParked": of for name, of in expected.items()}


def test_so_many_offers_are_not_looked_through(folder: Path) -> None:
    path = folder / "deployment.yml"
    robots = [
        f"  - {{name: {name}{k}, monitors: [{{config: {name}_config.yml}}]}}"
        for name in ("cart", "arm")
        for k in range(51)
    ]
    path.write_text("\n".join(["Robots:", *robots, "Bindings: [{demand: ArmIsParked}]\n"]), "utf-8")
    problems = read_whole_fleet(read_source(path), checked_models)[1]
    assert_reported("D004", problems)


def test_robots_apart_may_publish_what_they_want(folder: Path) -> None:
    """One absolute topic on two masters is no problem, and one on one master is."""
    override = "override: {EDDIOutputs: [{id: arm, topic: /guarantees}]}"
    arm = "monitors: [{config: arm_config.yml, " + override + "}]"
    text = f"Robots:\n  - {{name: one, {arm}}}\n  - {{name: two, PLACE{arm}}}\n"
    for place, status in (("", 1), ("master: 'http://two:11311', ", 0)):
        (folder / "deployment.yml").write_text(text.replace("PLACE", place), "utf-8")
        result = run("check", "deployment.yml", cwd=folder)
        assert result.status == status
        assert ("[D005]" in result.err) == bool(status)


def test_the_picture_shows_robots_monitors_and_bindings(folder: Path) -> None:
    text = ROBOTS.replace("arm_config.yml}", "arm_config.yml}, {config: own_config.yml}", 1)
    own = """\
Model: {id: own, type: ConSert, parameters: [{model: cart.yml}]}
SimulatorOutputs: [{id: arm, type: eddi_messages.ConSertOutput, topic: guarantees}]
EDDIInputs: [{id: ArmIsParked, requires: [arm], field: "guarantees[Parked].active", max_age: 1}]
EDDIOutputs: [{id: own, topic: own}]
"""
    (folder / "own_config.yml").write_text(own, "utf-8")
    fleet = whole(folder, f"{text}Bindings: [{{demand: ArmIsParked, robot: cart, from: lift}}]\n")
    found = diagram(fleet, "cell")
    heads = " ".join(node.lines[0] for node in found.nodes)
    assert heads == "cart arm lift far truck cart arm own arm arm cart"
    edges = [(one.source, one.target, one.label) for one in found.edges if one.arrow]
    assert edges == [("arm/0", "arm/1", ""), ("lift/0", "cart/0", "Parked for ArmIsParked")]
    result = run("diagram", "deployment.yml", cwd=folder)
    assert result.status == 0
    assert result.out == drawn(diagram(fleet, "deployment"))


def test_an_override_counts_with_its_own_place() -> None:
    text = "Model: {id: a, type: ConSert}\nEDDIInputs: [{id: x, max_age: 1}, {id: y}]\n"
    other = (
        "Model: {frequency: 5}\nEDDIInputs: [{id: y, max_age: 2}, {id: z}]\n"
        "EDDIOutputs: [{id: o, topic: o}]\n"
    )
    override, _ = read_map(Source("other.yml", other.encode()), "K001")
    config, problems = read_config(Source("a.yml", text.encode()), override=override)
    assert problems == []
    assert config is not None
    assert config.config.Model.frequency == 5
    assert [(one.id, one.max_age) for one in config.config.EDDIInputs] == [
        ("x", 1.0),
        ("y", 2.0),
        ("z", None),
    ]
    assert [one.topic for one in config.config.EDDIOutputs] == ["o"]
    place = config.place("EDDIInputs", 1, "max_age")
    assert (place.file, place.line) == ("other.yml", 2)
    assert config.place("EDDIInputs", 0, "max_age").file == "a.yml"
    assert config.inside("EDDIInputs", 1, "max_age")(0) == place
