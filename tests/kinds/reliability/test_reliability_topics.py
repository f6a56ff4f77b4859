"""A threshold on a topic of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from tests.kinds.reliability.monitors import read_text, sound
from tests.kinds.reliability.test_reliability_example import EXAMPLE

THRESHOLD = "- {id: RtE_continue, activate: 1.0e-4, release: 2.0e-4, hold: 1 s"


def answers(folder: Path, topic: str) -> tuple[Any, list[str]]:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    config = folder / "c.yml"
    config.write_text(text.replace(THRESHOLD, f"{THRESHOLD}, topic: {topic}"), "utf-8")
    (monitor,), _ = monitors_of(EXAMPLE / "drone.xml", [config])
    package, problems = monitor_answers(monitor)
    return package.answers, [f"{p.place.line}: {p.code} {p.message}" for p in problems]


def test_a_threshold_is_published_as_a_bool(tmp_path: Path) -> None:
    found, problems = answers(tmp_path, "/drone/go")
    assert problems == []
    whole, own = found["publications"]
    assert whole["type_text"] == "eddi_messages/ReliabilityOutput"
    assert (own["id"], own["topic"], own["type_text"]) == (
        "'RtE_continue'",
        "'/drone/go'",
        "std_msgs/Bool",
    )
    assert "('evidence', ('id', 'RtE_continue'), 'active',)" in own["more"]
    assert own["status_topic"] == "None"
    assert "std_msgs" in found["message_packages"]


def test_a_topic_carries_one_type_and_is_not_heard(tmp_path: Path) -> None:
    """Outside of namespaces, ``/drone/reliability`` is the example's ``drone/reliability``."""
    both = "eddi_messages/ReliabilityOutput and std_msgs/Bool"
    assert answers(tmp_path, "/drone/reliability")[1] == [
        f"13: K031 the topic /drone/reliability would carry {both}"
    ]
    with pytest.raises(EddiError) as heard:
        answers(tmp_path, "drone/rotors_ok")
    assert [problem.code for problem in heard.value.problems] == ["D001"]


def test_a_topic_is_shown_and_exported() -> None:
    text = (
        "models: {m: {type: propulsion, configuration: PNPN, rate: 0.1 1/h}}\n"
        "thresholds: [{id: go, activate: 0.5, topic: /rte/go}]\n"
    )
    model = sound(text)
    assert model.outline()[-1] == "threshold go: p_fail <= 0.5, gone above 0.5, on /rte/go"
    (exported,) = model.export().values()
    again, problems = read_text(exported)
    assert (problems, again and again.data.thresholds) == ([], model.data.thresholds)
