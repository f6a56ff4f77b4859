"""ROS 1: names that would break a workspace, values as messages, and what is typed next."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import chosen
from eddi_scaffold.platforms.ros1 import monitor_answers, taken_names
from tests.cli.command import EXAMPLE

MANIFEST = "<package><name>{0}</name><version>1.0.0</version><description>d</description></package>"


def package(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.format(folder.name))


def test_packages_of_the_environment_are_taken_but_not_our_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "ws" / "src"
    for place in ("ws/src/navigation", "ws/src/eddi_monitor/conserta"):
        package(tmp_path / place)
    other = tmp_path / "other"
    other.mkdir()
    (other / "package.xml").write_text("<package>")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{source}:{other}")
    taken = taken_names(source / "eddi_monitor")
    assert taken["navigation"] == f"the ROS package navigation is in {source / 'navigation'}"
    assert "conserta" not in taken


@pytest.mark.parametrize("name", ["json", "rospy", "eddi_runtime", "class", "sitecustomize"])
def test_modules_and_own_packages_are_taken(name: str, tmp_path: Path) -> None:
    assert name in taken_names(tmp_path)


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


def test_a_field_is_published_as_a_message_of_std_msgs(tmp_path: Path) -> None:
    text = (EXAMPLE / "consert_b_config.yml").read_text("utf-8").rstrip()
    field = "'guarantees[System_A_G0_c2].active'"
    config = tmp_path / "c.yml"
    config.write_text(f"{text}\n  - {{id: go, topic: /consertb/go, field: {field}}}\n", "utf-8")
    (monitor,), _ = monitors_of(EXAMPLE / "two_conserts.xml", [config])
    package, problems = monitor_answers(monitor)
    assert problems == []
    result, value = package.answers["publications"]
    assert (result["type_text"], value["type_text"]) == (
        "eddi_messages/ConSertOutput",
        "std_msgs/Bool",
    )
    assert value["message_class"] == "Bool"
    assert "('guarantees', ('id', 'System_A_G0_c2'), 'active',)" in value["more"]
    assert (value["status_topic"], value["status_class"]) == ("None", "None")
    assert "from std_msgs.msg import Bool" in package.answers["message_imports"]
    assert "std_msgs" in package.answers["message_packages"]


@pytest.mark.parametrize("platform", ["ros1", "ros2"])
def test_a_workspace_is_entered_unless_one_is_there(platform: str) -> None:
    def build(place: str) -> str:
        steps = chosen(platform).next_steps(Path(place), [])
        return next(step for step in steps if "catkin_make" in step or "colcon build" in step)

    assert build("my ws") == f"cd 'my ws' && {build('.')}"
    assert not build(".").startswith("cd ")


def test_packages_of_python_are_installed_and_started_together() -> None:
    steps = chosen("dds").next_steps(Path("out"), ["arm", "cart"])
    assert list(steps) == ["pip install out/arm out/cart", "arm", "cart"]


def test_an_active_virtual_environment_is_left_before_ros_is_started(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("VIRTUAL_ENV", raising=False)
    without = chosen("ros1").next_steps(Path("ws"), [])
    monkeypatch.setenv("VIRTUAL_ENV", "/venv")
    first, *rest = chosen("ros1").next_steps(Path("ws"), [])
    assert first.startswith("deactivate ")
    assert rest == without
