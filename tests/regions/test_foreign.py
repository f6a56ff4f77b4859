"""Hand edits by themselves: the template of the README with real Copier, and a distribution."""

from __future__ import annotations

import random
import re
import shutil
import subprocess
import sys
import venv
import warnings
from pathlib import Path
from typing import Any

import copier
import pytest

from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions.marked_file import Region, parse
from tests.checkouts import git
from tests.data_files import write_files

pytestmark = pytest.mark.slow

TOOL = Path(command.__file__).parent
README = TOOL / "README.md"
_FILE = re.compile(r"<!-- file: (.+?) -->\n```\w+\n(.*?)```", re.DOTALL)
POOL = ("load", "clean", "store", "plot", "send")


class Work:
    """A folder made of the README's template, by the real Copier."""

    def __init__(self, folder: Path) -> None:
        self.template, self.package = folder / "template", folder / "work" / "package"
        self.versions, self.steps = 0, list(POOL[:3])
        write_files(self.template, dict(_FILE.findall(README.read_text())))  # as one would type it
        shutil.copytree(TOOL, self.template / "regions", ignore=shutil.ignore_patterns("__py*"))
        git(self.template, "init", "-q")
        self.release()
        self.package.parent.mkdir()
        git(self.package.parent, "init", "-q")

    @property
    def text(self) -> str:
        return (self.package / "app.py").read_text()

    def release(self) -> None:
        """Publish a version with another text around the regions."""
        self.versions += 1
        (app,) = self.template.rglob("app.py.jinja")
        text = re.sub(
            r'"""Run all steps.*?"""', f'"""Run all steps {self.versions}."""', app.read_text()
        )
        app.write_text(text)
        git(self.template, "add", "-A", ".")
        git(self.template, "commit", "-qm", "x")
        git(self.template, "tag", f"v{self.versions}.0.0")

    def run(self, word: str) -> None:
        options: dict[str, Any] = {"data": {"steps": self.steps}, "defaults": True, "quiet": True}
        options |= {"overwrite": True, "unsafe": True}
        git(self.package.parent, "add", "-A", ".")
        git(self.package.parent, "commit", "-q", "--allow-empty", "-m", "work")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if word == "copy":
                copier.run_copy(str(self.template), self.package, **options)
            elif word == "recopy":
                copier.run_recopy(self.package, **options)
            else:
                copier.run_update(self.package, **options)

    def region(self, step: str) -> Region:
        regions = parse(self.text)[0].regions
        return next(one for id_, one in regions.items() if id_.endswith(step))

    def write(self, step: str, token: str) -> None:
        region, text = self.region(step), self.text
        before = f"{region.begin}\n{region.body}"
        assert text.count(before) == 1
        new = text.replace(before, f"{before}        self.{token} = 1\n")
        (self.package / "app.py").write_text(new)


def test_a_foreign_template_with_copier(tmp_path: Path) -> None:
    work = Work(tmp_path)
    work.run("copy")
    chance = random.Random(1)
    written: dict[str, str] = {}
    for turn, operation in enumerate(("update", "recopy", "copy")):
        step = chance.choice(work.steps)
        written[f"hand_{turn}"] = step
        work.write(step, f"hand_{turn}")
        work.steps = chance.sample(POOL, chance.randint(2, 5))
        if operation != "recopy":
            work.release()
        work.run(operation)
        compile(work.text, "app.py", "exec")
        assert f"all steps {work.versions}." in work.text
        assert re.findall(r"self\.(\w+)\(\)", work.text) == work.steps
        kept = "".join(path.read_text() for path in (work.package / ".eddi").glob("kept/*"))
        for token, home in written.items():
            assert token in (work.region(home).body if home in work.steps else kept)
            assert work.text.count(f"{token} ") <= 1


def test_the_distribution(tmp_path: Path) -> None:
    source = shutil.copytree(TOOL, tmp_path / "source", ignore=shutil.ignore_patterns("__py*"))
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(tmp_path)]
    subprocess.run([*build, str(source)], check=True, capture_output=True)
    (wheel,) = tmp_path.glob("copier_regions-*.whl")
    venv.create(tmp_path / "venv", with_pip=False, symlinks=True)
    pip = [sys.executable, "-m", "pip", "--python", str(tmp_path / "venv/bin/python")]
    subprocess.run([*pip, "install", "-q", "--no-index", "--no-deps", str(wheel)], check=True)
    package = tmp_path / "package"
    tool = str(tmp_path / "venv/bin/copier-regions")
    text = (
        "# -----Manual edit begin-----  # region: a\n{}# -----Manual edit end-----  # region: a\n"
    )
    for version, body in (("1", "x = 1\n"), ("2", "x = 2\n")):
        stage = package / ".eddi/new" / version
        stage.mkdir(parents=True)
        (stage / "app.py").write_text(f"# {version}\n{text.format(body)}")
        subprocess.run([tool, "damage", str(package)], check=True)
        subprocess.run([tool, "sync", str(package), version], check=True)
        made = (package / "app.py").read_text()
        assert f"# {version}\n" in made
        (package / "app.py").write_text(made.replace("x = 1\n", "x = 'mine'\n"))
    assert "x = 'mine'" in made
    assert subprocess.run([tool, "status", str(package)], check=False).returncode == 3
    subprocess.run([tool, "accept", str(package), "a"], check=True)
    assert subprocess.run([tool, "status", str(package)], check=False).returncode == 0
