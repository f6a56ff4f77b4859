"""The metrics of a fleet, and what is made of them: alerts and a dashboard."""

import json
import re
from types import SimpleNamespace
from typing import Any

import pytest
from prometheus_client.openmetrics.parser import text_string_to_metric_families

from eddi_scaffold.watch.following import MAX_REASONS, samples_of
from eddi_scaffold.watch.messages import Message
from tests.cli.command import ROOT
from tests.pages import ask
from tests.watch.served import Fleet, diagnostics, serving

FOLDER = ROOT / "examples" / "fleet-metrics"
CONSERT = "eddi_messages/ConSertStatus"


@pytest.fixture
def fleet() -> Fleet:
    found = Fleet()
    found.play(12.5)
    steps = {"steps": "125", "overruns": "2", "longest_step_ms": "7.5"}
    lidar = {"nearest": "stale", "nearest__age_s": "0.9", "nearest__reason": "late"}
    found.take(diagnostics(12.5, "/robot1/lidar", **steps, **lidar))
    found.take(diagnostics(12.5, "/robot1/other", some="thing"))
    found.show()
    return found


def samples(fleet: Fleet) -> dict[str, dict[tuple[str, ...], float]]:
    return samples_of(fleet.feed.view.snapshot)


def test_states_reasons_steps_and_ages(fleet: Fleet) -> None:
    found = samples(fleet)
    full = ("/robot1", "warehouse", "FullSpeed")
    states = {k[3]: v for k, v in found["eddi_guarantee_state"].items() if k[:3] == full}
    assert states == {"active": 0.0, "not active": 0.0, "unknown": 1.0}
    assert found["eddi_guarantee_state_seconds"][full] == pytest.approx(0.2)
    assert (*full, "PathClear") in found["eddi_guarantee_reason"]
    lidar = ("/robot1", "lidar")
    assert found["eddi_monitor_longest_step_seconds"] == {lidar: 0.0075}
    assert found["eddi_monitor_steps_total"] == {lidar: 125}
    assert found["eddi_input_age_seconds"] == pytest.approx({(*lidar, "nearest"): 0.9})
    assert found["eddi_input_state"] == {(*lidar, "nearest", "stale"): 1.0}
    fleet.play(20.0, robots=("/robot2",))
    found = samples(fleet)
    assert found["eddi_monitor_silent"][lidar] == 1.0
    assert (*full, "silent") in found["eddi_guarantee_reason"]
    assert lidar not in found["eddi_monitor_steps_total"]  # nobody knows


def test_reasons_are_few() -> None:
    missing = [f"RtE{k}" for k in range(50)]
    rows = [SimpleNamespace(id="G", verdict=0, missing=missing)]
    content = SimpleNamespace(model_id="M", model_digest="", guarantees=rows, accepted=[])
    fleet = Fleet()
    fleet.take(Message("/r/m/g/status", CONSERT, content, 0.0))
    fleet.show()
    reasons = [labels[3] for labels in samples(fleet)["eddi_guarantee_reason"]]
    assert reasons == [*missing[:MAX_REASONS], "other"]


def test_of_two_monitors_of_one_name_the_worse_counts() -> None:
    fleet = Fleet()
    for verdict, node in ((2, "/r/a"), (1, "/r/b")):
        rows = [SimpleNamespace(id="G", verdict=verdict, missing=[])]
        content = SimpleNamespace(model_id="M", model_digest="", guarantees=rows, accepted=[])
        fleet.take(Message("/r/m/g/status", CONSERT, content, 0.0, node))
    fleet.show()
    states = samples(fleet)["eddi_guarantee_state"]
    assert [labels[3] for labels, value in states.items() if value] == ["unknown"]


def test_it_is_openmetrics(fleet: Fleet, monkeypatch: pytest.MonkeyPatch) -> None:
    attack = '"} 1\n# EOF\nevil{x="'
    rows = [SimpleNamespace(id=attack, verdict=2, missing=[])]
    content = SimpleNamespace(model_id=attack, model_digest="", guarantees=rows, accepted=[])
    fleet.take(Message(f"/{attack}/m/g/status", CONSERT, content, 12.5))
    fleet.show()
    with serving(fleet) as port:
        status, headers, text = ask(port, "/metrics")
        assert status == 200
        assert headers["Content-Type"].startswith("application/openmetrics-text; version=1.0.0")
        parsed: Any = {one.name: one for one in text_string_to_metric_families(text)}
        assert parsed.keys() == {name.removesuffix("_total") for name in samples(fleet)}
        states = parsed["eddi_guarantee_state"].samples
        assert attack.replace("\n", " ") in {one.labels["guarantee"] for one in states}
        assert ask(port, "/metrics", Host="prometheus.example:80")[0] == 403
        monkeypatch.setattr("eddi_scaffold.watch.page._OLD_S", -1.0)
        assert ask(port, "/metrics")[0] == 503


def test_alerts_and_dashboard_ask_for_what_there_is(fleet: Fleet) -> None:
    text = (FOLDER / "dashboard.json").read_text("utf-8")
    assert json.loads(text)["panels"]
    text += (FOLDER / "alerts.yml").read_text("utf-8")
    there = set(samples(fleet))
    asked = set(re.findall(r"\beddi_[a-z_]+", text))
    assert asked <= there
    readme = (FOLDER / "README.md").read_text("utf-8")
    assert set(re.findall(r"`(eddi_[a-z_]+)`", readme)) == there
