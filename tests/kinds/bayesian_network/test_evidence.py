"""Evidence of networks: what is generated for it, and the shared cases of dying sensors."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from eddi_scaffold.platforms.ros_packages import messages_of
from tests.kinds.bayesian_network.networks import running
from tests.kinds.bayesian_network.test_network import EXAMPLE

LOW = '{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.3, hold: 1 s, topic: risk_is_low}'
MORE = "{id: Safe, node: Critical, state: ['No'], at_least: 0.8, release: 0.75}"


def pedestrian(folder: Path, evidence: str = "", outputs: str = "") -> BoundMonitor:
    text = (EXAMPLE / "eddi_config.yml").read_text("utf-8")
    section = f"  evidence: [{evidence}]\n" if evidence else ""
    config = folder / "c.yml"
    config.write_text(
        text.replace("SimulatorOutputs:", f"{section}SimulatorOutputs:").rstrip() + outputs, "utf-8"
    )
    (monitor,), problems = monitors_of(EXAMPLE / "pedestrian.xml", [config])
    assert [problem.code for problem in problems] == []
    return monitor


def test_evidence_has_a_topic_and_a_message_of_its_own(tmp_path: Path) -> None:
    package, problems = monitor_answers(pedestrian(tmp_path, f"{LOW}, {MORE}"))
    assert problems == []
    result, companion, alone = package.answers["publications"]
    assert (result["topic"], result["status_topic"]) == (
        "'pedestrian/risk'", "'pedestrian/risk/status'",
    )  # fmt: skip
    assert (companion["topic"], companion["more"].strip()) == (
        "'pedestrian/risk/evidence'", "of='evidence',",
    )  # fmt: skip
    assert companion["type_text"] == "eddi_messages/BayesianNetworkEvidence"
    assert (alone["topic"], alone["type_text"]) == ("'risk_is_low'", "std_msgs/Bool")
    assert "('evidence', ('id', 'RiskIsLow'), 'active',)" in alone["more"]


def test_a_value_beside_the_result_is_published_alone(tmp_path: Path) -> None:
    row = "\n  - {id: go, topic: go, field: 'evidence[Safe].active'}\n"
    package, problems = monitor_answers(pedestrian(tmp_path, MORE, row))
    assert problems == []
    *_, own = package.answers["publications"]
    assert (own["topic"], own["type_text"]) == ("'go'", "std_msgs/Bool")
    assert "of='evidence'," in own["more"]


def test_people_are_told_what_evidence_asks_for(tmp_path: Path) -> None:
    monitor = pedestrian(tmp_path, f"{LOW}, {MORE}")
    texts = [
        "P(Critical = Yes) <= 0.3 for 1 s, gone above 0.3, on risk_is_low",
        "P(Critical = No) >= 0.8, gone below 0.75",
    ]
    lines = monitor.model.outline()
    assert lines[-2:] == [f"evidence RiskIsLow: {texts[0]}", f"evidence Safe: {texts[1]}"]
    readme = monitor.model.readme()
    assert readme[-2:] == [f"| `RiskIsLow` | {texts[0]} |", f"| `Safe` | {texts[1]} |"]
    assert monitor.model.element_keys()["evidence"] == ["RiskIsLow", "Safe"]


def test_every_message_beside_a_result_has_a_method_and_a_definition(tmp_path: Path) -> None:
    monitor = pedestrian(tmp_path, f"{LOW}, {MORE}")
    machine = running(monitor)
    machine.execute_step(SimpleNamespace(), 0)
    texts = messages_of({"net": {"kind": "bayesian_network", "config_json": None}})
    for name, message in monitor.model.companion_messages().items():
        tree = getattr(machine, f"{name}_message")()
        assert tree[0] == message
        check_fields(tree, texts)


def check_fields(tree: Any, texts: dict[str, str]) -> None:
    name, fields = tree
    lines = [line.split() for line in texts[name].splitlines() if not line.startswith("#")]
    names = [line[1] for line in lines if line and "=" not in line[1]]
    assert sorted(fields) == sorted(set(names) - {"header"})
    for value in fields.values():
        for one in value if isinstance(value, list) else ():
            if isinstance(one, tuple):
                check_fields(one, texts)


def test_two_kinds_have_no_message_of_one_name() -> None:
    names = [name for kind in kinds().values() for name in kind.messages]
    assert len(names) == len(set(names))
