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
