"""What is generated of a deployment file: a workspace for each robot, and one for the station."""

import json
import re
import shutil
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.config.schema import Config
from eddi_scaffold.deployments.fleet import (
    Fleet,
    among_others,
    digests_of,
    read_whole_fleet,
    with_station,
)
from eddi_scaffold.deployments.fleet_checks import diagram, sites_of
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.monitors.config_reading import read_file
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.platforms import MeetingPlace
from eddi_scaffold.yaml_text.nodes import read_map
from tests.cli.command import ROOT, edit, files_below, run
from tests.data_files import data_text, tabled
from tests.diagnosed import assert_reported
from tests.package_texts import facts_in

EXAMPLE = ROOT / "examples" / "two-robots"


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = Path(shutil.copytree(EXAMPLE, tmp_path_factory.mktemp("fleet") / "two-robots"))
    result = run("generate", "deployment.yml", "-o", "cell", cwd=folder)
    assert result.status == 0, result.err
    return folder


def package(cell: Path, robot: str, name: str) -> Path:
    return cell / "cell" / robot / "src" / "eddi_monitor" / name


def digest(cell: Path, robot: str) -> str:
    return facts_in(package(cell, robot, robot)).digest


def test_a_robot_knows_the_models_of_those_that_it_relies_on(cell: Path) -> None:
    for robot, others in (("cart", ["arm"]), ("station", ["arm", "cart", "cart"]), ("arm", [])):
        node = (package(cell, robot, robot) / "scripts" / "RosNode.py").read_text("utf-8")
        assert re.findall("'([0-9a-f]{64})'", node) == [digest(cell, other) for other in others]
        assert "FLEET = Fleet(" in node


def test_a_second_time_changes_nothing(cell: Path) -> None:
    before = files_below(cell / "cell")
    result = run("generate", "deployment.yml", "-o", "cell", cwd=cell)
    assert result.status == 0
    assert "nothing to change" in result.err
    assert files_below(cell / "cell") == before


def test_commands_of_a_workspace_take_the_folder_of_all_robots(cell: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(cell / "cell", tmp_path / "cell"))
    for robot in ("arm", "cart"):
        body = folder / robot / "src" / "eddi_monitor" / robot / "src" / robot / "EDDIMonitor.py"
        body.write_text("mine\n", "utf-8")
    found = run("status", "-w", folder, "--json", cwd=tmp_path)
    drifted = {one["package"] for one in json.loads(found.out)["packages"] if one["drifted"]}
    assert (found.status, drifted) == (1, {"arm/arm", "cart/cart"})
    assert len(json.loads(run("regions", folder, "--json", cwd=tmp_path).out)["regions"]) > 4
    done = run("upgrade", "-w", folder, cwd=tmp_path)
    assert done.status == 3
    for robot in ("arm", "cart"):  # the first one does not hide the other
        assert f"{robot}/src/{robot}/EDDIMonitor.py" in done.err
    stranger = tmp_path / "stranger"
    shutil.copytree(folder / "arm", stranger / "other")  # called otherwise than its robot
    assert run("status", "-w", stranger, cwd=tmp_path).status == 2


def test_hand_edits_stay_when_the_fleet_changes(cell: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(cell, tmp_path / "copy"))
    body = package(folder, "cart", "cart") / "src" / "cart" / "EDDIInput.py"
    edit(body, "self.WayIsFree = scanner.data", "self.WayIsFree = scanner.data  # mine")
    deployment = folder / "deployment.yml"
    more = "  - {name: arm2, monitors: [{config: arm_config.yml}]}\nBindings:"
    edit(deployment, "Bindings:", more)
    edit(deployment, "[arm]", "any")
    before = files_below(folder / "cell")
    dry = run("generate", "deployment.yml", "-o", "cell", "--dry-run", cwd=folder)
    assert dry.status == 0, dry.err
    assert files_below(folder / "cell") == before
    assert "arm2" in dry.out
    result = run("generate", "deployment.yml", "-o", "cell", cwd=folder)
    assert result.status == 0, result.err
    assert "# mine" in body.read_text("utf-8")
    node = (package(folder, "cart", "cart") / "scripts" / "RosNode.py").read_text("utf-8")
    assert "'peer_any_Parked'" in node

    edit(deployment, "lease: 1.0", "lease: 0.1")
    before = files_below(folder)
    assert run("generate", "deployment.yml", "-o", "cell", cwd=folder).status == 2
    assert files_below(folder) == before

    text = (EXAMPLE / "deployment.yml").read_text("utf-8").replace("[arm]", "[other]")
    text = text.replace("name: arm", "name: other").replace("cart_config", "arm_config")
    deployment.write_text(re.sub("Bindings:.*", "", text, flags=re.DOTALL), "utf-8")
    result = run("generate", "deployment.yml", "-o", "cell", "--dry-run", cwd=folder)
    assert result.status == 3
    assert "cart: cart is no monitor of this robot in the deployment file" in result.err

    shutil.copy(EXAMPLE / "deployment.yml", deployment)
    result = run("generate", "deployment.yml", "-o", "cell", cwd=folder)
    assert result.status == 3
    assert "arm2 is no robot of the deployment file" in result.err


