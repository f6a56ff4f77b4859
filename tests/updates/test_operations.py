"""Scripted updates: each change of template, model and hand edits, with each of the operations."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from eddi_scaffold.regions.store import load_orphans
from eddi_scaffold.regions.sync import sync_package
from tests.updates.inputs import Element, elements
from tests.updates.templates import Templates
from tests.updates.world import (
    DAMAGES,
    OPERATIONS,
    Result,
    World,
    fresh_world,
    long_profile,
    operations_of,
    snapshot,
)

pytestmark = pytest.mark.slow

START = (*elements("alpha", "beta"), Element("gamma", "float"), Element("delta", "pair"))
ALPHA, BETA, GAMMA, DELTA = START
OUTSIDE = (
    "import",
    "helper",
    "docstring",
    "behind",
    "init",
    "comment",
    "manifest",
    "cmake",
    "launch",
)


@dataclass(frozen=True)
class Case:
    """What changes between two operations.

    Attributes:
        inputs: the new model.
        looks: steps of the template's version.
        outside: also edits outside of the regions.
        moved: input -> where its hand-written body must be, ``None``: saved.
        status: exit status of our own commands.
    """

    inputs: tuple[Element, ...] = START
    looks: int = 0
    outside: bool = False
    moved: tuple[tuple[str, str | None], ...] = ()
    status: int = 0


NEW = elements("first", "middle", "last")
MIXED = (DELTA, *NEW, BETA.renamed("bravo"), ALPHA)
CASES = {
    "template": Case(looks=1),
    "template_twice": Case(looks=2),
    "add_first_middle_last": Case((NEW[0], ALPHA, BETA, NEW[1], GAMMA, DELTA, NEW[2])),
    "retype": Case(
        (ALPHA, replace(BETA, type="text"), GAMMA, replace(DELTA, type="float")), status=3
    ),
    "rename": Case(
        (ALPHA, BETA.renamed("bravo"), GAMMA, DELTA), moved=(("beta", "bravo"),), status=3
    ),
    "swap": Case(
        (ALPHA.renamed("beta"), BETA.renamed("alpha"), GAMMA, DELTA),
        moved=(("alpha", "beta"), ("beta", "alpha")),
        status=3,
    ),
    "renumber": Case(
        (Element("alpha"), ALPHA.renamed("beta"), GAMMA, BETA.renamed("delta"), DELTA.renamed("e")),
        looks=1,
        moved=(("alpha", "beta"), ("beta", "delta"), ("delta", "e")),
        status=3,
    ),
    "rename_silently": Case(
        (ALPHA, BETA.renamed("bravo", declared=False), GAMMA, DELTA),
        moved=(("beta", None),),
        status=3,
    ),
    "remove_first": Case((BETA, GAMMA, DELTA), moved=(("alpha", None),), status=3),
    "reorder": Case((DELTA, GAMMA, BETA, ALPHA)),
    "swap_names": Case((BETA, ALPHA, DELTA, GAMMA)),
    "remove_and_add": Case(
        (NEW[0], BETA, NEW[1], DELTA), moved=(("alpha", None), ("gamma", None)), status=3
    ),
    "outside": Case(outside=True),
    "template_and_outside": Case(looks=1, outside=True, status=3),
    "everything": Case(
        MIXED, 1, outside=True, moved=(("beta", "bravo"), ("gamma", None)), status=3
    ),
}


@pytest.fixture
def plain(templates: Templates, folder: Path) -> World:
    return _committed(templates, folder, "plain")


def _committed(templates: Templates, folder: Path, platform: str) -> World:
    world = fresh_world(templates, folder, platform, START)
    world.commit()
    return world


@pytest.mark.parametrize(
    ("case", "platform", "operation"),
    # `generate` for ROS renders six packages: in the quick profile only where most can be lost
    [
        (c, p, operation)
        for number, c in enumerate(CASES)
        for p in ("plain", "ros1")
        if long_profile() or (p == "ros1") == CASES[c].outside
        for operation in operations_of(number)
    ],
)
def test_edits_survive(
    templates: Templates, folder: Path, case: str, platform: str, operation: str
) -> None:
    change, world = CASES[case], _committed(templates, folder, platform)
    tokens = {item.name: world.edit(item.name, shape) for shape, item in enumerate(START)}
    if change.outside:
        for kind in OUTSIDE:
            assert world.edit_outside(kind) or platform == "plain", kind
    world.commit()
    world.version += change.looks
    world.change(*change.inputs)
    result: Result = getattr(world, operation)()
    if operation in {"generate", "upgrade"}:
        assert result.status == change.status, result
    assert result.status in {0, 3}, result
    world.settle()
    world.check()
    _check_places(world, tokens, dict(change.moved))
    before = snapshot(world.package)
    assert sync_package(world.package).touched == ()
    assert snapshot(world.package) == before


@pytest.mark.parametrize("operation", ["copy", "update"])
def test_edits_survive_on_ros2(templates: Templates, folder: Path, operation: str) -> None:
    """The merge is that of the other platforms, the places are others."""
    change, world = CASES["renumber"], _committed(templates, folder, "ros2")
    tokens = {item.name: world.edit(item.name, shape) for shape, item in enumerate(START)}
    world.commit()
    world.version += change.looks
    world.change(*change.inputs)
    result: Result = getattr(world, operation)()
    assert result.status in {0, 3}, result
    world.settle()
    world.check()
    _check_places(world, tokens, dict(change.moved))


def _check_places(world: World, tokens: dict[str, str], moved: dict[str, str | None]) -> None:
    regions = world.document().regions
    saved = {orphan.id: orphan.body for orphan in load_orphans(world.package).values()}
    for name, token in tokens.items():
        now = moved.get(name, name)
        assert token in (regions[f"input:{now}"].body if now else saved[f"input:{name}"])


@pytest.mark.parametrize("operation", operations_of(1))
def test_removed_body_comes_back_two_updates_later(plain: World, operation: str) -> None:
    token = plain.edit("beta")
    plain.commit()
    run = _run(plain, operation)
    plain.change(ALPHA, GAMMA, DELTA)
    run()
    plain.version += 1
    run()
    plain.change(DELTA, BETA, ALPHA, GAMMA)
    run()
    assert token in plain.document().regions["input:beta"].body
    assert not load_orphans(plain.package)


@pytest.mark.parametrize("operation", operations_of(0))
def test_a_swap_that_stays_declared_is_made_once(plain: World, operation: str) -> None:
    alpha, beta = plain.edit("alpha"), plain.edit("beta")
    plain.commit()
    plain.change(ALPHA.renamed("beta"), BETA.renamed("alpha"), GAMMA, DELTA)
    for version in (1, 2, 2):
        plain.version = version
        _run(plain, operation)()
        regions = plain.document().regions
        assert alpha in regions["input:beta"].body
        assert beta in regions["input:alpha"].body


@pytest.mark.parametrize("operation", operations_of(1))
def test_crlf_files_stay_crlf(plain: World, operation: str) -> None:
    for shape, item in enumerate(START):
        plain.edit(item.name, shape)
    path = plain.package / plain.main
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    plain.edit_outside("helper")
    plain.version += 1
    plain.change(DELTA, *NEW, BETA.renamed("bravo"), GAMMA)
    _run(plain, operation)()
    data = path.read_bytes()
    assert data.count(b"\n") == data.count(b"\r\n")


@pytest.mark.parametrize(
    ("operation", "kind"),
    [
        *((operation, 0) for operation in operations_of(0)),
        *((OPERATIONS[k % 5], k) for k in range(1, DAMAGES)),
    ],
)
def test_broken_markers_are_left_alone(plain: World, operation: str, kind: int) -> None:
    plain.edit("beta")
    whole = plain.damage(DAMAGES + kind)
    plain.commit()
    plain.version += 1
    plain.change(BETA, ALPHA)
    before = snapshot(plain.workspace)
    result: Result = getattr(plain, operation)()
    after = snapshot(plain.workspace)
    if operation in {"generate", "upgrade"}:
        assert result.status == 2
        assert "EDDIInput.py:" in result.words
        assert "[H010]" in result.words
    if operation in {"update", "generate", "upgrade"}:
        assert after == before
    assert after["rover/EDDIInput.py"] == before["rover/EDDIInput.py"]
    plain.write(whole)
    plain.seen = [START, plain.inputs]
    _run(plain, operation)()


def test_broken_markers_are_told_by_plain_copier(
    plain: World, capfd: pytest.CaptureFixture[str]
) -> None:
    plain.damage(0)
    line = next(
        n for n, text in enumerate(plain.text().split("\n"), 1) if "---Manual edit begin" in text
    )
    assert plain.copy().status == 0
    _assert_reported(capfd.readouterr().err, line)
    assert plain.update().status == 1
    _assert_reported(capfd.readouterr().err, line)


def _assert_reported(words: str, line: int) -> None:
    assert re.search(r"^EDDIInput.py:\d+: error: ", words, re.MULTILINE)
    assert f"line {line}" in words


@pytest.mark.parametrize("operation", operations_of(0))
def test_code_that_does_not_compile(plain: World, operation: str) -> None:
    region = plain.document().regions["input:beta"]
    plain.put(region, "        if so\n")
    plain.commit()
    before = snapshot(plain.workspace)
    plain.version += 1
    result: Result = getattr(plain, operation)()
    if operation in {"generate", "upgrade"}:
        assert result.status == 2
        assert "[H011]" in result.words
        assert snapshot(plain.workspace) == before
    assert plain.document().regions["input:beta"].body == "        if so\n"


def _run(world: World, operation: str) -> Callable[[], None]:
    def run() -> None:
        result: Result = getattr(world, operation)()
        assert result.status in {0, 3}, result
        world.settle()
        world.check()

    return run
