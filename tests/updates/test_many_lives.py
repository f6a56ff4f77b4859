"""Thousands of lives: Copier renders each model and look once, our own commands do the rest.

`generate` and `upgrade` merge in a scratch folder and write as one step; plain `copier copy` lays
its files over the package and calls `sync`. Both are run here on Copier's real renderings, which
are kept for the next time that the same model and template come by.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import patch

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from eddi_scaffold.packages import generation
from eddi_scaffold.packages.rendering import Renderer, Template
from eddi_scaffold.packages.unpacking import Unpacked
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.problems import EddiError
from eddi_scaffold.regions.check import broken_files
from eddi_scaffold.regions.store import load_orphans
from eddi_scaffold.regions.sync import sync_package
from tests.updates.inputs import Element, elements
from tests.updates.templates import Templates, git
from tests.updates.test_sequences import CHANGES, WORDS, Life
from tests.updates.world import DONE, OPERATIONS, Result, World, killed_at, long_profile

pytestmark = pytest.mark.slow

LOOKS = 3
START = elements("alpha", "beta", "gamma")


class Renderings:
    """Copier's renderings of a pool of models that follow from each other."""

    def __init__(self, folder: Path, templates: Templates, size: int) -> None:
        self.folder = folder
        self.looks = [folder / f"look_{look}" for look in range(1, LOOKS + 1)]
        for look, path in enumerate(self.looks, 1):
            git(folder, "clone", "-q", "-b", templates.tag(look), str(templates.path), str(path))
            shutil.rmtree(path / ".git")
        self.pool = [START]
        self.next: dict[tuple[Element, ...], list[tuple[Element, ...]]] = {}
        seed = folder / "seed"
        seed.mkdir()
        life = Life(World(seed, templates, "plain", START), 1)
        while len(self.pool) < size:
            before = life.world.inputs = life.chance.choice(self.pool)
            life.model_change()
            self.pool.append(life.world.inputs)
            self.next.setdefault(before, []).append(life.world.inputs)
        self._answers: dict[object, dict[str, object]] = {}

    def answers(self, world: World) -> dict[str, object]:
        if world.inputs not in self._answers:
            self._answers[world.inputs] = World.answers(world)
        return self._answers[world.inputs]

    def template(self, world: World) -> Template:
        return Template(str(self.looks[(world.version - 1) % LOOKS]), None)

    def rendered(self, world: World) -> Path:
        place = self.folder / f"{self.pool.index(world.inputs)}_{(world.version - 1) % LOOKS}"
        if not place.exists():
            template = self.template(world)
            source = Unpacked(None, True, lambda: Path(template.location))
            Renderer(template, source).render(self.answers(world), place)
        return place


class QuickWorld(World):
    """A world whose operations take what Copier rendered before."""

    renderings: Renderings

    def copy(self) -> Result:
        generation._copy_rendering(self.renderings.rendered(self), self.package)
        sync_package(self.package)
        return Result(0, "")

    def update(self) -> Result:
        if broken_files(self.package):
            return Result(1, "the check before the update")
        return self.copy()

    recopy = copy

    def upgrade(self) -> Result:
        place, template = self.renderings.rendered(self), self.renderings.template(self)
        package = PackageAnswers("rover", self.renderings.answers(self))

        def known(_self: object, _answers: object, folder: Path) -> list[str]:
            shutil.copytree(place, folder)
            return []

        try:
            with patch.object(Renderer, "render", known):
                outcome = generation.write_packages(self.root, [package], template)
        except EddiError as problem:
            return Result(2, str(problem))
        return Result(3 if outcome.attention or outcome.left else 0, " ".join(outcome.notes))

    generate = upgrade

    def commit(self) -> None:
        pass


