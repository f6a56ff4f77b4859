"""Files that must not be edited: written from renderings, and nothing of a person's is lost."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from unittest.mock import patch

import pytest

from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.formatting import meaning_digest
from eddi_scaffold.regions.generated import (
    as_placed,
    changed_generated,
    is_placed,
    recorded_generated,
)
from eddi_scaffold.regions.sync import SyncReport, sync_package
from tests.regions.rendering import snapshot

HEAD = "# fmt: off\n"
FIRST = f"{HEAD}def f():\n    return [1, 2]  # one\n"
SECOND = f"{HEAD}def f():\n    return [1, 2, 3]  # two\n"


EVERYTHING = """\
class A(B, metaclass=C):  # one
    x: int = 0x1F + 1e5j - -3.0

    async def f(self, /, *a: "x", b=u"\u00e9\U0001f916", **c) -> None:
        match a:
            case {"k": [1, *_]} | None:
                return f"{a!r:>{b}} {c=}" "d", b"e"[0:1, ..., 2]
        return (lambda: (yield {**c, 1: None})) if not a else [i async for i in a if i]
"""


def render(root: Path, **files: str) -> None:
    """Do what Copier does, which knows no formatters."""
    shutil.rmtree(root / ".eddi/generated", ignore_errors=True)
    (root / ".eddi/generated/test").mkdir(parents=True)
    for name, text in files.items():
        path = root / ".eddi/generated" / name.replace("__", "/")
        path.with_suffix(".py").write_text(text.removeprefix(HEAD))


def sync(root: Path) -> SyncReport:
    """Sync, and see that a second run changes nothing and has nothing to report."""
    report = sync_package(root)
    before = snapshot(root)
    assert sync_package(root) == SyncReport()
    assert snapshot(root) == before
    return report


def kept(root: Path) -> dict[str, str]:
    folder = root / ".eddi/rejects"
    return {
        p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()
    }


def test_they_follow_the_rendering(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST, test__b=FIRST)
    assert not sync(tmp_path).needs_attention
    assert is_placed(tmp_path)
    render(tmp_path, a=SECOND)
    assert not is_placed(tmp_path)
    assert not sync(tmp_path).notes
    assert (tmp_path / "a.py").read_text() == SECOND
    assert not (tmp_path / "test").exists(), "nothing is in it any more"
    assert recorded_generated(tmp_path) == ["a.py"]


def test_a_rendering_is_on_its_way_to_its_place(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST)
    assert any(one.file == ".eddi/generated" for one in list_regions(tmp_path))
    sync(tmp_path)
    assert not (tmp_path / ".eddi/generated").exists()
    assert not any(one.file == ".eddi/generated" for one in list_regions(tmp_path))


def test_half_of_a_removed_rendering_is_no_rendering(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST, b=FIRST)
    with (  # killed while it removes them
        patch("eddi_scaffold.regions.store.shutil.rmtree", side_effect=KeyboardInterrupt),
        pytest.raises(KeyboardInterrupt),
    ):
        sync_package(tmp_path)
    sync(tmp_path)
    assert (tmp_path / "b.py").read_text() == FIRST
    assert sorted(path.name for path in (tmp_path / ".eddi").iterdir()) == ["manifest.json"]


def test_an_edit_is_kept_aside(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST)
    sync(tmp_path)
    (tmp_path / "a.py").write_text(FIRST + "mine = 1\n")
    assert changed_generated(tmp_path) == ["a.py"]
    render(tmp_path, a=SECOND)
    (note,) = sync(tmp_path).notes
    assert note.attention
    assert note.text.endswith("but was: your text is kept in .eddi/rejects/a.py.edited")
    assert (tmp_path / "a.py").read_text() == SECOND
    assert kept(tmp_path) == {"a.py.edited": FIRST + "mine = 1\n"}


def test_a_file_of_a_person_is_kept_when_the_generator_takes_its_name(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST)
    sync(tmp_path)
    (tmp_path / "test").mkdir()
    (tmp_path / "test/b.py").write_bytes(b"calibration = 1.5\n\xff")
    render(tmp_path, a=FIRST, test__b=SECOND)
    (note,) = sync(tmp_path).notes
    assert (note.file, note.attention) == ("test/b.py", True)
    assert (tmp_path / "test/b.py").read_text() == SECOND
    data = (tmp_path / ".eddi/rejects/test/b.py.edited").read_bytes()
    assert data == b"calibration = 1.5\n\xff"


def test_an_edited_file_that_is_not_rendered_any_more_is_kept(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST, test__b=FIRST)
    sync(tmp_path)
    (tmp_path / "test/b.py").write_text("mine = 1\n")
    render(tmp_path, a=FIRST)
    (note,) = sync(tmp_path).notes
    assert note.attention
    assert not (tmp_path / "test/b.py").exists()
    assert kept(tmp_path) == {"test/b.py.edited": "mine = 1\n"}


LAYOUTS = {
    "one line each": FIRST.replace("[1, 2]", "[\n        1,\n        2,\n    ]"),
    "line ends": FIRST.replace("\n", "\r\n"),
    "blank lines": f"\n\n{FIRST}\n",
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_another_layout_is_no_edit(tmp_path: Path, layout: str) -> None:
    render(tmp_path, a=FIRST)
    sync(tmp_path)
    (tmp_path / "a.py").write_bytes(layout.encode())
    assert changed_generated(tmp_path) == []
    render(tmp_path, a=SECOND)
    assert not sync_package(tmp_path).notes
    assert (tmp_path / "a.py").read_text() == SECOND
    assert not kept(tmp_path)


def test_a_meaning_is_the_same_on_every_python() -> None:
    recorded = "ed664cca514b14f7abd0e520ca59409be85aec95c3e0d4d851c6861d99931c5b"
    assert meaning_digest(EVERYTHING.encode()) == recorded
    assert meaning_digest(EVERYTHING.replace("1e5j", "1e6j").encode()) != recorded


def test_a_comment_is_an_edit(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST)
    sync(tmp_path)
    (tmp_path / "a.py").write_text(FIRST.replace("# one", "# mine"))
    assert changed_generated(tmp_path) == ["a.py"]


@pytest.mark.parametrize("kind", ["link", "dangling", "folder", "fifo"])
def test_what_is_no_file_is_left_alone(tmp_path: Path, kind: str) -> None:
    root = tmp_path / "package"
    render(root, a=FIRST, b=FIRST)
    place, target = root / "a.py", tmp_path / "mine.py"
    if kind == "link":
        target.write_text("mine = 1\n")
    if kind in {"link", "dangling"}:
        place.symlink_to(target)
    elif kind == "folder":
        place.mkdir()
    else:
        os.mkfifo(place)
    (note,) = sync_package(root).notes
    assert (note.file, note.attention) == ("a.py", True)
    assert (root / "b.py").read_text() == FIRST
    assert not place.is_file() or place.read_text() == "mine = 1\n"
    assert target.exists() == (kind == "link")


@pytest.mark.parametrize("outside", [True, False])
def test_files_below_a_linked_folder_are_told(tmp_path: Path, outside: bool) -> None:
    root, own = tmp_path / "package", tmp_path / ("own" if outside else "package/own")
    own.mkdir(parents=True)
    (own / "b.py").write_text("mine = 1\n")
    (root / "test").parent.mkdir(exist_ok=True)
    (root / "test").symlink_to(own)
    render(root, a=FIRST, test__b=FIRST)
    for _ in range(2):  # it waits until the link is gone
        (note,) = sync_package(root).notes
        assert (note.file, note.attention) == ("test/b.py", True)
        assert any(one.file == ".eddi/generated" and one.review for one in list_regions(root))
    assert (root / "a.py").read_text() == FIRST
    assert (own / "b.py").read_text() == "mine = 1\n"
    (root / "test").unlink()
    assert sync(root).notes == ()
    assert (root / "test/b.py").read_text() == FIRST


def test_programs_stay_programs(tmp_path: Path) -> None:
    render(tmp_path, a=FIRST)
    (tmp_path / ".eddi/generated/a.py").chmod(0o755)
    sync(tmp_path)
    assert (tmp_path / "a.py").stat().st_mode & 0o777 == 0o755
    (tmp_path / "a.py").chmod(0o640)
    render(tmp_path, a=FIRST)
    (tmp_path / ".eddi/generated/a.py").chmod(0o755)
    sync(tmp_path)
    assert (tmp_path / "a.py").stat().st_mode & 0o777 == 0o750


@pytest.mark.parametrize(
    "name", [".git/hooks/post-checkout", ".copier-answers.yml", ".eddi/base/x"]
)
def test_some_places_are_no_places(tmp_path: Path, name: str) -> None:
    render(tmp_path, a=FIRST)
    (tmp_path / ".eddi/generated" / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / ".eddi/generated" / name).write_text("x")
    sync(tmp_path)
    assert not (tmp_path / name).exists()


def test_the_line_for_formatters_is_behind_that_of_a_program(tmp_path: Path) -> None:
    program = "#!/usr/bin/env python3\nprint()\n"
    render(tmp_path, run=program)
    sync(tmp_path)
    assert (tmp_path / "run.py").read_text() == program.replace("\n", f"\n{HEAD}", 1)
    assert as_placed("README.md", b"text\n") == b"text\n"


STRINGS_AND_COMMENTS = {
    "in a docstring": '"""One\n# no\n"""  # yes\n',
    "in a string of one line": 'a = "# no" # yes\n',
    "behind a continued line": "a = 'b\\\n # no'  # yes\n",
    "between two strings": 'a = ("b"  # yes\n  "c # no")\n',
    "in a format": 'a = f"""{b\n}# no"""\n# yes\n',
    "old line ends": 'a = 1\r# yes\r"""\r# no"""\r',
    "blanks": "#  yes \t\n\x0c# yes\n",
}


@pytest.mark.parametrize("text", STRINGS_AND_COMMENTS.values(), ids=STRINGS_AND_COMMENTS)
def test_a_meaning_has_the_comments_that_python_sees(text: str) -> None:
    meant = meaning_digest(text.encode())
    assert meaning_digest(text.replace("# yes", "# other").encode()) != meant
    with patch("eddi_scaffold.regions.formatting._plain_comments", return_value=None):
        assert meaning_digest(text.encode()) == meant  # read token by token
