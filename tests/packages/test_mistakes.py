"""Mistakes in the body of an input are named; nothing is named that may be meant."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from eddi_scaffold.packages.mistakes import Messages
from eddi_scaffold.packages.review import doubtful_names
from eddi_scaffold.regions.marked_file import parse

FILE = """import math
from .eddi_runtime.history import EDDIInputBase


class EDDIInput(EDDIInputBase):
    def __init__(self):
        super().__init__()
        self.Upright = None
        self.Charge = None

    def process_Upright(self, imu):
        '''-----Manual edit begin-----'''  # region: process_Upright
        self.Upright = imu.orientation.x < 0.1
        '''-----Manual edit end-----'''  # region: process_Upright

    def process_Charge(self, battery):
        '''-----Manual edit begin-----'''  # region: process_Charge
        BODY
        '''-----Manual edit end-----'''  # region: process_Charge
"""


def doubts(
    body: str, file: str = FILE, messages: Mapping[str, Mapping[str, str]] | None = None
) -> tuple[str, ...]:
    text = file.replace("BODY", body.replace("\n", "\n        "))
    known = Messages({"battery": "sensor_msgs/BatteryState"}, messages or {})
    return doubtful_names(text, parse(text)[0].regions.values(), known).get("process_Charge", ())


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("self.Charge = batery.level", "'batery' is read, but nothing of that name is here"),
        ("self.Charge = np.clip(battery.level, 0, 1)", "'np' is read, but nothing of that name"),
        ("self.Charge = [x + y for x in battery.cells][0]", "'y' is read, but nothing"),
        ("self.Charge == battery.level", "'self.Charge == battery.level' only compares"),
        ("pass", "nothing here assigns 'self.Charge', so the input stays unknown"),
        ("level = battery.level\nprint(level)", "nothing here assigns 'self.Charge'"),
        ("self.Charge = 0,5 < battery.level", "makes a tuple; a decimal number has a point"),
        ("self.Charge = battery.level - 0,5", "makes a tuple; a decimal number has a point"),
        (
            "self.Charge = battery.level - 0.05\nself.Charge = None",
            "'self.Charge' is assigned, then overwritten by the placeholder in line 19: delete",
        ),
        (
            "if battery.level < 1:\n    self.Charge = battery.level\n# later\nself.Charge = None",
            "overwritten by the placeholder in line 21",
        ),
        ("self.Upright = True\nself.Charge = 1", "'self.Upright' is another input, and assigned"),
        ("self.Upright = battery.level > 0.2", "'self.Upright' is another input, and assigned"),
    ],
)
def test_a_mistake_is_named_once(body: str, said: str) -> None:
    (found,) = doubts(body)
    assert said in found


KNOWN = {
    "sensor_msgs/BatteryState": {"header": "std_msgs/Header", "cells": "my_msgs/Cell[]"},
    "std_msgs/Header": {"stamp": "time", "frame_id": "string"},
    "my_msgs/Cell": {"pose": "geometry_msgs/Pose", "other": "my_msgs/Unknown"},
    "geometry_msgs/Pose": {"orientation": "geometry_msgs/Quaternion"},
    "geometry_msgs/Quaternion": {"x": "float64", "w": "float64"},
}


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("battery.header.stmp", "'battery.header.stmp': std_msgs/Header has no such field; did y"),
        ("battery.cells[0].pose.orientation.q", "'battery.cells[0].pose.orientation.q': geometry"),
        ("battery.cells[-1].poise", "'battery.cells[-1].poise': my_msgs/Cell has no such field"),
        ("battery.heder.stamp", "'battery.heder': sensor_msgs/BatteryState has no such field"),
    ],
)
def test_a_field_is_compared_as_deep_as_types_are_known(body: str, said: str) -> None:
    (found,) = doubts(f"self.Charge = {body}", messages=KNOWN)
    assert found.startswith(said)


@pytest.mark.parametrize(
    "body",
    [
        "battery.cells[0].pose.orientation.w",
        "battery.cells[0].other.anything.at.all",
        "battery.header.stamp.to_sec() + battery.header.stamp.secs",
        "battery.header.frame_id.strip().upper().lower",
        "battery.cells.append(1) or battery.cells[0:2].whatever",
    ],
)
def test_what_may_be_a_field_is_not_named(body: str) -> None:
    assert doubts(f"self.Charge = {body}", messages=KNOWN) == ()


@pytest.mark.parametrize(
    "body",
    [
        "self.Charge = None",
        "self.Charge = None\nself.Charge = battery.level",
        "if battery.level < 1:\n    self.Charge = battery.level\n    return\nself.Charge = None",
        "self.Charge = battery.level\nif self.Charge > 1:\n    self.Charge = None",
        "self.Charge = battery.level\nprint(self.Charge)\nself.Charge = None",
        "self.Charge = battery.level\nself.process_Charge(None)\nself.Charge = None",
        "self.Charge = math.sqrt(battery.level) if __name__ else min(1, 2)",
        "import numpy as np\nself.Charge = np.clip(battery.level, 0, 1)",
        "self.Charge = sum(cell.level for cell in battery.cells)",
        "def fit(x):\n    return x + battery.level\nself.Charge = fit(1)",
        "try:\n    self.Charge = battery.level\nexcept AttributeError as e:\n    print(e)",
        "if battery.present and self.Upright:\n    self.Charge = battery.level",
        "for self.Charge in battery.levels:\n    break",
        "self.Charge = (1, 2)",
        "self.Charge = battery.low, battery.high",
        "setattr(self, 'Charge', 1)",
        "helper(self)\n\ndef helper(one):\n    one.Charge = 1",
    ],
)
def test_what_may_be_meant_is_not_named(body: str) -> None:
    assert doubts(body) == ()


def test_what_a_method_of_ones_own_sets_may_be_meant() -> None:
    more = FILE + "\n    def both(self, level):\n        self.Charge = level\n"
    assert doubts("self.both(battery.level)", more) == ()
    assert doubts("later(battery.level)", more + "\n\nfrom here import *\n") == ()
