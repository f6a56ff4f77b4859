"""Paths out of files: only normalised ones below the folder, and not through links."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import inside
from eddi_scaffold.regions.package import is_relative


@pytest.mark.parametrize(
    "name",
    [
        "", ".", "..", "/", "/etc/passwd", "../x", "a/..", "a/../b", "a//b", "a/", "./a", "a/./b",
        "a\\..\\b", "a\nb", "a\0b", None, 3, ["a"], "//a",
        ".git", ".git/hooks/pre-commit", "a/.GIT/config",
    ],
)  # fmt: skip
def test_what_is_no_place_below_a_folder(name: object, tmp_path: Path) -> None:
    assert not is_relative(name)
    assert inside(tmp_path, name) is None


@pytest.mark.parametrize(
    "name", ["a", "a/b", ".eddi/base/EDDIInput.py", "a/..b", "ä b/c", "~", ".gitignore"]
)
def test_what_is(name: str, tmp_path: Path) -> None:
    assert inside(tmp_path, name) == tmp_path / name


def test_a_link_on_the_way_leads_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "folder").symlink_to("/")
    (tmp_path / "last").symlink_to("/etc/passwd")
    assert inside(tmp_path, "folder/etc") is None
    assert inside(tmp_path, "last") == tmp_path / "last"


@given(st.lists(st.sampled_from(["a", "b", "..", ".", "", "/", "\\"]), max_size=6))
def test_the_place_is_always_below(parts: list[str]) -> None:
    name = "/".join(parts)
    place = inside(Path("/root/of/all"), name)
    if place is not None:
        assert os.path.normpath(place) == str(place)
        assert Path("/root/of/all") in place.parents