@tabled
def test_the_station_is_where_the_first_robot_is(station, platform, graph):
    arms = "\n".join(
        f"  - {{name: arm{number}, platform: {place}, monitors: [{{config: arm_config.yml}}]}}"
        for number, place in enumerate(["dds, domain: 4", "dds, domain: 5", "ros1"])
    )
    source = Source(str(EXAMPLE / "deployment.yml"), f"Robots:\n{arms}\n{station}".encode())
    fleet, problems = read_whole_fleet(source, checked_models)
    assert fleet is not None, problems
    found = with_station(fleet).robots[-1]
    assert (found.platform.name, found.graph) == (platform, MeetingPlace(*graph))
    (binding,) = with_station(fleet).bindings
    assert binding.fulfilments[0].provider.robot.graph == found.graph


def test_how_a_robot_is_started_where_it_meets_others() -> None:
    robots = [
        ("ros1, master: 'http://there:11311'", "ROS_MASTER_URI=http://there:11311 roslaunch"),
        ("ros1, namespace: /", "roslaunch eddi_monitor_launcher eddi.launch"),
        ("ros2, domain: 3", "ROS_DOMAIN_ID=3 ros2 launch"),
        ("dds, partition: hall", "ROS_DOMAIN_ID=0 arm --ros-args -r __ns:=/r3 -p partition:=hall"),
        ("dds, namespace: /", "ROS_DOMAIN_ID=0 arm"),
        ("plain", "pip install cell/r5/arm"),
    ]
    entries = [
        f"  - {{name: r{k}, platform: {place}, monitors: [{{config: arm_config.yml}}]}}"
        for k, (place, _) in enumerate(robots)
    ]
    text = "\n".join(["Robots:", *entries])
    source = Source(str(EXAMPLE / "deployment.yml"), text.encode())
    sites, _ = sites_of(source, checked_models)
    assert [one.name for one in sites][-1] == "station"
    for site, (_, command) in zip(sites, robots, strict=False):
        steps = site.next_steps(Path("cell", site.name))
        assert any(f"cell/{site.name}" in one for one in steps)
        assert any(one.startswith(command) for one in steps), steps


def configured(text: str, folder: Path = EXAMPLE) -> dict[str, Config]:
    """Return robot -> what its monitor is configured with among others."""
    source = Source(str(folder / "deployment.yml"), text.encode())
    fleet, problems = read_whole_fleet(source, checked_models)
    assert fleet is not None, problems
    digests = digests_of(fleet)
    found = {one.robot.name: among_others(fleet, one, digests) for one in fleet.monitors}
    for robot in fleet.robots:  # what the others are told is what the monitor is
        ((monitor,), _) = fleet.bound_monitors(robot, lambda monitor: found[monitor.robot.name])
        assert monitor.facts.digest == digests[robot.name, 0]
    return {name: config.config for name, config in found.items()}


ARM, SLOW = "config: arm_config.yml", "config: arm_config.yml, override: {Model: {debounce: 3}}"


