"""A run that is killed while regions move from file to file, and while a package leaves."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.regions.package import ANSWERS, EDDI, KEPT, MANIFEST, move_in
from eddi_scaffold.regions.sync import plan_sync

IGNORED = f"{EDDI}/.gitignore"
RECORDS = {ANSWERS: b"template: t\n", IGNORED: b"/new/\n"}


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


@pytest.mark.parametrize(
    "then",
    [
        {"a.cfg": ["y"], "b.cfg": ["x"]},  # two change places
        {"a.cfg": [], "b.cfg": ["y", "x"]},
        {"a.cfg": ["x", "y"], "b.cfg": []},
        {"c.cfg": ["x", "y"]},
    ],
    ids=["swap", "to the second", "to the first", "to a new file"],
)
def test_a_region_moves_to_another_file(tmp_path: Path, then: dict[str, list[str]]) -> None:
    first = rendering(tmp_path / "first", {"a.cfg": ["x"], "b.cfg": ["y"]})
    second = rendering(tmp_path / "second", then)

    def begun(name: str) -> Path:
        package = tmp_path / name
        package.mkdir()
        plan = plan_sync(package, first, RECORDS)
        plan.prepare()
        plan.finish()
        return package

    def finish(package: Path) -> dict[str, str]:
        plan = plan_sync(package, second, RECORDS)
        assert not plan.refusals
        plan.prepare()
        plan.finish()
        return texts(package)

    whole = begun("whole")
    for id_ in "xy":
        write(whole, id_, f"mine {id_}")
    steps = len(plan_sync(whole, second, RECORDS).steps)
    expected = finish(whole)
    assert not any(name.startswith(KEPT) for name in expected)
    assert sum(text.count("mine") for text in expected.values()) == 2
    for killed_after in range(steps):
        package = begun(str(killed_after))
        for id_ in "xy":
            write(package, id_, f"mine {id_}")
        plan = plan_sync(package, second, RECORDS)
        plan.prepare()
        move_in(package, plan.steps[:killed_after])
        found = "".join(texts(package).values())
        assert "mine x" in found, killed_after
        assert "mine y" in found, killed_after
        assert finish(package) == expected, killed_after


def test_a_package_leaves(tmp_path: Path) -> None:
    first = rendering(tmp_path / "first", {"a.cfg": ["x"], "src/b.cfg": ["y"]})
    nothing = rendering(tmp_path / "nothing", {})
    gone: dict[str, bytes | None] = dict.fromkeys(RECORDS)
    for killed_after in range(6):
        package = tmp_path / str(killed_after)
        package.mkdir()
        plan = plan_sync(package, first, RECORDS)
        plan.prepare()
        plan.finish()
        plan = plan_sync(package, nothing, gone)
        assert len(plan.steps) == 6
        plan.prepare()
        move_in(package, plan.steps[:killed_after])
        # nobody takes it for one whose answers were lost
        assert (package / ANSWERS).exists() or not (package / MANIFEST).exists()
        plan = plan_sync(package, nothing, gone)
        plan.prepare()
        plan.finish()
        assert not package.exists()


def test_of_a_package_that_leaves_its_texts_stay(tmp_path: Path) -> None:
    first = rendering(tmp_path / "first", {"a.cfg": ["x"]})
    package = tmp_path / "package"
    package.mkdir()
    plan = plan_sync(package, first, RECORDS)
    plan.prepare()
    plan.finish()
    write(package, "x", "mine")
    (package / "own.txt").write_text("own")
    plan = plan_sync(package, rendering(tmp_path / "nothing", {}), dict.fromkeys(RECORDS))
    plan.prepare()
    plan.finish()
    assert list(texts(package)) == [f"{KEPT}/x.region", "own.txt"]
