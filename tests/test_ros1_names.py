"""Package names that would break a ROS 1 workspace."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.platforms.ros1.names import taken_names

MANIFEST = "<package><name>{0}</name><version>1.0.0</version><description>d</description></package>"


def package(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(folder.name))


def test_packages_of_the_ros_environment_are_taken_but_not_our_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "ws" / "src"
    package(source / "navigation")
    package(source / "eddi_monitor" / "conserta")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(source))
    taken = taken_names(source / "eddi_monitor")
    assert taken["navigation"] == f"the ROS package navigation is in {source / 'navigation'}"
    assert "conserta" not in taken


def test_a_package_elsewhere_in_the_workspace_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    package(tmp_path / "src" / "rover")
    assert "rover" in taken_names(tmp_path / "src" / "eddi_monitor")


@pytest.mark.parametrize("name", ["json", "rospy", "eddi_runtime", "class"])
def test_modules_and_own_packages_are_taken(name: str, tmp_path: Path) -> None:
    assert name in taken_names(tmp_path)