@pytest.mark.parametrize(
    ("whose", "robots"),
    [("[arm3, arm1, arm2]", [("arm1",), ("arm2",), ("arm3",)]), ("any", ["any", "any"])],
)
def test_one_of_several_guarantees_suffices(whose: str, robots: list[object]) -> None:
    arms = [
        f"  - {{name: arm{k}, monitors: [{{{of}}}]}}" for k, of in enumerate((ARM, SLOW, SLOW), 1)
    ]
    cart = "  - {name: cart, monitors: [{config: cart_config.yml}]}"
    bindings = f"Bindings: [{{demand: ArmIsParked, from: {whose}}}]"
    config = configured("\n".join(["Robots:", *arms, cart, bindings]))["cart"]
    words = [one.peers for one in config.SimulatorOutputs if one.peers is not None]
    assert [one.robots for one in words] == robots
    assert len({one.digest for one in words}) == 2
    entry = next(one for one in config.EDDIInputs if one.id == "ArmIsParked")
    assert entry.expression == " OR ".join(
        f"{id_}.guarantees[Parked].active" for id_ in entry.requires
    )
    assert entry.max_age == 1.0


def test_digests_settle_along_a_chain_of_demands(tmp_path: Path) -> None:
    """How many models offer what a robot demands is told by its digest, on which others rely."""
    link = data_text("deployments/link.yml")
    robots = []
    for level, count in ((0, 2), (1, 2), (2, 1)):
        text = link.replace("LEVEL", f"L{level}").replace("BELOW", f"L{level - 1}")
        (tmp_path / f"l{level}.yml").write_text(text, "utf-8")
        config = f"Model: {{id: l{level}, type: ConSert, parameters: [{{model: l{level}.yml}}]}}\n"
        config += "EDDIOutputs: [{id: out, topic: out}]\n"
        (tmp_path / f"l{level}_config.yml").write_text(config, "utf-8")
        robots += [
            f"  - {{name: r{level}{k}, monitors: [{{config: l{level}_config.yml, "
            f"override: {{Model: {{debounce: {k + 1}}}}}}}]}}"
            for k in range(count)
        ]
    bindings = [f"  - {{robot: r{one}, demand: D}}" for one in ("10", "11", "20")]
    found = configured("\n".join(["Robots:", *robots, "Bindings:", *bindings]), tmp_path)
    heard = [one.peers.digest for one in found["r20"].SimulatorOutputs if one.peers is not None]
    assert len(set(heard)) == len(heard) == 2


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


ROBOTS = data_text("deployments/robots.yml")


@tabled
def test_who_may_fulfil_a_demand(binding, expected, folder):
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
    (folder / "own_config.yml").write_text(data_text("deployments/own_config.yml"), "utf-8")
    fleet = whole(folder, f"{text}Bindings: [{{demand: ArmIsParked, robot: cart, from: lift}}]\n")
    found = diagram(fleet, "cell")
    heads = " ".join(node.lines[0] for node in found.nodes)
    assert heads == "cart arm lift far truck cart arm own arm arm cart"
    edges = [(one.source, one.target, one.label) for one in found.edges if one.arrow]
    assert edges == [("lift/0", "cart/0", "Parked for ArmIsParked")]
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
    (config,), problems = read_file(Source("a.yml", text.encode()), override=override)
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


def test_an_override_of_several_monitors_names_them() -> None:
    text = (
        "SimulatorOutputs: [{id: t, type: std_msgs/Bool, topic: t}]\n"
        "---\nModel: {id: a, type: ConSert}\nEDDIInputs: [{id: x, from: t}]\n"
        "---\nModel: {id: b, type: ConSert}\nEDDIInputs: [{id: x, from: t}]\n"
    )
    other = "b: {Model: {frequency: 5}}\nSimulatorOutputs: [{id: t, topic: own}]\n%s"
    source = Source("a.yml", text.encode())

    overrides = [
        read_map(Source("other.yml", (other % x).encode()), "K001")[0] for x in ("", "c: 1")
    ]
    configs, problems = read_file(source, override=overrides[0])
    assert problems == []
    assert [config.config.Model.frequency for config in configs] == [10, 5]
    assert [config.config.SimulatorOutputs[0].topic for config in configs] == ["own", "own"]
    _, (problem,) = read_file(source, override=overrides[1])
    assert (problem.case, problem.place.file, problem.place.line) == ("K003.common", "other.yml", 3)
