"""Random lives of a package: no sequence of operations loses, doubles or moves a written line."""

from __future__ import annotations

import random
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, note, settings
from hypothesis import strategies as st

from eddi_scaffold.regions.branches import join_branches
from tests.updates.inputs import TYPES, Element, elements
from tests.updates.templates import ADDED, VERSIONS, Templates, git
from tests.updates.world import DONE, OPERATIONS, World, long_profile, saved_at, snapshot

pytestmark = pytest.mark.slow

NAMES = ("alpha", "beta", "gamma", "delta", "alpha2", "Rt_E-5")
PLACES = (
    "import", "helper", "docstring", "behind", "init", "default", "comment", "last",
    "manifest", "cmake", "launch",
)  # fmt: skip
CHANGES = (
    "add", "remove", "rename", "permute", "move_up", "retype", "reorder", "rename_silently",
    "template",
)  # fmt: skip


class Life:
    """Turn drawn words and one seed into what happens to a package."""

    def __init__(self, world: World, seed: int) -> None:
        self.world = world
        self.chance = random.Random(seed)

    def act(self, word: str) -> None:
        DONE[word] += 1
        note(word)
        getattr(self, word)()

    # what changes in the model, the templates, the files -------------------------------------
    def add(self) -> None:
        free = [name for name in NAMES if name not in self._names()]
        if free:
            new = Element(self.chance.choice(free), self.chance.choice(TYPES))
            place = self.chance.randint(0, len(self.world.inputs))
            self.world.change(*self.world.inputs[:place], new, *self.world.inputs[place:])

    def remove(self) -> None:
        if len(self.world.inputs) > 1:
            gone = self.chance.choice(self.world.inputs)
            self.world.change(*(item for item in self.world.inputs if item != gone))

    def rename(self, *, declared: bool = True) -> None:
        free = [name for name in NAMES if name not in self._names()]
        if free:
            old = self.chance.choice(self.world.inputs)
            new = old.renamed(self.chance.choice(free), declared=declared)
            self.world.change(*(new if item == old else item for item in self.world.inputs))

    def permute(self) -> None:
        """Exchange the names of some inputs, each declared."""
        old = self.chance.sample(self.world.inputs, self.chance.randint(1, len(self._names())))
        names = [item.name for item in old]
        self._take_names(dict(zip(names, [*names[1:], names[0]], strict=True)))

    def move_up(self) -> None:
        """Give the name of each input to the one behind it, and the first name to a new input."""
        names = self._names()
        free = [name for name in NAMES if name not in names]
        if free:
            last = self.chance.choice(free)
            self._take_names(dict(zip(names, [*names[1:], last], strict=True)))
            if self.chance.random() < 0.5:
                self.world.change(Element(names[0]), *self.world.inputs)

    def _take_names(self, new: dict[str, str]) -> None:
        self.world.change(
            *(
                item.renamed(new[item.name]) if new.get(item.name, item.name) != item.name else item
                for item in self.world.inputs
            )
        )

    def rename_silently(self) -> None:
        self.rename(declared=False)

    def retype(self) -> None:
        old = self.chance.choice(self.world.inputs)
        new = replace(old, type=self.chance.choice(TYPES))
        self.world.change(*(new if item == old else item for item in self.world.inputs))

    def reorder(self) -> None:
        order = list(self.world.inputs)
        self.chance.shuffle(order)
        self.world.change(*order)

    def template(self) -> None:
        self.world.version = min(VERSIONS, self.world.version + self.chance.choice((1, 1, 2)))

    def edit(self) -> str:
        regions = self.world.document().regions
        name = self.chance.choice(sorted(regions)).removeprefix("input:")
        return self.world.edit(name, self.chance.randrange(5), keep=self.chance.random() < 0.8)

    def edit_outside(self) -> None:
        self.world.edit_outside(self.chance.choice(PLACES))

    def other_file(self) -> None:
        self.world.write_other(self.chance.choice(("README.md", ".gitignore", ADDED, "mine.py")))

    def line_ends(self) -> None:
        path = self.world.package / self.world.main
        data = path.read_bytes().replace(b"\r\n", b"\n")
        path.write_bytes(data.replace(b"\n", b"\r\n") if self.chance.random() < 0.7 else data)

    def mode(self) -> None:
        self.world.change_mode(self.chance.choice((0o600, 0o644, 0o664, 0o755, 0o444)))

    def link(self) -> None:
        self.world.toggle_link()

    def replace_everywhere(self) -> None:
        """Replace in all files, and change something else before the next operation."""
        self.world.replace_everywhere(self.chance)
        if self.chance.random() < 0.7:
            self._some_change()
        word = self.chance.choice(OPERATIONS)
        self.run("recopy" if word == "update" and self.refuses_update() else word)

    def refuses_update(self) -> bool:
        """See that Copier does not begin: it would take the replaced line for its own."""
        before = snapshot(self.world.package)
        assert self.world.update().status == 1
        assert snapshot(self.world.package) == before
        return True

    # what runs ---------------------------------------------------------------------------------
    def run(self, word: str) -> None:
        result = getattr(self.world, word)()
        note(f"  -> {result.status} {result.words}")
        assert result.status in ((0, 3) if word in {"generate", "upgrade"} else (0,)), result
        self.world.settle()
        self.world.check()

    def copy(self) -> None:
        self.run("copy")

    def recopy(self) -> None:
        self.run("recopy")

    def update(self) -> None:
        self.run("update")

    def generate(self) -> None:
        self.run("generate")

    def upgrade(self) -> None:
        self.run("upgrade")

    def kill(self) -> None:
        """Kill an operation; the person goes on writing before the next one."""
        self._some_change()
        word = self.chance.choice(OPERATIONS)
        seconds = {"update": 0.8, "generate": 0.4, "upgrade": 0.4}.get(word, 0.25)
        if word == "generate" and self.world.platform == "ros1":
            seconds = 1.5
        self.world.seen.append(self.world.inputs)
        self.world.killed(getattr(self.world, word), self.chance.random() ** 0.7 * seconds)
        self.world.is_cut = True
        self.world.check(finished=False)
        if self.chance.random() < 0.5:
            self.edit()
        if self.chance.random() < 0.3:
            self._some_change()
        DONE[f"kill {word}"] += 1
        again = self.chance.choice(OPERATIONS)
        note(f"  killed {word}, then {again}")
        answers = self.world.package / ".copier-answers.yml"
        if not answers.read_bytes().endswith(b"\n"):  # Copier writes it in two steps
            DONE["answers cut"] += 1
            git(self.world.workspace, "checkout", "--", str(answers))
        if again == "update":  # committed half-way, the rest looks like a person's edit to Copier
            assert self.world.update().status in {0, 1}  # or it is refused for that
            self.world.check(finished=False)
            again = self.chance.choice([word for word in OPERATIONS if word != "update"])
        self.run(again)

    def save(self, words: tuple[str, ...] = ("generate", "upgrade")) -> None:
        """Save a file while an operation runs: it is refused, or both are in it."""
        self._some_change()
        word = self.chance.choice(words)
        late: set[str] = set()  # written when the file was replaced already

        def person() -> None:
            replaced = self.world.is_replaced()
            token = self.edit()
            late.update([token] if replaced else [])

        with pytest.MonkeyPatch.context() as context:
            operation = getattr(self.world, word)
            result = saved_at(self.chance.randrange(40), operation, person, context)
        note(f"  {word} -> {result.status} {result.words}")
        assert result.status in {0, 2, 3}, result
        DONE[f"saves during a run, {'refused' if result.status == 2 else 'merged'}"] += 1
        if result.status == 2:
            assert "while this command was running" in result.words
            self.world.check(finished=False)
            self.run(word)
        else:
            DONE["saves in the new file"] += len(late)
            self.world.settle(late)
            self.world.check()

    def two(self) -> None:
        """Run two operations at once."""
        self._some_change()
        words = [self.chance.choice(("generate", "upgrade", "copy")) for _ in range(2)]
        self.world.seen.append(self.world.inputs)
        done = self.world.both(*(getattr(self.world, word) for word in words))
        note(f"  {words} -> {done}")
        assert set(done) <= {0, 2, 3}, done
        DONE["two runs at once"] += 1
        self.world.check(finished=False)
        self.run(self.chance.choice(words))

    def branches(self) -> None:
        """Write on two branches, of which one may be generated anew, and merge them by region.

        Git's part is tested with git; a conflict is one where git would stop, and is undone here.
        """
        world, base, before = self.world, self.world.text(), set(self.world.lines)
        for _ in range(self.chance.randint(1, 3)):
            if self.chance.random() < 0.6:
                world.edit(self.chance.choice(sorted(world.document().regions))[6:])
            else:
                world.edit_outside(self.chance.choice(("import", "helper", "behind", "init")))
        theirs = world.text()
        written = {token: world.lines.pop(token) for token in world.lines.keys() - before}
        world.write(base)
        rendered = self.chance.random() < 0.5
        if rendered:
            self._some_change()
            self.run(self.chance.choice(OPERATIONS))
        else:
            self.edit()
        merged = join_branches(world.main, base, world.text(), theirs)
        DONE[f"branches, {'a conflict' if merged.conflict else 'merged'}"] += 1
        if not merged.conflict:
            world.write(merged.text)
            world.lines |= written
            world.check(finished=rendered)

    def broken(self) -> None:
        """Break a marker: nothing of the file is touched; then repair it."""
        self._some_change()
        whole = self.world.damage(self.chance.randrange(100))
        self.world.commit()
        before = snapshot(self.world.package)
        word = self.chance.choice(OPERATIONS)
        result = getattr(self.world, word)()
        after = snapshot(self.world.package)
        if word in {"generate", "upgrade"}:
            assert result.status == 2, result
        if word in {"update", "generate", "upgrade"}:
            assert after == before
        else:
            self.world.seen.append(self.world.inputs)
        assert after[self.world.main] == before[self.world.main]
        self.world.write(whole)
        self.world.check(finished=False)

    def model_change(self) -> None:
        getattr(self, self.chance.choice([word for word in CHANGES if word != "template"]))()

    def _some_change(self) -> None:
        getattr(self, self.chance.choice(CHANGES))()

    def _names(self) -> list[str]:
        return [item.name for item in self.world.inputs]


