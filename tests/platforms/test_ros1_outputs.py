"""Outputs of a ROS 1 node: the whole result, or one value of it."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from tests.cli.command import EXAMPLE

FIELD = "guarantees[System_A_G0_c2].active"


def answers(tmp_path: Path, field: str) -> tuple[dict, list[str]]:
    text = (EXAMPLE / "consert_b_config.yml").read_text("utf-8")
    extra = f"  - {{id: go, topic: /consertb/go, field: '{field}'}}\n"
    config = tmp_path / "c.yml"
    config.write_text(f"{text.rstrip()}\n{extra}", "utf-8")
    (monitor,), _ = monitors_of(EXAMPLE / "two_conserts.xml", [config])
    package, problems = monitor_answers(monitor)
    assert {p.code for p in problems} <= {"K020"}
    return dict(package.answers), [
        f"{p.place.line}: {p.message}" + (f"; {p.hint}" if p.hint else "") for p in problems
    ]


def test_a_field_is_published_as_a_message_of_std_msgs(tmp_path: Path) -> None:
    found, problems = answers(tmp_path, FIELD)
    assert problems == []
    whole, value = found["publications"]
    assert (whole["type_text"], value["type_text"]) == (
        "eddi_messages/ConSertOutput",
        "std_msgs/Bool",
    )
    assert value["message_class"] == "Bool"
    assert "('guarantees', ('id', 'System_A_G0_c2'), 'active',)" in value["more"]
    assert (value["status_topic"], value["status_class"]) == ("None", "None")
    assert "from std_msgs.msg import Bool" in found["message_imports"]
    assert "std_msgs" in found["message_packages"]
