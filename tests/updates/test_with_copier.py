"""Plain Copier, on each platform: every region of a package keeps its text. And D7.2's packages."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.kinds.bayesian_network.network import Network, Node
from eddi_scaffold.kinds.bayesian_network.write import to_xmlbif
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import chosen
from tests.adopting.old_packages import write_old_ros_package
from tests.cli.command import example, run
from tests.data_files import data_text
from tests.quick_copier import copier_here
from tests.updates.inputs import Input, write_inputs
from tests.updates.lives import START, Life, histories, outside, parsed, snapshot, texts, write_in
from tests.updates.templates import TAGS, Templates, git
from tests.updates.world import Result, World

pytestmark = pytest.mark.slow
_MORE = {
    "ros1": {"RosNode.module", "RosNode.members", "launch.node", "launch.own", "package.own"},
    "ros2": {"RosNode.module", "RosNode.members", "launch.node", "launch.own", "setup.own"},
    "plain": {"readme.own"},
}


_NETWORK = data_text("updates/network_config.yml")


@dataclass
class OnlyCopier:
    """A package that nothing but Copier makes; without inputs it is one of a network."""

    folder: Path
    templates: Templates
    platform: str
    inputs: tuple[Input, ...]
    states: int = 2
    template: str = "first"
    known: dict[object, Mapping[str, str]] = field(default_factory=dict)

    @property
    def package(self) -> Path:
        return self.folder / "here"

    def answers(self) -> dict[str, object]:
        folder = self.folder / "inputs"
        if self.inputs:
            model, config = write_inputs(folder, self.inputs)
        else:
            folder.mkdir(exist_ok=True)
            model, config = folder / "net.xmlbif", folder / "eddi_config.yml"
            names = ("speed", "weather", "critical")[: self.states + 1]
            values = tuple(f"s{number}" for number in range(self.states))
            shares = tuple(1 / self.states for _ in values)
            nodes = tuple(Node(one, one, values, (), shares) for one in names)
            model.write_text(to_xmlbif(Network("net", nodes)))
            config.write_text(_NETWORK)
        monitors, problems = monitors_of(model, [config])
        packages = assemble(monitors, chosen(self.platform), folder / "none", problems).packages
        package = next(one for one in packages if "facts" in one.answers)
        for name, data in package.files.items():
            (folder / Path(name).name).write_bytes(data)
        return {**package.answers, "files_folder": str(folder)}

    def rendering(self) -> Mapping[str, str]:
        key = (self.inputs, self.states, self.template)
        if key not in self.known:
            fresh = replace(self, folder=self.folder / f"fresh{len(self.known)}", known={})
            fresh.folder.mkdir()
            assert fresh.bring("copy").status == 0
            self.known[key] = texts(fresh.package)
        return self.known[key]

    def bring(self, command: str) -> Result:
        command = {"generate": "recopy"}.get(command, command)
        data = self.folder / "answers.yml"
        data.write_text(yaml.safe_dump(self.answers()))
        words = [command, "--trust", "--defaults", "--quiet", "--data-file", data]
        words += ["--vcs-ref", TAGS[self.template]]
        words += [] if command == "update" else ["--overwrite"]
        if self.package.exists() and not (self.package / ".git").exists():
            git(self.package, "init", "-q")
        if command == "update":
            git(self.package, "add", "-A")
            git(self.package, "commit", "-q", "--allow-empty", "-m", "work")
        places = [self.templates.path, self.package] if command == "copy" else [self.package]
        done = copier_here(*words, *places, cwd=self.folder)
        checked = World(self.folder, self.templates, ()).command("regions", "--check", self.package)
        return Result(2 if done.returncode else checked.status, done.stdout + done.stderr)


_PLACES = {
    "ros1": ("ros1", START, "update"),
    "ros2": ("ros2", START, ""),
    "plain": ("plain", START, ""),
    "network": ("plain", (), "copy"),
    "ros2-network": ("ros2", (), ""),
}
"""Platform, inputs and the command with which the quick profile is content."""


@pytest.mark.parametrize(
    ("platform", "inputs", "command"),
    [
        pytest.param(platform, inputs, command, id=f"{name}-{command}")
        for name, (platform, inputs, quick) in _PLACES.items()
        for command in ("copy", "recopy", "update")
        if histories(int(command == quick), 1)
    ],
)
def test_every_region_keeps_its_text(
    folder: Path, templates: Templates, platform: str, inputs: tuple[Input, ...], command: str
) -> None:
    place = OnlyCopier(folder, templates, platform, inputs)
    life = Life(place, random.Random(f"{platform} {command}"))
    life.begin("copy")
    methods = {f"process_{one.id}" for one in inputs} or {"node_speed", "node_weather"}
    assert life.owners.keys() >= _MORE[platform] | methods
    for id_ in life.owners:
        write_in(life, id_)
    outside(life)
    life.sync(command)
    place.template, place.states = "second", 3
    if inputs:
        one, other, *_ = inputs
        changed = replace(one, id="E4", renamed_from="E1"), replace(other, type="float")
        place.inputs = changed
        life.who = {"E4": life.who["E1"], "E2": life.who["E2"]}
    life.sync(command)
    assert all(life.body_of(id_) for id_ in life.owners if id_ != "node_critical")
    assert [id_ for id_, _ in life.kept] == (["process_E3"] if inputs else [])


def test_a_package_of_d72_is_adopted_and_generated(tmp_path: Path) -> None:
    example(tmp_path)
    assert run("export", "two_conserts.xml", "-o", "yml", cwd=tmp_path).status == 0
    write_old_ros_package(tmp_path / "old", (tmp_path / "yml/ConSertA.yml").read_text())
    assert run("adopt", "old", "-w", "ws", cwd=tmp_path).status == 3
    package = tmp_path / "ws/src/eddi_monitor/conserta"
    bodies = parsed((package / "src/conserta/EDDIInput.py").read_text()).regions
    assert "self.tilt()" in bodies["process_RtE_A_E0"].body
    assert "# the one that matters" in bodies["process_RtE_A_D0"].body
    before = snapshot(package)
    words = ("-m", "ws/ConSertA.yml", "-c", "ws/conserta_config.yml")
    for command in (("generate", "-w", "ws", *words), ("upgrade", "-w", "ws")):
        assert run(*command, cwd=tmp_path).status == 3
        assert snapshot(package) == before
