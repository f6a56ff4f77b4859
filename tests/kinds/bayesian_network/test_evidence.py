"""Evidence of networks: what is generated for it, and the shared cases of dying sensors."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from eddi_scaffold.platforms.ros_packages import messages_of
from tests.data_files import data_file
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
    whole, beside, alone = package.answers["publications"]
    assert (whole["topic"], whole["more"]) == ("'pedestrian/risk'", "")
    assert whole["status_topic"] == "'pedestrian/risk/status'"
    assert (beside["id"], beside["topic"]) == ("'risk/evidence'", "'pedestrian/risk/evidence'")
    assert beside["type_text"] == "eddi_messages/BayesianNetworkEvidence"
    assert beside["message_class"] == "eddi_messages.msg.BayesianNetworkEvidence"
    assert (beside["status_topic"], beside["more"].strip()) == ("None", "of='evidence',")
    assert (alone["topic"], alone["type_text"]) == ("'risk_is_low'", "std_msgs/Bool")
    assert "('evidence', ('id', 'RiskIsLow'), 'active',)" in alone["more"]
    assert "of='evidence'," in alone["more"]


def test_a_network_without_evidence_has_no_topic_for_it(tmp_path: Path) -> None:
    package, _ = monitor_answers(pedestrian(tmp_path))
    (whole,) = package.answers["publications"]
    assert whole["status_topic"] == "'pedestrian/risk/status'"
    (claim,) = pedestrian(tmp_path).facts.claims
    assert claim.id == "", "the whole result"


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


CASES = (
    "bn_at_least_and_sum", "bn_bins_and_range", "bn_both_die", "bn_hold", "bn_hysteresis_gap",
    "bn_impossible", "bn_map_other_value", "bn_missing_default", "bn_missing_hold",
    "bn_missing_prior", "bn_one_dies_bounds_fail", "bn_one_dies_bounds_hold", "all_five",
)  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_what_the_network_of_a_shared_case_may_claim(name: str, tmp_path: Path) -> None:
    case = yaml.safe_load(data_file(f"deployments/{name}.yml").read_text("utf-8"))
    for file, text in case["files"].items():
        (tmp_path / file).write_text(text, "utf-8")
    (one,) = (m for m in case["monitors"] if m["model"].endswith(".xmlbif"))
    (monitor,), problems = monitors_of(tmp_path / one["model"], [tmp_path / one["config"]])
    told = [problem.code for problem in problems if problem.level != "info"]
    assert told == (["D009"] if case["check"] == "warning" else [])
    wants = [w for w in case["wants"] if w["output"].startswith(f"{one['name']}.")]
    seen = 0
    for t, active in play(monitor, case, one["every"]):
        for want in wants:
            if want["from"] <= t <= want["to"] and want["allow"] != "free":
                claim = active[want["output"].partition(".")[2]]
                assert claim is (want["allow"] == "must_be_active"), (t, want)
                seen += 1
    assert seen


def play(
    monitor: BoundMonitor, case: dict[str, Any], every: float
) -> Iterator[tuple[float, dict[str, bool]]]:
    """Yield time and claims of each step; messages are as old as the case says."""
    assert monitor.config is not None
    config = monitor.config.config
    topics = {source.id: source.topic for source in config.SimulatorOutputs}
    machine = running(monitor)
    for k in range(round(case["until"] / every) + 1):
        t = k * every
        given: dict[str, object] = {}
        for item in config.EDDIInputs:
            got = [s for s in case["samples"] if s[1] == topics[item.requires[0]] and s[0] <= t]
            assert isinstance(item.max_age, float)
            fresh = bool(got) and t - got[-1][0] <= item.max_age
            given[item.id] = got[-1][2] if fresh else None if got else item.default
        machine.execute_step(SimpleNamespace(**given), round(t * 1e9))
        yield t, {claim.id: claim.active for claim in machine.claims()}
