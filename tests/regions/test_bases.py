"""The file of bases: any text comes back, also after what people and git do to the whole file."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.regions.bases import bases_of, read_bases, text_of, write_bases
from eddi_scaffold.regions.branches import join_bases
from eddi_scaffold.regions.store import write_file

TEXTS = st.text(st.sampled_from(" \t\r\n\\#<=>|a0é\u2028"), max_size=30)


@given(st.dictionaries(st.text("ab/. -#\\<é", min_size=1, max_size=6), TEXTS))
def test_what_is_written_is_read(bases: dict[str, str]) -> None:
    assert bases_of(text_of(bases)) == bases


def test_line_ends_of_another_system_are_those_of_the_bases() -> None:
    bases = {"a": "1\n\n2\n", "b": "3"}
    changed = bases_of(text_of(bases).replace("\n", "\r\n"))
    assert changed == {"a": "1\r\n\r\n2\r\n", "b": "3\r"}


def test_a_name_that_was_replaced_is_that_of_its_file(tmp_path: Path) -> None:
    write_bases(tmp_path, {"src/EDDIInput.py": "class EDDIInput:\n"})
    write_file(tmp_path, "src/EDDIInput.py", b"class Inputs:\n")
    place = tmp_path / ".eddi/bases"
    place.write_text(place.read_text().replace("EDDIInput", "Inputs"))
    assert read_bases(tmp_path) == {"src/EDDIInput.py": "class Inputs:\n"}


def test_bases_that_an_earlier_release_or_its_branch_left_count(tmp_path: Path) -> None:
    write_bases(tmp_path, {"a": "1\n", "b": "2\n"})
    write_file(tmp_path, ".eddi/base/src/b", b"3\n")
    assert read_bases(tmp_path) == {"a": "1\n", "b": "2\n", "src/b": "3\n"}
    write_bases(tmp_path, read_bases(tmp_path))
    assert not (tmp_path / ".eddi/base").exists()
    assert read_bases(tmp_path)["src/b"] == "3\n"
    write_bases(tmp_path, {})
    assert not (tmp_path / ".eddi").exists()


@pytest.mark.parametrize("middle", ["", "||||||| base\n 2\n"])
def test_of_a_conflict_this_branch_counts(middle: str) -> None:
    text = text_of({"a": "1\n2\n"}).replace(
        " 2\n", f"<<<<<<< ours\n 3\n{middle}=======\n 4\n>>>>>>> theirs\n"
    )
    assert bases_of(text) == {"a": "1\n3\n"}


def test_branches_are_joined_file_by_file() -> None:
    base = {"same": "1\n", "gone": "1\n", "theirs": "1\n", "kept": "1\n", "both": "a\nb\nc\nd\n"}
    ours = {"same": "1\n", "theirs": "1\n", "both": "A\nb\nc\nd\n", "new": "2\n"}
    theirs = {**base, "theirs": "3\n", "kept": "3\n", "both": "a\nb\nc\nD\n"}
    wanted = {"same": "1\n", "theirs": "3\n", "kept": "3\n", "new": "2\n", "both": "A\nb\nc\nD\n"}
    for one, other in ((ours, theirs), (theirs, ours)):
        assert bases_of(join_bases(*map(text_of, (base, one, other)))) == wanted
