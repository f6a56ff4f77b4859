"""Many files change as one: all, or none."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eddi_scaffold.packages import transaction
from eddi_scaffold.packages.transaction import FileState, apply, recover, tree_of, write
from eddi_scaffold.problems import EddiError

OLD = {"a": FileState(b"old a"), "d/b": FileState(b"old b", mode=0o755)}
CHANGES = {
    "a": FileState(b"new a", mode=0o755),
    "d/b": None,
    "e/f/c": FileState(b"new c"),
}
NEW = {"a": FileState(b"new a", mode=0o755), "e/f/c": FileState(b"new c")}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    apply(tmp_path / "root", OLD, {})
    return tmp_path / "root"


def test_files_are_written_replaced_and_removed(root: Path) -> None:
    assert tree_of(root) == OLD
    apply(root, CHANGES, OLD)
    assert tree_of(root) == NEW
    assert sorted(path.name for path in root.iterdir()) == ["a", "e"]
    assert not recover(root)


def test_nothing_to_change_makes_no_folder(tmp_path: Path) -> None:
    apply(tmp_path / "root", {}, {})
    assert not (tmp_path / "root").exists()


@pytest.mark.parametrize("limit", range(1, 3))
def test_a_full_disk_leaves_all_as_it_was(
    root: Path, limit: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, written = transaction._write, []

    def full(path: Path, data: bytes) -> None:
        written.append(path)
        if len(written) == limit:
            real(path, data[: len(data) // 2])
            raise OSError(28, "No space left on device", str(path))
        real(path, data)

    monkeypatch.setattr(transaction, "_write", full)
    with pytest.raises(EddiError) as failure:
        write(root, CHANGES, OLD)
    (problem,) = failure.value.problems
    assert (problem.code, problem.message) == ("F002", "cannot write: No space left on device")
    assert problem.place.file == str(root)
    assert tree_of(root) == OLD
    assert not recover(root)


@pytest.mark.parametrize("blocked", ["a/x", "d", "e"])
def test_what_stands_in_the_way_is_found_before_anything_changes(root: Path, blocked: str) -> None:
    """A file where a folder must be, a folder where a file must be."""
    if blocked == "e":
        (root / "e").write_text("a file")
    before = tree_of(root)
    with pytest.raises(EddiError):
        write(root, {**CHANGES, **({} if blocked == "e" else {blocked: FileState(b"x")})}, OLD)
    assert tree_of(root) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_found_before_anything_changes(root: Path) -> None:
    (root / "d").chmod(0o555)
    try:
        with pytest.raises(EddiError):
            write(root, CHANGES, OLD)
        assert tree_of(root) == OLD
    finally:
        (root / "d").chmod(0o755)


class Killed(BaseException):
    """The process ends here."""


@pytest.mark.parametrize("moves", range(3))
def test_killed_while_files_are_replaced_the_next_run_finishes(
    root: Path, moves: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, done = Path.replace, []

    def replace(path: Path, target: Path) -> Path:
        if path.parent.name.startswith(".eddi-transaction-"):
            done.append(path)
            if len(done) > moves:
                raise Killed
        return real(path, target)

    monkeypatch.setattr(Path, "replace", replace)
    if moves < 2:
        with pytest.raises(Killed):
            apply(root, CHANGES, OLD)
        monkeypatch.undo()
        assert recover(root)
    else:
        apply(root, CHANGES, OLD)
    assert tree_of(root) == NEW
    assert not recover(root)


def test_killed_before_the_decision_nothing_has_happened(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(transaction.shutil, "rmtree", lambda *_, **__: None)  # killed: no clean-up
    monkeypatch.setattr(transaction.journal, "forget", lambda *_: None)
    real, written = transaction._write, []

    def write_one(path: Path, data: bytes) -> None:
        if written:
            raise Killed
        written.append(real(path, data))

    monkeypatch.setattr(transaction, "_write", write_one)
    with pytest.raises(Killed):
        apply(root, CHANGES, OLD)
    monkeypatch.undo()
    assert recover(root)
    assert tree_of(root) == OLD
    assert not recover(root)


def test_ctrl_c_while_files_are_replaced_does_the_rest_first(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, interrupted = Path.replace, []

    def replace(path: Path, target: Path) -> Path:
        moved = real(path, target)
        if path.parent.name.startswith(".eddi-transaction-") and not interrupted:
            interrupted.append(path)
            raise KeyboardInterrupt
        return moved

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(KeyboardInterrupt):
        apply(root, CHANGES, OLD)
    assert tree_of(root) == NEW
    assert not recover(root)


# saved by a person after it was read --------------------------------------------------------------
@pytest.mark.parametrize(
    ("path", "saved"),
    [("a", b"mine"), ("d/b", b"mine"), ("e/f/c", b"mine"), ("a", None), ("d/b", None)],
)
def test_a_file_that_was_saved_meanwhile_stops_all(
    root: Path, path: str, saved: bytes | None
) -> None:
    target = root / path
    target.parent.mkdir(parents=True, exist_ok=True)
    target.unlink(missing_ok=True)
    if saved is not None:
        target.write_bytes(saved)
    before = tree_of(root)
    with pytest.raises(EddiError) as refused:
        write(root, CHANGES, OLD)
    (problem,) = refused.value.problems
    assert problem.code == "F013"
    assert problem.place.file == str(target)
    assert tree_of(root) == before
    assert not recover(root)
    assert not list(root.glob(".eddi-*"))


def test_a_file_that_is_saved_while_others_are_replaced_is_left_alone(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Path.replace

    def replace(path: Path, target: Path) -> Path:
        if target == root / "e/f/c":
            (root / "z").write_bytes(b"hand-written")
        return real(path, target)

    apply(root, {"z": FileState(b"old z")}, {})
    monkeypatch.setattr(Path, "replace", replace)
    done = apply(root, {**CHANGES, "z": FileState(b"new z")}, {**OLD, "z": FileState(b"old z")})
    assert done.left == [f"{root / 'z'} is left alone: it was changed since"]
    assert tree_of(root) == {**NEW, "z": FileState(b"hand-written")}


def test_a_guard_that_a_killed_run_left_is_no_obstacle(root: Path) -> None:
    left = {**OLD, "guard": FileState(b"left")}
    apply(root, {"guard": FileState(b"left")}, {})
    done = apply(root, {**CHANGES, "guard": None}, left, {}, {"guard": FileState(b"new")})
    assert done == transaction.Applied([])
    assert tree_of(root) == NEW
