"""What ``generate`` says is next can be typed as it stands."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.platforms import chosen


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
