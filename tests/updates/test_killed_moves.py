"""A run that is killed while regions move from file to file, and while a package leaves."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from pathlib import Path

import pytest

from eddi_scaffold.regions.package import ANSWERS, KEPT, MANIFEST
from eddi_scaffold.regions.sync import plan_sync

RECORDS: dict[str, bytes | None] = {ANSWERS: b"template: t\n"}
GONE: dict[str, bytes | None] = dict.fromkeys(RECORDS)


def rendering(folder: Path, files: dict[str, list[str]]) -> Path:
    for name, ids in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = [f"# -----Manual edit {{}}-----  # region: {id_}" for id_ in ids]
        path.write_text("".join(f"{one.format('begin')}\n{one.format('end')}\n" for one in lines))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def write(package: Path, id_: str, text: str) -> None:
    for path in package.rglob("*.cfg"):
        lines = path.read_text().split("\n")
        for at, line in enumerate(lines):
            if "edit begin" in line and f": {id_} " in line:
                lines.insert(at + 1, text)
                path.write_text("\n".join(lines))
                break


def texts(package: Path) -> dict[str, str]:
    return {
        path.relative_to(package).as_posix(): path.read_text()
        for path in sorted(package.rglob("*"))
        if path.is_file()
    }


def begun(package: Path, first: Path, *ids: str) -> Path:
    """Make a package, and write in some of its regions."""
    package.mkdir()
    finish(package, first)
    for id_ in ids:
        write(package, id_, f"mine {id_}")
    return package


def finish(package: Path, then: Path, records: Mapping[str, bytes | None] = RECORDS) -> None:
    plan = plan_sync(package, then, records)
    assert not plan.refusals
    plan.prepare()
    plan.finish()


def killed(package: Path, then: Path, after: int, records: Mapping[str, bytes | None]) -> int:
    """Finish a part of a sync; returns of how many steps."""
    plan = plan_sync(package, then, records)
    part = plan._replace(steps=plan.steps[:after])
    part.prepare()
    part.finish()
    return len(plan.steps)


@pytest.mark.parametrize("then", [{"a.cfg": ["y"], "b.cfg": ["x"]}, {"c.cfg": ["x", "y"]}])
def test_a_region_moves_to_another_file(tmp_path: Path, then: dict[str, list[str]]) -> None:
    """Two change places, or go to a new file."""
    first = rendering(tmp_path / "first", {"a.cfg": ["x"], "b.cfg": ["y"]})
    second = rendering(tmp_path / "second", then)
    whole = begun(tmp_path / "whole", first, *"xy")
    finish(whole, second)
    expected = texts(whole)
    assert not any(name.startswith(KEPT) for name in expected)
    assert sum(text.count("mine") for text in expected.values()) == 2
    for after in count():
        package = begun(tmp_path / str(after), first, *"xy")
        steps = killed(package, second, after, RECORDS)
        found = "".join(texts(package).values())
        assert ("mine x" in found, "mine y" in found) == (True, True), after
        finish(package, second)
        assert texts(package) == expected, after
        if after == steps:
            break


def test_a_package_leaves(tmp_path: Path) -> None:
    first = rendering(tmp_path / "first", {"a.cfg": ["x"], "src/b.cfg": ["y"]})
    nothing = rendering(tmp_path / "nothing", {})
    for after in range(5):
        package = begun(tmp_path / str(after), first)
        assert killed(package, nothing, after, GONE) == 5
        # nobody takes it for one whose answers were lost
        assert (package / ANSWERS).exists() or not (package / MANIFEST).exists()
        finish(package, nothing, GONE)
        assert not package.exists()


def test_of_a_package_that_leaves_its_texts_stay(tmp_path: Path) -> None:
    package = begun(tmp_path / "package", rendering(tmp_path / "first", {"a.cfg": ["x"]}), "x")
    (package / "own.txt").write_text("own")
    finish(package, rendering(tmp_path / "nothing", {}), GONE)
    assert list(texts(package)) == [f"{KEPT}/x.region", "own.txt"]
