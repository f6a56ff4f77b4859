"""The merge of hand edits by itself: the template of its README, and a distribution of its own."""

from __future__ import annotations

import importlib.util
import random
import re
import shutil
import subprocess
import sys
import tempfile
import venv
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import copier
import pytest
from eddi_scaffold.regions.bases import bases_of
from eddi_scaffold.regions.merge import merge
from eddi_scaffold.regions.result import Merged
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.regions.rendering import Package, elements
from tests.regions.test_property import ACTIONS, Life, Tool
from tests.regions.test_sync import git

from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions import names
from eddi_scaffold.regions.marked_file import parse
from tests.regions import rendering

pytestmark = pytest.mark.slow

TOOL = Path(command.__file__).parent
README = TOOL / "README.md"
_FILE = re.compile(r"<!-- file: (\S+) -->\n```\w+\n(.*?)```", re.DOTALL)
POOL = ("load", "clean", "store", "plot", "send")
STEPS = ["load", "clean", "store"]
# What is planned upstream changes when, and whether, Copier calls the tool.
ORDERS: dict[str, Callable[[str], str]] = {
    "as it is": lambda text: text,
    "tasks after an update, too": lambda text: text.replace(
        "\"{{ _copier_operation == 'copy' }}\"", "true"
    ),
    "no task in an update, no migration": lambda text: re.sub(
        r"_migrations:.*?(?=steps:)", "", text, flags=re.DOTALL
    ),
    "the check comes last": lambda text: text.replace("_stage == 'before'", "_stage == 'after'"),
    "no check": lambda text: text.replace("_stage == 'before'", "false"),
}


class Work:
    """A folder made of the README's template, by the real Copier."""

    def __init__(self, folder: Path, order: str) -> None:
        self.template, self.package = folder / "template", folder / "work" / "package"
        self.versions, self.steps = 0, list(STEPS)
        for name, content in _FILE.findall(README.read_text()):  # as its author would type it
            (self.template / name).parent.mkdir(parents=True, exist_ok=True)
            (self.template / name).write_text(content)
        shutil.copytree(TOOL, self.template / "regions", ignore=shutil.ignore_patterns("__py*"))
        settings_file = self.template / "copier.yml"
        text = settings_file.read_text()
        settings_file.write_text(ORDERS[order](text))
        assert (settings_file.read_text() == text) == (order == "as it is")
        git(self.template, "init", "-q")
        self.release()
        self.package.parent.mkdir()
        git(self.package.parent, "init", "-q")

    def release(self) -> None:
        """Publish a version with another text around each region."""
        self.versions += 1
        app = self.template / "template" / "app.py.jinja"
        text = re.sub(
            r'"""(\w+) (\w+).*?\."""', rf'"""\1 \2 ({self.versions})."""', app.read_text()
        )
        app.write_text(text)
        git(self.template, "add", "-A", ".")
        git(self.template, "commit", "-qm", "x")
        git(self.template, "tag", f"v{self.versions}.0.0")

    def run(self, word: str) -> None:
        options: dict[str, Any] = {"data": {"steps": self.steps}, "defaults": True, "quiet": True}
        options |= {"overwrite": True, "unsafe": True}
        self.commit()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if word == "copy":
                copier.run_copy(str(self.template), self.package, **options)
            else:
                {"recopy": copier.run_recopy, "update": copier.run_update}[word](
                    self.package, **options
                )

    def sync(self) -> None:
        words = [sys.executable, str(self.template / "regions"), "--folder", ".regions", "sync"]
        subprocess.run(words, cwd=self.package, check=True)

    def commit(self) -> None:
        git(self.package.parent, "add", "-A", ".")
        git(self.package.parent, "commit", "-q", "--allow-empty", "-m", "work")

    def body(self, step: str) -> str:
        return parse((self.package / "app.py").read_text())[0].regions[f"step:{step}"].body

    def write(self, step: str, token: str) -> None:
        file, body = self.package / "app.py", self.body(step)
        region = parse(file.read_text())[0].regions[f"step:{step}"]
        new = f"{region.begin}\n{body}        self.{token} = 1\n"
        file.write_text(file.read_text().replace(f"{region.begin}\n{body}", new))


@pytest.mark.parametrize("order", ORDERS)
def test_a_foreign_template_with_copier(tmp_path: Path, order: str) -> None:
    work = Work(tmp_path, order)
    work.run("copy")
    chance = random.Random(order)
    written: dict[str, str] = {}
    outside = "import by_hand\n"
    text = (work.package / "app.py").read_text()
    (work.package / "app.py").write_text(text.replace("\n\n\nclass", f"\n\n{outside}\n\nclass"))
    for turn, operation in enumerate(("update", "recopy", "update", "copy", "update")):
        step = chance.choice(work.steps)
        written[f"hand_{turn}"] = step
        work.write(step, f"hand_{turn}")
        work.steps = chance.sample(POOL, chance.randint(2, 5))
        if operation != "recopy":
            work.release()
        work.run(operation)
        if order.startswith("no task in an update"):
            work.sync()
        text = (work.package / "app.py").read_text()
        compile(text, "app.py", "exec")
        assert outside in text
        assert f"({work.versions})" in text
        assert re.findall(r"self\.(\w+)\(\)", text) == work.steps
        for token, home in written.items():
            orphans = work.package / ".regions" / "orphans"
            saved = "".join(p.read_text() for p in orphans.glob("*")) if orphans.exists() else ""
            assert token in (work.body(home) if home in work.steps else saved)
            assert text.count(f"{token} ") <= 1
    assert not (work.package / ".eddi").exists()


