"""Package names that would break a ROS 1 workspace."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eddi_scaffold.platforms.ros1 import taken_names

MANIFEST = "<package><name>{0}</name><version>1.0.0</version><description>d</description></package>"


def package(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(folder.name))


def test_packages_of_the_environment_and_of_the_workspace_are_taken_but_not_our_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "ws" / "src"
    for place in ("ws/src/navigation", "ws/src/eddi_monitor/conserta", "other/src/cart"):
        package(tmp_path / place)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "other" / "src"))
    taken = taken_names(source / "eddi_monitor")
    assert taken["navigation"] == f"the ROS package navigation is in {source / 'navigation'}"
    assert taken["cart"].endswith(
        "; a terminal in which its workspace is not sourced does not see it"
    )
    assert "conserta" not in taken


@pytest.mark.parametrize("name", ["json", "rospy", "eddi_runtime", "class", "sitecustomize"])
def test_modules_and_own_packages_are_taken(name: str, tmp_path: Path) -> None:
    assert name in taken_names(tmp_path)


def test_a_workspace_is_searched_as_rospkg_does_but_links_only_to_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    source = tmp_path / "ws" / "src"
    package(source / "deep" / "er" / "rover")
    package(source / "deep" / "er" / "rover" / "test" / "fixture")
    package(source / "ignored" / "lander")
    (source / "ignored" / "CATKIN_IGNORE").touch()
    package(tmp_path / "repository" / "crawler")
    package(tmp_path / "elsewhere" / "too" / "deep" / "diver")
    (source / "repository").symlink_to(tmp_path / "repository")
    (source / "one").symlink_to(tmp_path / "repository" / "crawler")
    (source / "elsewhere").symlink_to(tmp_path / "elsewhere")
    (source / "x").symlink_to("/")
    (source / "y").symlink_to("..")
    (source / "damaged").mkdir()
    (source / "damaged" / "package.xml").write_text("<package>")
    (source / "waiting").mkdir()
    os.mkfifo(source / "waiting" / "package.xml")
    taken = taken_names(source / "eddi_monitor")
    assert {"rover", "crawler"} <= set(taken)
    assert not {"fixture", "lander", "diver"} & set(taken)


def test_without_a_destination_no_package_of_ours_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package(tmp_path / "navigation")
    for place in ("src/eddi_monitor/conserta", "install/share/consertb"):
        package(tmp_path / place)
        manifest = tmp_path / place / "package.xml"
        text = manifest.read_text().replace(
            "</package>", "<exec_depend>eddi_runtime</exec_depend></package>"
        )
        manifest.write_text(text)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    taken = taken_names(None)
    assert {"navigation", "rospy"} <= set(taken)
    assert {"conserta", "consertb"} & set(taken) == set()
