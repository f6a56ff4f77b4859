"""Branches of a package merged by git with the driver: every body in its region, or a conflict."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions.branches import join_branches, join_manifests
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.store import write_file
from eddi_scaffold.regions.sync import sync_package
from tests.regions.rendering import (
    CMAKE,
    INPUT,
    MANIFEST,
    NETWORK,
    RENDER,
    Element,
    Package,
    elements,
)  # fmt: skip
from tests.regions.test_branches import commit, generate
from tests.regions.test_sync import body, git, write_hand

A, B, C, D = elements("a", "b", "c", "d")
DRIVER = f"{sys.executable} {Path(command.__file__).parent} merge-driver %O %A %B %P"
FILES = f"/.eddi/** merge=regions\n/{INPUT} merge=regions\n/{NETWORK} merge=regions\n"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "work" / "pkg"
    write_file(root, ".eddi/.gitignore", b"")  # a template that has the renderings in git
    generate(root, Package((A, B)))
    attributes = FILES + f"/{MANIFEST} merge=regions\n/{CMAKE} merge=regions\n"
    (root / ".gitattributes").write_text(attributes)
    git(root.parent, "init", "-q", "-b", "main")
    git(root, "config", "merge.regions.driver", DRIVER)
    commit(root)
    git(root, "branch", "side")
    return root


def merge(root: Path, *options: str) -> bool:
    """Merge `side` into `main`; returns whether git found no conflict."""
    words = ["git", "-c", "user.name=T", "-c", "user.email=t@example.org", "merge", "-q"]
    done = subprocess.run([*words, *options, "side"], cwd=root, capture_output=True, check=False)
    assert done.returncode in {0, 1}, done
    return done.returncode == 0


def broken(root: Path) -> list[str]:
    return [one.file for one in list_regions(root) if one.state in {"broken", "unfit"}]


def outside(root: Path, old: str, new: str, path: str = INPUT) -> None:
    text = (root / path).read_text()
    assert text.count(old) == 1
    (root / path).write_text(text.replace(old, new))


def test_hand_edits_meet_a_new_rendering(root: Path) -> None:
    write_hand(root, "input:b", "self.b = 'ours'")
    generate(root, Package((C, A, B), 3))
    commit(root)
    git(root, "checkout", "-q", "side")
    write_hand(root, "input:a", "self.a = 'theirs'")
    write_hand(root, "node:b", "outcome_Yes = 1.0", NETWORK)
    outside(root, "import EDDIInputBase\n", "import EDDIInputBase\nimport by_hand\n")
    outside(
        root, "        super().__init__()\n", "        super().__init__()\n        self.x = 1\n"
    )
    commit(root)
    git(root, "checkout", "-q", "main")
    assert merge(root)
    assert not broken(root)
    text = (root / INPUT).read_text()
    assert "import by_hand" in text
    assert "self.x = 1" in text
    assert text.count("self.process_c,") == 1
    assert body(root, "input:a") == "self.a = 'theirs'"
    assert body(root, "input:b") == "self.b = 'ours'"
    assert body(root, "node:b", NETWORK) == "outcome_Yes = 1.0"
    assert not sync_package(root).touched


def test_two_renderings_are_united_and_must_be_generated_again(root: Path) -> None:
    generate(root, Package((A, B, C)))
    write_hand(root, "input:c", "self.c = 'ours'")
    commit(root)
    git(root, "checkout", "-q", "side")
    generate(root, Package((D, A, B)))
    write_hand(root, "input:d", "self.d = 'theirs'")
    commit(root)
    git(root, "checkout", "-q", "main")
    assert merge(root)
    assert broken(root)
    assert sync_package(root).refused  # what git merged is no rendering
    generate(root, Package((D, A, B, C)))
    assert not broken(root)
    assert body(root, "input:c") == "self.c = 'ours'"
    assert body(root, "input:d") == "self.d = 'theirs'"
    for name in "abcd":
        assert (root / INPUT).read_text().count(f"self.process_{name},") == 1


def test_one_body_written_on_both_branches_is_a_conflict(root: Path) -> None:
    for branch in ("main", "side"):
        git(root, "checkout", "-q", branch)
        write_hand(root, "input:a", f"self.a = {branch!r}")
        commit(root)
    git(root, "checkout", "-q", "main")
    assert not merge(root)
    text = (root / INPUT).read_text()
    assert "<<<<<<< ours\n        self.a = 'main'\n=======\n        self.a = 'side'\n" in text
    assert INPUT in broken(root)


@pytest.mark.parametrize("side", ["ours", "theirs"])
def test_a_body_of_an_input_that_the_other_branch_removed_is_a_conflict(
    root: Path, side: str
) -> None:
    def write() -> None:
        write_hand(root, "input:a", "self.a = 'by hand'")

    def remove() -> None:
        generate(root, Package((B,)))

    ours, theirs = (write, remove) if side == "ours" else (remove, write)
    for branch, change in (("main", ours), ("side", theirs)):
        git(root, "checkout", "-q", branch)
        change()
        commit(root)
    git(root, "checkout", "-q", "main")
    assert not merge(root)
    assert "self.a = 'by hand'" in (root / INPUT).read_text()
    assert INPUT in broken(root)


@pytest.mark.parametrize("swapped", [False, True])
def test_the_order_is_that_of_the_new_rendering(swapped: bool) -> None:
    base = RENDER[INPUT](Package((A, B)))
    sides = [
        RENDER[INPUT](Package((C, B, A))),
        base.replace("import EDDIInputBase", "import EDDIInputBase, x"),
    ]
    joined = join_branches(INPUT, base, *(sides[::-1] if swapped else sides))
    assert not joined.conflict
    assert list(parse(joined.text)[0].regions) == ["input:c", "input:b", "input:a"]
    assert "import EDDIInputBase, x\n" in joined.text


def test_base_that_both_branches_have_anew_has_no_digest() -> None:
    one, ours, theirs = (
        json.dumps({"base": {"both": {"sha256": side}, "same": {"sha256": side}, **own}})
        for side, own in (
            ("1", {"ours": "1", "theirs": "1", "gone": "1"}),
            ("2", {"ours": "2", "theirs": "1", "gone": "1", "new": "2"}),
            ("3", {"ours": "1", "theirs": "3"}),
        )
    )
    theirs = theirs.replace('"same": {"sha256": "3"}', '"same": {"sha256": "2"}')
    merged = json.loads(join_manifests(one, ours, theirs) or "")
    assert merged["base"] == {
        "ours": "2",
        "theirs": "3",
        "both": None,
        "same": {"sha256": "2"},
        "new": "2",
    }


def test_digests_of_two_renderings() -> None:
    one = '{"rendering": "1", "sha256": {"a": "1", "b": "1", "gone": "1"}}'
    ours = '{"rendering": "2", "sha256": {"a": "2", "b": "1", "c": "2", "gone": "1"}}'
    theirs = '{"rendering": "3", "sha256": {"a": "1", "b": "3"}}'
    merged = join_manifests(one, ours, theirs)
    assert merged is not None
    assert '"a": "2",\n  "b": "3",\n  "c": "2"\n' in merged
    assert join_manifests(one, one, theirs) == join_manifests(one, theirs, theirs)
    assert '"rendering": "3"' in str(join_manifests(one, one, theirs))
    assert join_manifests(one, ours, "<<<<<<<") is None


@pytest.mark.parametrize("seed", range(60))
def test_no_line_is_lost_or_gets_into_another_method(seed: int) -> None:
    chance = random.Random(seed)
    pool = elements("a", "b", "c", "d", "e")

    def model() -> tuple[Element, ...]:
        chosen = [one for one in pool if chance.random() < 0.7]
        return tuple(chance.sample(chosen, len(chosen)))

    path = chance.choice((INPUT, NETWORK, MANIFEST, CMAKE))
    start = Package(model(), chance.randint(1, 3))
    base = RENDER[path](start)
    written: dict[str, str] = {}
    sides = []
    for side in ("ours", "theirs"):
        package = Package(model(), chance.randint(1, 3)) if chance.random() < 0.5 else start
        text = RENDER[path](package)
        for region in parse(text)[0].regions.values():
            if chance.random() < 0.5:
                token = f"hand_{side}_{len(written)}"
                line = f"{region.indent}{token} = 1"
                line = f"  <a>{token}</a>" if path == MANIFEST else line
                old = f"{region.begin}\n{region.body}"
                text = text.replace(old, f"{region.begin}\n{line}\n{region.body}")
                written[token] = region.id
        sides.append(text)
    merged = join_branches(path, base, *sides)
    for token, region_id in written.items():
        assert token in merged.text, merged.text
        if not merged.conflict:
            document, faults = parse(merged.text)
            assert not faults
            assert token in document.regions[region_id].body
            assert merged.text.count(token) == 1
    if not merged.conflict and path.endswith(".py"):
        compile(merged.text, path, "exec")