def test_damaged_markers_stop_an_update(tmp_path: Path) -> None:
    work = Work(tmp_path, "as it is")
    work.run("copy")
    file = work.package / "app.py"
    file.write_text(file.read_text().replace("Manual edit", "Manual Edit"))
    before = file.read_text()
    work.release()
    with pytest.raises(Exception, match="exit"):
        work.run("update")
    assert file.read_text() == before


@pytest.fixture(scope="module")
def alone() -> Tool:
    """The folder as a package of its own, with a name of its own for the records."""
    path = TOOL / "__init__.py"
    spec = importlib.util.spec_from_file_location("copier_regions", path)
    assert spec is not None
    sys.modules["copier_regions"] = importlib.util.module_from_spec(spec)
    importlib.import_module("copier_regions.names").choose(".hand")
    sync, store, check = (
        importlib.import_module(f"copier_regions.{name}") for name in ("sync", "store", "check")
    )
    return Tool(sync.sync_package, store.load_orphans, check.broken_files)


class ForeignLife(Life):
    """A life in which Copier calls the tool in any order, and may place bodies by itself."""

    records = ".hand"

    def rendered(self) -> None:
        super().rendered()
        order = self.chance.choice(("sync", "check", "ignore", "check and ignore"))
        if "ignore" in order:
            for path in self.package.files:
                self._ignore(path)
        if "check" in order:
            assert not self.tool.check(self.root)

    def _ignore(self, path: str) -> None:
        """Do what a Copier does that leaves regions alone and merges the rest."""
        bases = self.root / self.records / "bases"
        base = bases_of(bases.read_text()).get(path) if bases.exists() else None
        if base is None or any(token in base for token in self.replaced):
            return  # Copier's own is never touched
        theirs = rendering.RENDER[path](self.package)
        mine = (self.root / path).read_bytes().decode()
        merged = merge(path, base, mine, theirs)
        if isinstance(merged, Merged) and merged.text and not (merged.orphans or merged.patch):
            (self.root / path).write_bytes(merged.text.encode())


@settings(deadline=None, suppress_health_check=list(HealthCheck))
@given(
    actions=st.lists(st.tuples(st.sampled_from(ACTIONS), st.booleans()), min_size=8, max_size=16),
    seed=st.integers(0, 10**6),
)
def test_lives_on_the_foreign_template(
    alone: Tool, actions: list[tuple[str, bool]], seed: int
) -> None:
    with tempfile.TemporaryDirectory() as folder, patch("os.fsync"):
        life = ForeignLife(Path(folder), random.Random(seed), alone)
        for action, kill in actions:
            life.act(action, kill=kill)


def test_the_distribution(tmp_path: Path) -> None:
    own = ["--no-isolation"] if importlib.util.find_spec("hatchling") else []
    source = shutil.copytree(TOOL, tmp_path / "source", ignore=shutil.ignore_patterns("__py*"))
    build = [sys.executable, "-m", "build", "--wheel", *own, "--outdir", str(tmp_path), str(source)]
    subprocess.run(build, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("copier_regions-*.whl")
    venv.create(tmp_path / "venv", with_pip=False, symlinks=True)
    pip = [sys.executable, "-m", "pip", "--python", str(tmp_path / "venv/bin/python")]
    subprocess.run([*pip, "install", "-q", "--no-index", "--no-deps", str(wheel)], check=True)
    package = tmp_path / "package"
    rendering.render(package, Package(elements("a", "b")), ".hand")
    tool = [str(tmp_path / "venv/bin/copier-regions"), "--folder", ".hand"]
    subprocess.run([*tool, "sync"], cwd=package, check=True)
    rendering.render(package, Package(elements("b", "c"), 2), ".hand")
    subprocess.run([*tool, "check"], cwd=package, check=True)
    subprocess.run([*tool, "sync"], cwd=package, check=True)
    text = (package / rendering.INPUT).read_text()
    assert "process_c" in text
    assert "process_a" not in text


def test_the_folder_knows_nothing_of_ours() -> None:
    """But for two names, of which ``--folder`` changes one, and the other is of a folder."""
    for file in TOOL.glob("*.py"):
        code = re.sub(r'""".*?"""', "", file.read_text(), flags=re.DOTALL)
        named = {"eddi-scaffold"} if file.name in {"names.py", "state.py"} else set()
        assert {*re.findall(r"(?i)eddi.?(?:scaffold|input)", code)} <= named, file
    with patch.multiple(names, folder=".eddi", upgrade=names.upgrade):
        names.choose(".hand")
        assert names.upgrade == ""
