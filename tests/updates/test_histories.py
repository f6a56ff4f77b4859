"""Random histories: after each command every text is in its region, or kept, or it is said."""

from __future__ import annotations

import copy
import random
import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.updates.lives import (
    OPERATIONS,
    START,
    Bare,
    Life,
    Real,
    delete,
    histories,
    live,
    own_file,
    parsed,
    snapshot,
    texts,
    tidy,
)
from tests.updates.templates import Templates, git
from tests.updates.world import World

pytestmark = pytest.mark.slow
_TOKEN = re.compile(r"\b(?:mine|ours|theirs)_\d+_")
_IN_BRANCHES = {act: n for act, n in OPERATIONS.items() if act not in {own_file, tidy, delete}}


@contextmanager
def told(seed: int, *lives: Life) -> Iterator[None]:
    """Say what had happened when something fails."""
    try:
        yield
    except AssertionError as failed:
        failed.add_note(f"history {seed}\n" + "\n".join(line for one in lives for line in one.log))
        raise


@pytest.mark.parametrize("part", range(10))
def test_a_sync_loses_doubles_and_moves_nothing(folder: Path, part: int) -> None:
    for seed in range(part, histories(20, 3000), 10):
        life = Life(Bare(folder / str(seed)), random.Random(seed))
        with told(seed, life):
            live(life.begin(), 8, ("generate", "generate", "killed"))


@pytest.mark.parametrize("seed", range(histories(1, 60)))
def test_nor_do_the_commands(folder: Path, templates: Templates, seed: int) -> None:
    life = Life(Real(World(folder, templates, START)), random.Random(seed))
    with told(seed, life):
        live(life.begin(), histories(3, 5), ("generate", "upgrade", "copy", "recopy", "update"))


@pytest.mark.parametrize("part", range(10))
def test_nor_does_a_merge_of_branches(folder: Path, part: int) -> None:
    for seed in range(part, histories(10, 500), 10):
        branches(folder / str(seed), seed)


def branches(folder: Path, seed: int) -> str:
    """Let two branches write and generate, bring them together, and generate; say what came."""
    base = Life(Bare(folder), random.Random(seed))
    with told(seed, base):
        live(base.begin(), 2, operations=_IN_BRANCHES)
    package = base.place.package
    git(package, "init", "-q", "-b", "ours")
    _commit(package)
    git(package, "branch", "theirs")
    lives = []
    for name in ("theirs", "ours"):
        git(package, "checkout", "-q", name)
        life = copy.deepcopy(base)
        life.name, life.log, life.chance = name, [name], random.Random(f"{seed} {name}")
        with told(seed, base, life):
            live(life, 1, operations=_IN_BRANCHES)
        _commit(package)
        lives.append(life)
    theirs, ours = lives
    inputs = _merged(base, ours, theirs)
    if len({one.id for one in inputs.values()}) < len(inputs) or not inputs:
        return "the models cannot be merged"
    way = base.chance.choice(["merge", "back", "rebase", "cherry-pick"])
    git(package, "checkout", "-q", "theirs" if way in {"back", "rebase"} else "ours")
    words = {"back": ("merge", "ours"), "rebase": ("rebase", "ours")}.get(way, (way, "theirs"))
    merging = ("git", "-C", package, *words)
    done = subprocess.run(merging, check=False, capture_output=True, text=True)
    base.place.inputs = tuple(inputs.values())
    changed = ours.place.template != base.place.template
    base.place.template = (ours if changed else theirs).place.template
    before = snapshot(package)
    synced = base.place.bring("generate")
    with told(seed, base, ours, theirs):
        base.log.append(f"{way}: {done.stdout}\n{synced}")
        base.log.append(f"{base.place.inputs} {base.place.template}")
        owners = {f"process_{one.id}": owner for owner, one in inputs.items()}
        if synced.status == 2:
            # Git tears markers apart where one branch moves a region that the other renames.
            assert re.search(
                "both branches wrote|another meaning|second region|marker", synced.said
            ), synced
            assert snapshot(package) == before
            for id_ in re.findall(r"both branches wrote in region '(.+?)'", synced.said):
                bodies = [one.body_of(id_) for one in (base, ours, theirs)]
                assert len(set(bodies)) == 3, f"{id_} was written by one branch only: {bodies}"
            git(package, "read-tree", "--reset", "-u", "ours")  # a person's choice
            assert base.place.bring("generate").status in {0, 3}
            return "refused"
        _check(base, ours, theirs, owners)
        _commit(package)
        after = snapshot(package)
        assert base.place.bring("generate").status in {0, synced.status}
        assert snapshot(package) == after
    return "conflict" if done.returncode else "clean"


def _merged(base: Life, ours: Life, theirs: Life) -> dict[str, object]:
    """Return the inputs of both branches, by owner."""
    old, mine, other = (
        {one.who[x.id]: x for x in one.place.inputs} for one in (base, ours, theirs)
    )
    merged = {}
    for owner in [*mine, *(x for x in other if x not in mine)]:
        if owner not in old:
            merged[owner] = mine.get(owner) or other[owner]
        elif owner in mine and owner in other:
            merged[owner] = mine[owner] if mine[owner] != old[owner] else other[owner]
    return merged


def _commit(package: Path) -> None:
    git(package, "add", "-A")
    git(package, "commit", "-q", "--allow-empty", "-m", "work")


def _tokens(life: Life) -> dict[str, str | None]:
    """Return every line of a person, with the owner of the region where it is."""
    bodies = {owner: one.text for owner, one in life.written.items()}
    found: dict[str, str | None] = {}
    for text in [*(one.text for _, one in life.kept), *(data.decode() for data in life.copies)]:
        found |= dict.fromkeys(_TOKEN.findall(text))
    return found | {
        token: owner for owner, text in bodies.items() for token in _TOKEN.findall(text)
    }


def _check(base: Life, ours: Life, theirs: Life, inputs: dict[str, str]) -> None:
    old, mine, other = (_tokens(one) for one in (base, ours, theirs))
    shown = base.place.rendering()
    now = texts(base.place.package)
    where: dict[str, list[str]] = {}
    for name, text in shown.items():
        assert parsed(now[name]).outside == parsed(text).outside, f"{name} is not as it is rendered"
        for id_, one in parsed(now[name]).regions.items():
            for token in _TOKEN.findall(one.body):
                where.setdefault(token, []).append(inputs.get(id_, id_))
    kept = (base.place.package / ".eddi/kept").rglob("*")
    saved = "".join(path.read_bytes().decode() for path in kept if path.is_file())
    for token in mine.keys() | other.keys():
        if token in old and not (token in mine and token in other):
            continue  # somebody removed it
        owner = mine.get(token) or other.get(token)
        places = where.get(token, [])
        assert token in saved or places, f"{token} of {owner} is lost"
        assert places in ([], [owner or "".join(places)]), f"{token} of {owner} is in {places}"
