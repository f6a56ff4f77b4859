"""Paths out of files: only normalised ones below the folder, and not through links."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import next_to
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.regions.package import is_relative
from tests.data_files import tabled


@tabled
def test_what_is_no_place_below_a_folder(name: object) -> None:
    assert not is_relative(name)


@pytest.mark.parametrize("name", ["", ".", "..", "/", "/etc", "../x", "a/../b", "a\nb", "//a"])
def test_a_file_does_not_name_one_elsewhere(name: str, tmp_path: Path) -> None:
    with pytest.raises(EddiError):
        next_to(str(tmp_path / "file"), name)


@pytest.mark.parametrize(
    "name", ["a", "a/b", ".eddi/base/EDDIInput.py", "a/..b", "ä b/c", "~", ".gitignore"]
)
def test_what_is(name: str, tmp_path: Path) -> None:
    assert is_relative(name)
    assert next_to(str(tmp_path / "file"), name) == tmp_path / name


def test_a_link_on_the_way_leads_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "folder").symlink_to("/")
    (tmp_path / "last").symlink_to("/etc/passwd")
    file = str(tmp_path / "file")
    with pytest.raises(EddiError):
        next_to(file, "folder/etc")
    assert next_to(file, "last") == tmp_path / "last"


@given(st.lists(st.sampled_from(["a", "b", "..", ".", "", "/", "\\"]), max_size=6))
def test_the_place_is_always_below(parts: list[str]) -> None:
    try:
        place = next_to("/root/of/all/file", "/".join(parts))
    except EddiError:
        return
    assert os.path.normpath(place) == str(place)
    assert Path("/root/of/all") in place.parents
