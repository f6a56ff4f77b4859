"""The models of our own nodes: read by our own reader, and found by the next monitor."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from eddi_scaffold.connect.robot import read_robot
from eddi_scaffold.connect.rossystem import parse, read_config_text
from eddi_scaffold.mros import load_models, load_system
from eddi_scaffold.mros.topics import simulator_outputs
from eddi_scaffold.platforms.ros_packages import nodes_of, specs_of
from tests.cli.command import EXAMPLE
from tests.data_files import data_text

WORKSPACE = EXAMPLE / "expected" / "src" / "eddi_monitor"
SYSTEM = WORKSPACE / "eddi_monitor_launcher" / "ros" / "eddi_monitors.rossystem"
CONFIG = data_text("platforms/rover_config.yml")


def test_the_system_is_read_with_all_topics_of_its_nodes() -> None:
    system, problems = load_system(SYSTEM, WORKSPACE)
    models = load_models(WORKSPACE)
    outputs = simulator_outputs(system, models)
    assert [*problems, *models.problems, *outputs.problems] == []
    types = ("ConSertOutput", "ConSertStatus", "Why")
    output, status, why = (f"eddi_messages/{name}" for name in types)
    assert [(topic.id, topic.type, topic.topic) for topic in outputs.topics] == [
        ("diagnostics", "diagnostic_msgs/DiagnosticArray", "/diagnostics"),
        ("conserta_guarantees", output, "/conserta/guarantees"),
        ("conserta_guarantees_status", status, "/conserta/guarantees/status"),
        ("conserta_guarantees_why", why, "/conserta/guarantees/why"),
        ("consertb_guarantees", output, "/consertb/guarantees"),
        ("consertb_guarantees_status", status, "/consertb/guarantees/status"),
        ("consertb_guarantees_why", why, "/consertb/guarantees/why"),
    ]


@pytest.mark.parametrize(
    "system",
    [
        'rover:\n  nodes:\n    consertb:\n      from: "consertb.consertb"\n',
        "rover:\n  subSystems:\n    eddi_monitors\n",
    ],
)
def test_the_next_monitor_finds_a_node_of_ours(system: str, tmp_path: Path) -> None:
    models = tmp_path / "nodes"
    for path in WORKSPACE.glob("*/ros/*"):
        (models / path.parent.parent.name / ".eddi").mkdir(parents=True, exist_ok=True)
        shutil.copy(path, models / path.parent.parent.name)
        shutil.copy(path, models / path.parent.parent.name / ".eddi")  # as in a package
    (tmp_path / "rover.rossystem").write_text(system)
    config = tmp_path / "eddi_config.yml"
    config.write_text(CONFIG)
    parsed = parse(read_robot(tmp_path / "rover.rossystem", models), read_config_text(config))
    assert parsed.problems == ()
    assert CONFIG.splitlines()[2] in parsed.after  # as it is, beside those that are new


def test_a_node_that_an_earlier_release_made_is_left_out() -> None:
    """It has no model yet that a system could refer to."""
    topic = {"topic": "a/out", "type": "std_msgs/msg/Bool"}
    part = {"section": "publishers", "direction": "pub", "topics": [topic]}
    row = "pub a/out std_msgs/msg/Bool"
    assert nodes_of({"old": {}, "a": {"interfaces": [row]}}) == [
        {"name": "a", "interfaces": [part]}
    ]


def test_fields_are_those_of_the_message_without_its_comments_and_constants() -> None:
    text = "# About it.\nuint8 TRUE=2\nstd_msgs/Header header\nGuarantee[] all\nfloat64[3] three\n"
    assert specs_of({"Status": text}) == [
        {
            "name": "Status",
            "fields": ["Header header", "'eddi_messages/msg/Guarantee'[] all", "float64[3] three"],
        }
    ]