class QuickLife(Life):
    """A life that jumps in the pool of models and may die at any step of a folder."""

    def act(self, word: str) -> None:
        if word in CHANGES and word != "template":
            word = "jump"
        super().act(word)

    def model_change(self) -> None:
        self.jump()

    def jump(self) -> None:
        assert isinstance(self.world, QuickWorld)
        known = self.world.renderings
        near = known.next.get(self.world.inputs) if self.chance.random() < 0.7 else None
        self.world.change(*self.chance.choice(near or known.pool))

    def template(self) -> None:
        self.world.version = self.chance.randint(1, LOOKS)

    def kill(self) -> None:
        self._some_change()
        word = self.chance.choice(("copy", "upgrade"))
        self.world.seen.append(self.world.inputs)
        assert isinstance(self.world, QuickWorld)
        self.world.renderings.rendered(self.world)  # what is killed is not the first rendering
        with pytest.MonkeyPatch.context() as context:
            died = killed_at(self.chance.randrange(60), getattr(self.world, word), context)
        self.world.is_cut = died
        DONE[f"kill {word}" if died else f"kill {word} too late"] += 1
        self.world.check(finished=False)
        if self.chance.random() < 0.5:
            self.edit()
        if self.chance.random() < 0.3:
            self.edit_outside()
        if self.chance.random() < 0.3:
            self._some_change()
        self.run(self.chance.choice(OPERATIONS))

    def refuses_update(self) -> bool:
        return False  # there is no git here, and no check

    def save(self, words: tuple[str, ...] = ("copy", "upgrade")) -> None:
        assert isinstance(self.world, QuickWorld)
        super().save(words)

    def two(self) -> None:
        """Leave out what needs processes of its own."""

    def _some_change(self) -> None:
        self.chance.choice((self.jump, self.template))()


@pytest.fixture(scope="session")
def renderings(templates: Templates, fast_folder: Path) -> Iterator[Renderings]:
    with tempfile.TemporaryDirectory(dir=fast_folder) as folder:
        yield Renderings(Path(folder), templates, 60 if long_profile() else 12)


@settings(
    deadline=None,
    max_examples=5000 if long_profile() else 15,
    suppress_health_check=list(HealthCheck),
    phases=(Phase.explicit, Phase.generate),
)
@given(words=st.lists(st.sampled_from(WORDS), min_size=12, max_size=40), seed=st.integers(0, 10**9))
def test_many_lives(
    templates: Templates, renderings: Renderings, fast_folder: Path, words: list[str], seed: int
) -> None:
    with tempfile.TemporaryDirectory(dir=fast_folder) as folder, patch.object(os, "fsync"):
        world = QuickWorld(Path(folder), templates, "plain", START)
        world.renderings = renderings
        life = QuickLife(world, seed)
        life.run("copy")
        for word in words:
            life.act(word)
        life.run(life.chance.choice(OPERATIONS))
        DONE["lives"] += 1


@pytest.mark.parametrize("edited", [True, False])
def test_a_body_that_was_edited_after_a_kill_may_be_kept_as_it_was_before_too(
    templates: Templates, renderings: Renderings, fast_folder: Path, edited: bool
) -> None:
    """A killed copy has saved the body of a removed input; the input is back before the next."""
    with tempfile.TemporaryDirectory(dir=fast_folder) as folder, patch.object(os, "fsync"):
        world = QuickWorld(Path(folder), templates, "plain", START)
        world.renderings = renderings
        _copied(world)
        token = world.edit("alpha")
        world.change(*(item for item in START if item.name != "alpha"))
        renderings.pool.append(world.inputs)
        renderings.rendered(world)  # what is killed is not the first rendering
        world.seen.append(world.inputs)
        world.is_cut, step = True, 0
        with pytest.MonkeyPatch.context() as context:
            while not load_orphans(world.package):
                assert killed_at(step, world.copy, context)
                step += 1
        assert token in world.text()
        if edited:  # not only below what was saved
            world.edit("alpha")
            region = world.document().regions["input:alpha"]
            world.put(region, "".join(reversed(region.body.splitlines(keepends=True))))
        world.change(*START)
        _copied(world)
        saved = [one.body for one in load_orphans(world.package).values()]
        assert [token in body for body in saved] == [True] * edited
        assert world.twice == ({token} if edited else set())


def _copied(world: World) -> None:
    assert world.copy().status == 0
    world.settle()
    world.check()


def test_the_pool_has_every_kind_of_change(renderings: Renderings) -> None:
    names = {item.name for model in renderings.pool for item in model}
    assert len(set(renderings.pool)) > len(renderings.pool) / 2
    assert len(names) > 4
    assert any(item.was for model in renderings.pool for item in model)
    assert isinstance(renderings.pool[0][0], Element)
