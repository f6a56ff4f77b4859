"""Lives of a network's package: hand-written `node_` methods follow their nodes, whatever changes.

Each step changes the model (a node added, renamed, removed, back again; a state added) and brings
it into the package with plain `copier update`, with `generate` or with `upgrade`.
"""

from __future__ import annotations

import random
import tempfile
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path

import copier
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.kinds.bayesian_network.model import Network, Node
from eddi_scaffold.kinds.bayesian_network.to_xmlbif import to_xmlbif
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import chosen
from eddi_scaffold.regions.marked_file import Region, parse
from eddi_scaffold.regions.store import load_orphans
from tests.updates.templates import Templates, git
from tests.updates.world import World, long_profile

pytestmark = pytest.mark.slow

FILE = "bayesian_network_config.py"
NAMES = ("speed", "distance", "critical", "weather", "speed2", "Rt-5")
CHANGES = ("add", "remove", "rename", "swap", "add_state", "reorder")
WAYS = ("update", "generate", "upgrade", "recopy")


def node(name: str, states: int = 2) -> Node:
    names = tuple(f"s{k}" for k in range(states))
    return Node(name, name, names, (), tuple([1 / states] * states))


@dataclass
class Life:
    """A package of a network, and which line was written into the method of which node."""

    world: World
    chance: random.Random
    nodes: list[Node]
    written: dict[str, str] = field(default_factory=dict)
    renamed: dict[str, str] = field(default_factory=dict)
    aside: list[str] = field(default_factory=list)  # saved under a name that another body has
    count: int = 0

    @property
    def package(self) -> Path:
        return self.world.root / "net"

    def inputs(self) -> tuple[Path, Path]:
        folder = self.world.folder / "inputs"
        folder.mkdir(exist_ok=True)
        model, config = folder / "net.xmlbif", folder / "eddi_config.yml"
        model.write_text(to_xmlbif(Network("net", tuple(self.nodes))), "utf-8")
        renamed = ", ".join(f"{new}: {old}" for new, old in self.renamed.items())
        config.write_text(
            "Model:\n  id: net\n  type: BayesianNetwork\n"
            f"  outputs: [{self.nodes[0].id}]\n  renamed: {{{renamed}}}\n",
            "utf-8",
        )
        return model, config

    def answers(self) -> dict[str, object]:
        model, config = self.inputs()
        monitors, problems = monitors_of(model, [config])
        packages = assemble(monitors, chosen("plain"), self.world.root, problems).packages
        return dict(packages[0].answers)

    def bring(self, way: str) -> None:
        model, config = self.inputs()
        if way == "generate":
            place = ["--platform", "plain", "-o", self.world.workspace]
            result = self.world.command("generate", *place, "-m", model, "-c", config)
        elif way == "upgrade":
            result = self.world.command("upgrade", self.package, "-m", model, "-c", config)
        else:
            self.world.commit()
            self._copier(way)
            return
        assert result.status in (0, 3), result.words
        assert "differs" not in result.words

    def _copier(self, way: str) -> None:
        run = copier.run_update if way == "update" else copier.run_recopy
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            run(
                self.package,
                data=self.answers(),
                vcs_ref=self.world.tag,
                defaults=True,
                overwrite=True,
                unsafe=True,
                quiet=True,
            )

    def regions(self) -> dict[str, Region]:
        document, faults = parse((self.package / FILE).read_text("utf-8"))
        assert not faults
        return document.regions

    def write(self) -> None:
        """Write a line of a person's own into the method of some node."""
        name = self.chance.choice(self.nodes).id
        region = self.regions()[f"node:{name}"]
        self.count += 1
        token = f"hand_{self.count}_line"
        path = self.package / FILE
        text = path.read_text("utf-8")
        begin = f"{region.begin}\n"
        body = f"        outcome_s0 = 1.0  # {token}\n"
        assert text.count(begin) == 1
        at = text.index(begin) + len(begin)
        path.write_text(text[:at] + body + text[at + len(region.body) :], "utf-8")
        self.written[name] = token

    def change(self, what: str) -> None:
        free = [name for name in NAMES if name not in [one.id for one in self.nodes]]
        at = self.chance.randrange(len(self.nodes))
        self.renamed = {}
        if what == "add" and free:
            self.nodes.insert(at, node(self.chance.choice(free)))
        elif what == "remove" and len(self.nodes) > 1:
            del self.nodes[at]
        elif what == "rename" and free:
            old, new = self.nodes[at].id, self.chance.choice(free)
            self.nodes[at] = replace(self.nodes[at], id=new, title=new)
            self.renamed = {new: old}
            moved = self.written.pop(old, None)
            if moved is not None:  # what was declared holds; a saved body of the name stays saved
                self.aside += [self.written[new]] if new in self.written else []
                self.written[new] = moved
        elif what == "swap" and len(self.nodes) > 1:
            one, two = self.chance.sample(range(len(self.nodes)), 2)
            first, second = self.nodes[one].id, self.nodes[two].id
            self.nodes[one] = replace(self.nodes[one], id=second, title=second)
            self.nodes[two] = replace(self.nodes[two], id=first, title=first)
            self.renamed = {second: first, first: second}
            moved = {self.renamed.get(name, name): token for name, token in self.written.items()}
            self.written = moved
        elif what == "add_state":
            self.nodes[at] = node(self.nodes[at].id, len(self.nodes[at].states) + 1)
        elif what == "reorder":
            self.chance.shuffle(self.nodes)

    def check(self) -> None:
        """Check that each line is in the method of its node, or saved under its name; once."""
        regions = self.regions()
        text = (self.package / FILE).read_text("utf-8")
        compile(text, FILE, "exec")
        assert {*regions} == {f"node:{one.id}" for one in self.nodes}
        saved = load_orphans(self.package).values()
        for name, token in self.written.items():
            home = regions.get(f"node:{name}")
            stands = home is not None and token in home.body
            kept = [one for one in saved if token in one.body]
            assert stands or kept, f"{token} of {name} is lost"
            assert text.count(token) == int(stands), f"{token} moved"
        for token in self.aside:
            assert token in text or any(token in one.body for one in saved), f"{token} is lost"


@settings(max_examples=2000 if long_profile() else 2)
@given(
    seed=st.integers(0, 2**32),
    steps=st.lists(
        st.tuples(st.sampled_from(CHANGES), st.sampled_from(WAYS)), min_size=2, max_size=6
    ),
)
def test_random_lives_of_a_network(
    templates: Templates, fast_folder: Path, seed: int, steps: list[tuple[str, str]]
) -> None:
    with tempfile.TemporaryDirectory(dir=fast_folder) as name:
        life = Life(
            World(Path(name), templates),
            random.Random(seed),
            [node("speed"), node("distance"), node("critical", 3)],
        )
        life.bring("generate")
        git(life.world.workspace, "add", "-A")
        life.write()
        life.write()
        for change, way in steps:
            life.change(change)
            life.bring(way)
            life.check()
            life.write()


def test_a_node_that_comes_back_finds_its_method(templates: Templates, folder: Path) -> None:
    nodes = [node("speed"), node("distance"), node("critical", 3)]
    life = Life(World(folder, templates), random.Random(1), list(nodes))
    life.bring("generate")
    for one in nodes:
        life.nodes = [one]
        life.write()
    for gone in range(3):
        life.nodes = [one for number, one in enumerate(nodes) if number != gone]
        life.bring("update")
        life.check()
        life.nodes = list(nodes)
        life.bring("update")
        life.check()
        assert life.written[nodes[gone].id] in life.regions()[f"node:{nodes[gone].id}"].body