WORDS = (
    *OPERATIONS, *OPERATIONS, *CHANGES, *CHANGES,
    "edit", "edit", "edit", "edit", "edit_outside", "edit_outside", "edit_outside",
    "other_file", "other_file", "other_file",
    "line_ends", "kill", "broken", "save", "two", "mode", "link", "branches", "replace_everywhere",
)  # fmt: skip


@settings(
    deadline=None,
    max_examples=400 if long_profile() else 3,
    suppress_health_check=list(HealthCheck),
    phases=(Phase.explicit, Phase.generate),  # a life takes seconds: shrinking would take hours
)
@given(
    platform=st.sampled_from(["plain", "ros1"]),
    words=st.lists(st.sampled_from(WORDS), min_size=8, max_size=24),
    seed=st.integers(0, 10**9),
)
def test_no_life_loses_moves_or_doubles_a_line(
    templates: Templates, fast_folder: Path, platform: str, words: list[str], seed: int
) -> None:
    with tempfile.TemporaryDirectory(dir=fast_folder) as folder:
        world = World(Path(folder), templates, platform, elements("alpha", "beta", "gamma"))
        life = Life(world, seed)
        life.run("copy")
        world.commit()
        for word in words:
            life.act(word)
        life.run(life.chance.choice(OPERATIONS))
        DONE["sequences"] += 1
