"""The same promise under bad circumstances: git, trust, tags, kills, disks, generated files."""

from __future__ import annotations

import copy
import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.packages import generation, transaction
from eddi_scaffold.regions.store import load_orphans
from eddi_scaffold.regions.sync import sync_package
from tests.quick_copier import copier_here
from tests.updates.inputs import write_inputs
from tests.updates.templates import CHECKOUT, Templates, git, make_templates, new_version
from tests.updates.world import (
    CHANGED,
    START,
    World,
    edited_world,
    killed_at,
    long_profile,
    snapshot,
)

pytestmark = pytest.mark.slow


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    world = edited_world(templates, folder)
    world.commit()
    return world


def copier(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the real command line of Copier."""
    return subprocess.run(
        [sys.executable, "-m", "copier", *map(str, words)],
        cwd=cwd, check=False, capture_output=True, text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip


def scaffold(templates: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """Run eddi-scaffold from a checkout, which is its own template."""
    environment = {**os.environ, "PYTHONPATH": f"{templates}:{templates}/runtime_lib/src"}
    return subprocess.run(
        [sys.executable, "-m", "eddi_scaffold", *map(str, words)],
        cwd=templates, env=environment,
        check=False, capture_output=True, text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip


def data_file(world: World) -> Path:
    path = world.folder / "answers.yml"
    path.write_text(yaml.safe_dump(world.answers()))
    return path


def grow(world: World) -> None:
    world.change(*CHANGED)
    world.version += 1


# trust, tasks, git ----------------------------------------------------------------------------
@pytest.mark.parametrize("command", ["copy", "update"])
def test_without_trust_nothing_is_touched(world: World, command: str) -> None:
    grow(world)
    before = snapshot(world.workspace)
    source = [world.templates.path, world.package] if command == "copy" else [world.package]
    words = ["--defaults", "--data-file", data_file(world), *source]
    done = copier(command, *words, cwd=world.workspace)
    assert done.returncode == 4
    assert "--trust" in done.stderr
    assert snapshot(world.workspace) == before


def test_trust_in_the_settings_is_enough(world: World) -> None:
    settings = Path.home() / ".config/copier/settings.yml"
    settings.parent.mkdir(parents=True)
    settings.write_text(f"trust: ['{world.templates.path}']\n")
    grow(world)
    words = ["--defaults", "--data-file", data_file(world), "-r", world.tag]
    try:
        done = copier("update", *words, cwd=world.package)
    finally:
        shutil.rmtree(settings.parent)
    assert done.returncode == 0, done.stderr
    world.settle()
    world.check()


def test_skipped_tasks_are_made_up_for(world: World) -> None:
    """Without its task `copier copy` leaves editable files alone; migrations run all the same."""
    grow(world)
    mine, templates = world.text(), world.templates.path
    words = [
        "--trust",
        "--defaults",
        "--skip-tasks",
        "--data-file",
        data_file(world),
        "-r",
        world.tag,
    ]
    done = copier_here("copy", "-f", *words, templates, world.package, cwd=world.workspace)
    assert done.returncode == 0, done.stderr
    assert world.text() == mine
    world.check(finished=False)
    world.commit()
    world.version += 1
    done = copier_here("update", *words[:-1], world.tag, cwd=world.package)
    assert done.returncode == 0, done.stderr
    world.settle()
    world.check()


@pytest.mark.parametrize("operation", ["generate", "upgrade", "copy"])
def test_after_skipped_tasks_nothing_of_ours_is_called_yours(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    grow(world)
    words = ["--trust", "-f", "--skip-tasks", "--data-file", data_file(world), "-r", world.tag]
    done = copier_here("recopy", *words, cwd=world.package)
    assert done.returncode == 0, done.stderr
    world.version += 1
    result = getattr(world, operation)()
    assert result.status in {0, 3}, result
    assert "your text" not in result.words + capfd.readouterr().err
    assert not (world.package / ".eddi/rejects").exists()
    world.settle()
    world.check()


def test_first_copy_without_tasks_is_complete(templates: Templates, folder: Path) -> None:
    world = World(folder, templates, "plain", START)
    words = [
        "--trust",
        "--defaults",
        "--skip-tasks",
        "--data-file",
        data_file(world),
        "-r",
        "v0.1.0",
    ]
    done = copier_here("copy", *words, templates.path, world.package, cwd=folder)
    assert done.returncode == 0, done.stderr
    world.seen = [START]
    world.edit("beta")
    grow(world)
    assert world.copy().status == 0
    world.settle()
    world.check()


@pytest.mark.parametrize("operation", ["copy", "recopy", "generate", "upgrade"])
def test_without_git(world: World, operation: str) -> None:
    shutil.rmtree(world.workspace / ".git")
    grow(world)
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()


def test_update_without_git_touches_nothing(world: World) -> None:
    grow(world)
    shutil.rmtree(world.workspace / ".git")
    before = snapshot(world.workspace)
    done = copier(
        "update", "--trust", "--defaults", "--data-file", data_file(world), cwd=world.package
    )
    assert done.returncode != 0
    assert snapshot(world.workspace) == before


@pytest.mark.parametrize("operation", ["copy", "recopy", "generate", "upgrade"])
def test_dirty_git(world: World, operation: str) -> None:
    world.edit("alpha")
    world.edit_outside("helper")
    (world.workspace / "notes.txt").write_text("mine\n")
    status = git(world.workspace, "diff", "--cached", "--stat")
    grow(world)
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()
    assert (world.workspace / "notes.txt").read_text() == "mine\n"
    assert git(world.workspace, "diff", "--cached", "--stat") == status


def test_update_of_dirty_package_touches_nothing(world: World) -> None:
    world.edit("alpha")
    grow(world)
    before = snapshot(world.workspace)
    done = copier(
        "update", "--trust", "--defaults", "--data-file", data_file(world), cwd=world.package
    )
    assert done.returncode != 0
    assert snapshot(world.workspace) == before


# where the template comes from ------------------------------------------------------------------
def test_update_takes_the_newest_tag_by_itself(world: World) -> None:
    world.edit_outside("helper")
    world.commit()
    done = copier_here("update", "--trust", "--defaults", cwd=world.package)
    assert done.returncode == 0, done.stderr
    assert "_commit: v0.9.0\n" in (world.package / ".copier-answers.yml").read_text()
    world.settle()
    world.check()


def test_untagged_template(folder: Path, own_home: None) -> None:
    """Without a tag Copier records the commit, and an update takes the newest commit."""
    templates = make_templates(folder / "templates", versions=1, tags=False)
    world = World(folder, templates, "plain", START)
    words = ["--trust", "--defaults", "--data-file", data_file(world)]
    assert copier_here("copy", *words, templates.path, world.package, cwd=folder).returncode == 0
    world.seen = [START]
    for item in START:
        world.edit(item.name)
    world.commit()
    new_version(templates.path, 2)
    world.change(*CHANGED)
    data_file(world)
    done = copier_here("update", *words, "-r", "HEAD", cwd=world.package)
    assert done.returncode == 0, done.stderr
    assert "Second look" in world.text()
    world.settle()
    world.check()


def test_checkout_with_uncommitted_templates(folder: Path, own_home: None) -> None:
    templates = make_templates(folder / "templates", versions=1)
    name = templates.path / "copier_templates/eddi_input.py.jinja"
    name.write_text(name.read_text().replace("One attribute", "Not committed: one attribute"))
    model, config = write_inputs(folder / "inputs", START)
    world = World(folder, templates, "plain", START)
    done = scaffold(
        templates.path,
        "generate",
        "--platform",
        "plain",
        "-o",
        world.workspace,
        "-m",
        model,
        "-c",
        config,
    )
    assert done.returncode == 0, done.stderr
    assert "Not committed" in world.text()
    world.seen = [START]
    world.edit("beta")
    git(templates.path, "commit", "-qam", "now it is")
    git(templates.path, "tag", "v0.2.0")
    world.commit()
    done = copier_here("update", "--trust", "--defaults", cwd=world.package)
    assert done.returncode in {0, 1}, done.stderr
    world.check(finished=done.returncode == 0)


def test_own_commands_run_from_the_tagged_checkout(folder: Path, own_home: None) -> None:
    """`generate` and `upgrade` as a person runs them, then plain `copier update`."""
    templates = make_templates(folder / "templates", versions=1)
    world = World(folder, templates, "ros1", START)
    model, config = write_inputs(folder / "inputs", START)
    done = scaffold(templates.path, "generate", "-w", world.workspace, "-m", model, "-c", config)
    assert done.returncode == 0, done.stderr
    world.seen = [START]
    for shape, item in enumerate(START):
        world.edit(item.name, shape)
    world.commit()
    new_version(templates.path, 2)
    git(templates.path, "tag", "v0.2.0")
    world.change(*CHANGED)
    model, config = write_inputs(folder / "inputs", CHANGED)
    siblings = _siblings(world)
    done = scaffold(templates.path, "upgrade", world.package, "-m", model, "-c", config)
    assert done.returncode == 3, done.stderr
    assert "hand edits need a look" in done.stderr
    assert scaffold(templates.path, "regions", "--check", world.workspace).returncode == 3
    world.settle()
    world.check()
    assert _siblings(world) == siblings
    world.commit()
    new_version(templates.path, 3)
    git(templates.path, "tag", "v0.3.0")
    done = copier_here("update", "--trust", "--defaults", cwd=world.package)
    assert done.returncode == 0, done.stderr
    world.settle()
    world.check()
    assert _siblings(world) == siblings


def _siblings(world: World) -> dict[str, bytes]:
    return {
        name: data for name, data in snapshot(world.root).items() if not name.startswith("rover/")
    }


# kills -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("between", ["nothing", "edit", "model"])
@pytest.mark.parametrize("then", ["upgrade", "copy"])
def test_transaction_is_killed_at_every_step(
    world: World, monkeypatch: pytest.MonkeyPatch, then: str, between: str
) -> None:
    """All new or all old, and what a person writes before the next run is not overwritten."""
    old = transaction.tree_of(world.package)
    world.change(*CHANGED)
    lines = copy.deepcopy(world.lines)
    result = world.command("upgrade", world.package, "-m", *_model(world), "--dry-run")
    assert result.status == 3, result
    world.version += 1
    new = _bring_elsewhere(world)
    changes = {f"rover/{p}": new.get(p) for p in sorted({*old, *new}) if old.get(p) != new.get(p)}
    before = {f"rover/{path}": state for path, state in old.items()}
    work = generation._Work(changes, before)
    step, thorough = 0, {("upgrade", "edit"), ("copy", "model")}
    while killed_at(step, lambda: generation._write(world.root, work), monkeypatch):
        world.seen = [START, CHANGED]
        world.check(finished=False)
        if between == "edit":
            names = sorted(world.document().regions)
            world.edit(names[0].removeprefix("input:"))
            world.edit_outside("helper")
        if between == "model":
            world.change(*START)
        assert getattr(world, then)().status in {0, 3}
        world.settle()
        world.check()
        world.change(*CHANGED)
        if then == "upgrade":
            assert not list(world.root.glob(".eddi-transaction-*"))
        _put_back(world, old)
        world.lines = copy.deepcopy(lines)
        step += 1 if long_profile() else 5 if (then, between) in thorough else 10
    assert step > len(changes)


def _model(world: World) -> list[object]:
    model, config = write_inputs(world.folder / "inputs", world.inputs)
    return [model, "-c", config]


def _bring_elsewhere(world: World) -> dict[str, transaction.FileState]:
    keep = world.folder / "keep"
    shutil.copytree(world.package, keep)
    assert world.upgrade().status == 3
    new = transaction.tree_of(world.package)
    shutil.rmtree(world.package)
    keep.rename(world.package)
    return new


def _put_back(world: World, old: dict[str, transaction.FileState]) -> None:
    shutil.rmtree(world.package)
    for staging in world.root.glob(".eddi-transaction-*"):
        shutil.rmtree(staging)
    transaction.apply(world.root, {f"rover/{path}": state for path, state in old.items()}, {})


@pytest.mark.parametrize("operation", ["generate", "upgrade"])
def test_answers_that_a_killed_copier_cut_are_told(world: World, operation: str) -> None:
    (world.package / ".copier-answers.yml").write_bytes(b"")
    before = snapshot(world.workspace)
    result = getattr(world, operation)()
    assert result.status == 2
    assert ".copier-answers.yml" in result.words
    assert "git checkout -- " in result.words
    assert snapshot(world.workspace) == before


# disks ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("operation", ["copy", "generate", "upgrade"])
def test_files_that_cannot_grow(world: World, operation: str) -> None:
    """A limit on file sizes stands for a full disk: it needs no rights."""
    if operation == "copy" and not hasattr(os, "fork"):
        pytest.skip("needs fork")
    before = world.text()
    grow(world)
    child = os.fork()
    if child == 0:
        try:
            import signal

            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1500, 1500))
            getattr(world, operation)()
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    assert world.text() == before
    world.seen = [START, CHANGED]
    world.check(finished=False)
    assert world.copy().status == 0
    world.settle()
    world.check()


# a package that gets another name ----------------------------------------------------------------
def test_package_with_another_name_takes_its_code_along(templates: Templates, folder: Path) -> None:
    world = World(folder, templates, "ros1", START)
    assert world.copy().status == 0
    world.settle()
    tokens = [world.edit(item.name) for item in START]
    world.commit()
    answers = {**world.answers(), "package": "explorer"}
    assert world._copier(*_update(world), data=answers).status == 0
    text = (world.package / "src/explorer/EDDIInput.py").read_text()
    saved = "".join(orphan.body for orphan in load_orphans(world.package).values())
    for token in tokens:
        assert (text + saved).count(token) == 1
        assert token in text
    assert not (world.package / "src/rover/EDDIInput.py").exists()
    assert sync_package(world.package).touched == ()


def _update(world: World) -> tuple[Callable[..., object], Path]:
    import copier as library

    return library.run_update, world.package


def test_looks_still_fit_the_templates(templates: Templates) -> None:
    """The tests above would test nothing if all versions looked alike."""
    looks = {
        git(
            templates.path, "show", f"{templates.tag(version)}:copier_templates/eddi_input.py.jinja"
        )
        for version in (1, 2, 3)
    }
    assert len(looks) == 3
    own = CHECKOUT / "copier_templates" / "ros1_monitor" / "questions.yml"
    assert re.search(r"^_skip_if_exists:", own.read_text(), re.MULTILINE)
