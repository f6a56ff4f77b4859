"""The files: kills, full disks, vanished files, git, damaged markers, the command line."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from eddi_scaffold.packages.review import doubtful_names
from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions.bases import read_bases, write_bases
from eddi_scaffold.regions.check import accept, broken_files, list_regions
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.result import Orphan
from eddi_scaffold.regions.store import load_orphans, save_orphan, save_reject, write_file
from eddi_scaffold.regions.sync import sync_package
from tests.regions.rendering import (
    CMAKE,
    FILES,
    INPUT,
    MANIFEST,
    NETWORK,
    Package,
    eddi_input,
    elements,
    renamed,
    render,
    snapshot,
)

A, B, C = elements("a", "b", "c")
FOLDER = Path(command.__file__).parent


class Killed(BaseException):
    pass


def write_hand(root: Path, region: str, code: str, path: str = INPUT) -> None:
    text = (root / path).read_text()
    found = parse(text)[0].regions[region]
    lines = text.split("\n")
    lines[found.line : found.line + found.body.count("\n")] = [found.indent + code]
    (root / path).write_text("\n".join(lines))


def body(root: Path, region: str, path: str = INPUT) -> str:
    return parse((root / path).read_text())[0].regions[region].body.strip()


@pytest.fixture
def package(tmp_path: Path) -> Path:
    root = tmp_path / "pkg"
    render(root, Package((A, B)))
    assert not sync_package(root).needs_attention
    write_hand(root, "input:a", "hand = 1")
    write_hand(root, "node:b", "outcome_Yes = 1.0", NETWORK)
    with (root / INPUT).open("a") as file:
        file.write("        self.after = 1\n")
    return root


def git(root: Path, *words: str) -> None:
    identity = ["-c", "user.name=T", "-c", "user.email=t@example.org"]
    subprocess.run(["git", *identity, *words], cwd=root, check=True, capture_output=True)


STEPS = {
    "new template": Package((A, B), 2),
    "removed": Package((B,), 2),
    "renamed": Package((C, B, renamed(A, "z")), 3),
    "file gone": Package((A, B), 2, tuple(f for f in FILES if f != INPUT)),
}


def test_order_of_writes(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    render(package, Package((B,), 2))
    order: list[str] = []
    real = os.replace
    monkeypatch.setattr(os, "replace", lambda a, b: (order.append(str(b)), real(a, b))[1])
    sync_package(package)
    names = [Path(p).relative_to(package).as_posix() for p in order]
    first = {
        kind: min(i for i, n in enumerate(names) if test(n))
        for kind, test in {
            "orphans": lambda n: n.startswith(".eddi/orphans"),
            "file": lambda n: not n.startswith(".eddi"),
            "base": lambda n: n == ".eddi/bases",
        }.items()
    }
    assert first["orphans"] < first["file"] < first["base"]
    assert max(i for i, n in enumerate(names) if not n.startswith(".eddi")) < first["base"]


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("call", ["replace", "unlink", "fsync"])
def test_killed_at_any_instant(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, call: str
) -> None:
    render(package, STEPS[step])
    whole = tmp_path / "whole"
    shutil.copytree(package, whole)
    sync_package(whole)
    want = snapshot(whole)
    real = getattr(os, call)
    for survived in range(60):
        root = tmp_path / f"killed{survived}"
        shutil.copytree(package, root)
        left = survived

        def dying(*arguments: object, **options: object) -> object:
            nonlocal left
            left -= 1
            if left < 0:
                raise Killed
            return real(*arguments, **options)

        monkeypatch.setattr(os, call, dying)
        try:
            sync_package(root)
        except Killed:
            died = True
        else:
            died = False
        monkeypatch.undo()
        sync_package(root)
        assert snapshot(root) == want
        if not died:
            break
    else:
        pytest.fail("more steps than expected")


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("path", [INPUT, NETWORK])
def test_saved_at_any_instant(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, path: str
) -> None:
    """A person saves the file that is being merged: the line is in it at the end, or kept."""
    render(package, STEPS[step])
    real, token = os.fsync, "# saved_during_the_merge"
    for waited in range(60):
        root = tmp_path / f"saved{waited}"
        shutil.copytree(package, root)
        left, saved = waited, False

        def saving(handle: int, root: Path = root) -> None:
            nonlocal left, saved
            left -= 1
            if left == -1 and (root / path).exists():
                (root / path).write_text(f"{(root / path).read_text()}{token}\n")
                saved = True
            real(handle)

        monkeypatch.setattr(os, "fsync", saving)
        assert not sync_package(root).refused
        monkeypatch.undo()
        sync_package(root)
        kept = [file.read_text() for file in (root / ".eddi/rejects").rglob("*.patch")]
        if (root / path).exists():
            kept.append((root / path).read_text())
        assert "".join(kept).count(token) == saved, waited
        before = snapshot(root)
        assert sync_package(root).touched == ()
        assert snapshot(root) == before
        if left >= 0:
            break
    assert waited > 4


@pytest.mark.parametrize("path", [INPUT, NETWORK])
def test_saved_at_any_instant_while_two_exchange_names(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str
) -> None:
    """What stood under a name before the exchange moves along; what is written after it stays."""
    render(package, Package((renamed(A, "b"), renamed(B, "a"))))
    real, kind = os.fsync, "input" if path == INPUT else "node"
    homes = set()
    for waited in range(60):
        root = tmp_path / f"saved{waited}"
        shutil.copytree(package, root)
        left, home = waited, ""

        def saving(handle: int, root: Path = root) -> None:
            nonlocal left, home
            left -= 1
            if left == -1:
                first = next(iter(parse((root / path).read_text())[0].regions))
                home = f"{kind}:b" if first == f"{kind}:a" else f"{kind}:a"
                write_hand(root, f"{kind}:a", "self.by_hand = 1", path)
            real(handle)

        monkeypatch.setattr(os, "fsync", saving)
        sync_package(root)
        monkeypatch.undo()
        sync_package(root)
        if left >= 0:
            break
        homes.add(home)
        assert body(root, home, path) == "self.by_hand = 1", waited
        assert (root / path).read_text().count("by_hand") == 1
        assert not load_orphans(root)
    assert homes == {f"{kind}:a", f"{kind}:b"}


@pytest.mark.parametrize("edited", [False, True])
def test_killed_and_rendered_again(
    package: Path, monkeypatch: pytest.MonkeyPatch, edited: bool
) -> None:
    render(package, Package((A, B, C), 2))
    real = os.replace

    def dying(source: Path, target: Path) -> None:
        if Path(target).name == "bases":
            raise Killed
        real(source, target)

    monkeypatch.setattr(os, "replace", dying)
    with pytest.raises(Killed):
        sync_package(package)
    monkeypatch.undo()
    if edited:
        write_hand(package, "input:a", "self.a = 'by hand'")
    render(package, Package((A, B), 3))
    sync_package(package)
    assert "process_c" not in (package / INPUT).read_text()
    assert ("by hand" in body(package, "input:a")) is edited


def test_what_a_killed_run_saved_goes_when_the_region_stays_and_has_more(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    render(package, Package((B,)))
    real = os.replace

    def dying(source: Path, target: Path) -> None:
        if Path(target).name == Path(INPUT).name:
            raise Killed
        real(source, target)

    monkeypatch.setattr(os, "replace", dying)
    with pytest.raises(Killed):
        sync_package(package)
    monkeypatch.undo()
    assert load_orphans(package)
    write_hand(package, "input:a", "hand = 1\n        more = 2")
    render(package, Package((A, B), 2))
    sync_package(package)
    assert body(package, "input:a") == "hand = 1\n        more = 2"
    assert not load_orphans(package)


@pytest.mark.parametrize("place", range(8))
def test_full_disk_is_reported_and_repaired(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: int
) -> None:
    render(package, STEPS["removed"])
    whole = tmp_path / "whole"
    shutil.copytree(package, whole)
    sync_package(whole)
    left = place

    def full(_handle: int) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    report = sync_package(package)
    assert report.needs_attention
    assert "No space left" in report.refused[0].reason
    for path in FILES:
        compile((package / path).read_text(), path, "exec") if path.endswith(".py") else None
    monkeypatch.undo()
    sync_package(package)
    assert snapshot(package) == snapshot(whole)


def test_what_cannot_be_written_is_named_and_not_the_scratch_file(tmp_path: Path) -> None:
    name = "n" * 250  # the scratch file beside it would have a name that no disk can hold
    with pytest.raises(OSError, match="too long") as refused:
        write_file(tmp_path, name, b"text")
    assert refused.value.filename == str(tmp_path / name)


def test_damaged_markers_leave_the_file_alone(package: Path) -> None:
    text = (package / INPUT).read_text().replace("Manual edit end", "Manual edit and", 1)
    (package / INPUT).write_text(text)
    render(package, Package((B, A), 2))
    base = read_bases(package)[INPUT]
    report = sync_package(package)
    assert [r.file for r in report.refused] == [INPUT] * len(report.refused)
    assert report.refused[0].line > 1
    assert report.needs_attention
    assert (package / INPUT).read_text() == text
    assert read_bases(package)[INPUT] == base
    assert NETWORK in report.touched
    assert broken_files(package)
    assert command.main(["check"], package) == 1
    (package / INPUT).write_text(text.replace("Manual edit and", "Manual edit end"))
    assert command.main(["check"], package) == 0
    sync_package(package)
    assert body(package, "input:a") == "hand = 1"


DAMAGES = {
    "case": ("Manual edit", "Manual Edit"),
    "no dashes": ("-", ""),
    "deleted": None,
}


def damaged(text: str, region: str, damage: tuple[str, str] | None) -> str:
    lines = []
    for line in text.split("\n"):
        if f"region: {region}" not in line:
            lines.append(line)
        elif damage is not None:
            lines.append(line.replace(*damage))
    return "\n".join(lines)


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("damage", ["case", "no dashes", "deleted"])
@pytest.mark.parametrize(
    ("file", "region", "hand"),
    [
        (INPUT, "input:a", "self.a = 2"),
        (NETWORK, "node:b", "outcome_Yes = 0.5"),
        (MANIFEST, "xml:depends", "<depend>mine</depend>"),
        (CMAKE, "cmake:install", "install(mine)"),
    ],
)
def test_both_markers_damaged_in_the_same_way(
    package: Path, damage: str, file: str, region: str, hand: str, version: int
) -> None:
    write_hand(package, region, hand, file)
    whole = (package / file).read_text()
    text = damaged(whole, region, DAMAGES[damage])
    (package / file).write_text(text)
    render(package, Package((A, B), version))
    (refusal,) = sync_package(package).refused
    assert refusal.file == file
    assert region in refusal.reason
    assert (package / file).read_text() == text
    if version == 1:
        assert [(one.file, one.line) for one in broken_files(package)] == [(file, refusal.line)]
        assert command.main(["check"], package) == 1
    (package / file).write_text(whole)
    assert not sync_package(package).refused
    assert body(package, region, file) == hand


def test_a_method_that_a_person_removed_comes_back(package: Path) -> None:
    text = (package / INPUT).read_text()
    start, stop = text.index("    def process_b"), text.index("    def processing")
    (package / INPUT).write_text(text[:start] + text[stop:])
    assert not broken_files(package)
    assert not sync_package(package).refused
    assert "self.b = message.data" in body(package, "input:b")


def test_interrupted_rendering_is_refused(package: Path) -> None:
    render(package, Package((A, B)))
    pristine = package / ".eddi/pristine" / INPUT
    pristine.write_text(pristine.read_text()[:200])
    before = (package / INPUT).read_bytes()
    report = sync_package(package)
    assert "interrupted" in report.refused[0].reason
    assert (package / INPUT).read_bytes() == before


def test_file_that_is_not_utf8_is_refused(package: Path) -> None:
    (package / INPUT).write_bytes(b"# \n# \xff\n")
    (refusal,) = sync_package(package).refused
    assert (refusal.file, refusal.line) == (INPUT, 2)


def test_mode_is_kept(package: Path) -> None:
    (package / INPUT).chmod(0o755)
    render(package, Package((A, B), 2))
    sync_package(package)
    assert stat.S_IMODE((package / INPUT).stat().st_mode) == 0o755


def test_vanished_file_is_kept_in_pieces_and_comes_back(package: Path) -> None:
    gone = replace(Package((A, B)), files=tuple(f for f in FILES if f != INPUT))
    render(package, gone)
    report = sync_package(package)
    assert report.needs_attention
    assert not (package / INPUT).exists()
    assert INPUT not in read_bases(package)
    assert "self.after" in (package / f".eddi/rejects/{INPUT}.patch").read_text()
    render(package, Package((A, B)))
    sync_package(package)
    assert body(package, "input:a") == "hand = 1"
    assert not (package / ".eddi/orphans").exists()


def test_file_that_copier_removed_is_read_from_git(package: Path) -> None:
    git(package.parent, "init", "-q")
    git(package.parent, "add", ".")
    git(package.parent, "commit", "-qm", "x")
    render(package, replace(Package((A, B)), files=tuple(f for f in FILES if f != INPUT)))
    (package / INPUT).unlink()
    assert command.main(["sync"], package) == 0
    assert [o.body.strip() for o in load_orphans(package).values()] == ["hand = 1"]
    assert "self.after" in (package / f".eddi/rejects/{INPUT}.patch").read_text()


def test_body_moves_to_the_file_that_has_its_region_now(tmp_path: Path) -> None:
    end = "# eddi-scaffold: end of rendering\n"
    marked = "'''-----Manual edit {}-----'''  # region: x:y\n"
    both = marked.format("begin") + marked.format("end")
    for name, text in {"a.py": "a = 1\n", "z.py": both}.items():
        pristine = tmp_path / ".eddi/pristine" / name
        pristine.parent.mkdir(parents=True, exist_ok=True)
        pristine.write_text(text + end)
    sync_package(tmp_path)
    write_hand(tmp_path, "x:y", "hand = 1", "z.py")
    (tmp_path / ".eddi/pristine/a.py").write_text("a = 1\n" + both + end)
    (tmp_path / ".eddi/pristine/z.py").write_text("z = 1\n" + end)
    sync_package(tmp_path)
    assert body(tmp_path, "x:y", "a.py") == "hand = 1"
    assert (tmp_path / "z.py").read_text() == "z = 1\n"
    assert not load_orphans(tmp_path)
    assert sync_package(tmp_path).touched == ()


def test_orphans_and_rejects_are_never_overwritten(tmp_path: Path) -> None:
    one = Orphan("a/b:c d%", "x.py", "1a2b3c4d", "\t", "one\r\n")
    other = replace(one, body="other\n")
    places = [save_orphan(tmp_path, o) for o in (one, other, one)]
    assert places[0] == places[2] != places[1]
    assert list(load_orphans(tmp_path).values()) == [one, other]
    long = replace(one, id="x:" + "é" * 200)
    place = save_orphan(tmp_path, long)
    assert load_orphans(tmp_path)[place] == long
    for odd in ("", ".", ".."):
        place = save_orphan(tmp_path, replace(one, id=odd))
        assert place.parent == tmp_path / ".eddi" / "orphans"
        assert load_orphans(tmp_path)[place].id == odd
    names = [save_reject(tmp_path, "d/x.py", data).name for data in (b"1", b"2", b"1", b"3")]
    assert names == ["x.py.patch", "x.py.2.patch", "x.py.patch", "x.py.3.patch"]


def test_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    assert write_file(tmp_path, "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"
    assert not write_file(tmp_path, "link", b"new")


def test_states_and_review(package: Path) -> None:
    render(package, Package((replace(A, states=("x",)), B)))
    sync_package(package)
    write_hand(package, "input:b", "self.hand = old_name = 1")
    states = {s.id: s for s in list_regions(package, doubtful_names)}
    assert states["node:a"].state == "untouched"
    assert (states["input:a"].state, states["input:a"].review) == ("edited", True)
    assert "other inputs or states" in states["input:a"].notes[0]
    assert any("'self.hand'" in note for note in states["input:b"].notes)
    assert any("'old_name'" in note for note in states["input:b"].notes)
    assert [s.id for s in list_regions(package) if s.review] == ["input:a"]
    assert states["node:b"].notes == ()
    assert accept(package, ["input:a", "no:such"]) == ("input:a",)
    again = {s.id: s for s in list_regions(package)}
    assert "other inputs or states" not in " ".join(again["input:a"].notes)
    assert sync_package(package).touched == ()


def test_a_person_reviews_with_the_command_alone(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_hand(package, "input:a", "self.a = 1")
    assert command.main(["status"], package) == 0
    render(package, Package((replace(A, states=("x",)), B)))
    assert command.main(["sync"], package) == 0
    assert command.main(["status"], package) == 3
    assert f"{INPUT}:13: edited: input:a: written for other inputs" in capsys.readouterr().out
    assert command.main(["accept", "input:a"], package) == 0
    assert command.main(["status"], package) == 0
    assert command.main(["accept", "input:b", "input:none"], package) == 1
    assert capsys.readouterr().err.endswith("input:none: error: not accepted\n")


def test_orphans_rejects_and_damage_are_listed(package: Path) -> None:
    text = (package / INPUT).read_text().replace("Inputs of the monitor", "My inputs")
    (package / INPUT).write_text(text)
    render(package, Package((B,), 3))
    sync_package(package)
    (package / NETWORK).write_text("'''-----Manual edit begin-----'''  # region: a:b\n")
    states = [s.state for s in list_regions(package) if s.review]
    assert sorted(states) == ["broken", "orphaned", "rejected"]


@pytest.mark.parametrize("marker", ["<<<<<<< HEAD", "||||||| 1a2b3c4", "=======", ">>>>>>> side"])
@pytest.mark.parametrize("file", ["README.md", "own/notes.txt", ".eddi/manifest.json"])
def test_a_conflict_marker_is_looked_at(package: Path, marker: str, file: str) -> None:
    text = f"Heading\n=======\n\n{marker}\n>>>>>>>> no marker\n"
    write_file(package, file, text.encode())
    found = [one for one in list_regions(package) if one.state == "broken"]
    expected = [] if marker == "=======" else [(file, 4, True)]
    assert [(one.file, one.line, one.review) for one in found] == expected


def test_what_is_no_conflict_marker_is_not_looked_at(package: Path) -> None:
    save_reject(package, "a.py", b"<<<<<<< before updating\n", ".edited")
    write_file(package, "recording.bag", b"\0\n<<<<<<< HEAD\n")
    write_file(package, "notes.txt", b"see <<<<<<< HEAD\n <<<<<<< HEAD\n<<<<<<<<\n")
    write_file(package, "own.py", b"'''Example\n=======\n'''\n")
    assert not [one for one in list_regions(package) if one.state == "broken"]
    write_file(package, "own.py", b"a = 1\n=======\n")
    assert [one.line for one in list_regions(package) if one.state == "broken"] == [2]


def test_a_package_needs_no_editable_file(tmp_path: Path) -> None:
    write_file(tmp_path, ".eddi/generated/a.py", b"")
    sync_package(tmp_path)
    assert list_regions(tmp_path) == ()
    write_bases(tmp_path, {"package.xml": "<package/>"})  # it had one, and still has the file
    write_file(tmp_path, "package.xml", b"<package/>")
    assert [one.state for one in list_regions(tmp_path)] == ["unfit"]
    shutil.rmtree(tmp_path / ".eddi")
    assert [one.state for one in list_regions(tmp_path)] == ["broken"]


@pytest.mark.parametrize("name", ["/usr/bin/python3", sys.executable])
def test_the_folder_runs_alone(package: Path, tmp_path: Path, name: str) -> None:
    interpreter = shutil.which(name)
    if interpreter is None:
        pytest.skip(f"no {name} here")
    ours = tmp_path / "checkout"
    shutil.copytree(FOLDER, ours / "eddi_scaffold/regions", ignore=shutil.ignore_patterns("__py*"))
    shutil.copy(FOLDER.parent / "__init__.py", ours / "eddi_scaffold")
    render(package, Package((B,), 2))
    run = [interpreter, "-I", "-S", str(ours / "eddi_scaffold/regions")]
    done = subprocess.run([*run, "sync"], cwd=package, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")
    assert f"{INPUT}:13: warning: region 'input:a' is gone" in done.stderr
    assert not [p for p in ours.rglob("*.pyc") if not p.name.startswith("__main__")]
    assert subprocess.run([*run, "check"], cwd=package, check=False).returncode == 0
    assert subprocess.run([*run, "wrong"], cwd=package, check=False, stderr=-3).returncode == 2
    foreign = tmp_path / "any name"  # in a template of somebody else's
    shutil.copytree(ours / "eddi_scaffold/regions", foreign)
    (package / ".eddi").rename(package / ".hand")
    (package / ".hand/pristine" / INPUT).parent.mkdir(parents=True)
    (package / ".hand/pristine" / INPUT).write_text(
        eddi_input(Package((B, C))) + "# x: end of rendering\n"
    )
    run = [interpreter, "-I", "-S", str(foreign), "--folder"]
    for records, status in ((".hand", 0), (".git", 1), ("a/b", 1)):
        done = subprocess.run(
            [*run, records, "sync"], cwd=package, capture_output=True, check=False
        )
        assert done.returncode == status, done
    assert "process_c" in (package / INPUT).read_text()
    assert not (package / ".eddi").exists()


def test_a_merged_rendering_goes_where_git_does_not_see_it(package: Path) -> None:
    before = snapshot(package)
    assert not (package / ".eddi/pristine").exists()
    assert not (package / ".eddi/.gitignore").exists()
    assert sync_package(package).touched == ()
    assert snapshot(package) == before
    (package / ".eddi/.gitignore").write_text("")  # there Copier would take it for removed
    render(package, Package((A, B), 2))
    sync_package(package)
    assert (package / ".eddi/pristine" / INPUT).exists()
    assert body(package, "input:a") == "hand = 1"


def test_a_rendering_stays_until_every_file_is_merged(package: Path) -> None:
    text = (package / INPUT).read_text()
    (package / INPUT).write_text(text.replace("Manual edit end", "Manual edit over"))
    render(package, Package((A, B), 2))
    assert sync_package(package).refused
    (package / INPUT).write_text(text)
    assert not sync_package(package).refused
    assert "version 2" in (package / INPUT).read_text()
    assert not (package / ".eddi/pristine").exists()
