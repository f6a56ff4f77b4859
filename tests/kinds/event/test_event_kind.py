"""Events as a kind: a file becomes a monitor and a package, and so does a map of an EDDI."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from lxml import etree

from eddi_scaffold import api
from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.kinds import Model, Options
from eddi_scaffold.monitors.binding import monitor_of
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from tests.cli.command import run
from tests.data_files import data_text


def test_each_event_has_a_topic_of_its_own_where_the_configuration_says_so(tmp_path: Path) -> None:
    """Else the last message of a topic may be from any of them: that is no evidence (W005)."""
    config = tmp_path / "eddi_config.yml"
    text = data_text("events/overheat_config.yml")
    (tmp_path / "overheat.events").write_text(data_text("events/overheat.events"))
    config.write_text(text.replace("/events}", "/e, event: hot}"))
    (monitor,), problems = monitors_of(None, [config])
    assert "W005" not in {problem.code for problem in problems}
    package, _ = monitor_answers(monitor)
    assert "only='hot'," in package.answers["publications"][0]["more"]
    config.write_text(text.replace("/events}", "/e, event: nothing}"))
    (monitor,), _ = monitors_of(None, [config])
    assert [problem.code for problem in monitor_answers(monitor)[1]] == ["K020"]


def test_a_list_is_an_input_of_a_monitor(tmp_path: Path) -> None:
    (tmp_path / "scanner.events").write_text(data_text("events/scanner.events"))
    (tmp_path / "eddi_config.yml").write_text(data_text("events/scanner_config.yml"))
    rows = ["0,1 2 nan", "0.1,1 nan nan", "0.2,0.5 2 inf", "0.3,", "0.4,"]
    (tmp_path / "values.csv").write_text("\n".join(["t,scan.ranges[*]", *rows]) + "\n")
    assert run("check", "eddi_config.yml", "scanner.events", cwd=tmp_path).status == 0
    found = run("run", "eddi_config.yml", "--inputs", "values.csv", "--json", cwd=tmp_path)
    verdicts = [json.loads(line)["outputs"][0]["verdict"] for line in found.out.splitlines()]
    assert verdicts == [True, None, False, False, False]
    words = ("generate", "--platform", "plain", "-o", "out", "-m", "scanner.events")
    made = run(*words, "-c", "eddi_config.yml", cwd=tmp_path)
    assert made.status == 0, made.err
    (text,) = [file.read_text() for file in (tmp_path / "out").rglob("scanner/EDDIInput.py")]
    assert "= scan.ranges" in text


def test_the_monitor_says_what_its_text_accepts_while_it_claims(tmp_path: Path) -> None:
    (tmp_path / "scanner.events").write_text(data_text("events/scanner.events"))
    config = tmp_path / "eddi_config.yml"
    config.write_text(data_text("events/scanner_config.yml"))
    (made,), _ = monitors_of(None, [config])
    monitor = made.compiled.monitor(made.id)
    (name,) = [spec.attribute for spec in monitor.inputs]

    def said(values: object, second: int) -> tuple[object, object]:
        output = monitor.execute_step(SimpleNamespace(**{name: values}), second * 10**9)
        ((_, fields),) = monitor.message(output)
        assert fields["accepted"] == list(monitor.accepted())
        return fields["active"], fields["accepted"]

    assert said([1.0, 2.0, None], 0) == (True, ["free: COVERAGE 0.5", "free: ALLOW INF"])
    assert said([0.1, 0.2, 0.3], 1) == (False, [])


MODELS = Path(__file__).parents[2] / "eddi_xml" / "models"
LANDING = (MODELS / "landing.xml").read_text("utf-8")
EVENTS = data_text("events/winding.events")


def models(text: str) -> dict[str, Model]:
    reading = read_models(Source("landing.xml", text.encode()))
    assert [one for one in reading.problems if one.level == "error"] == []
    return {model.name: model for model in reading.models}


def part(model: Model) -> object:
    monitor, problems = monitor_of(replace(model, name="m"), None)
    assert monitor is not None, problems
    lines = monitor.compiled.text.partition("\nclass ")[2].splitlines()
    return [line for line in lines if not line.lstrip().startswith(("digest =", "#"))]


def test_they_are_the_events_of_a_file() -> None:
    found = models(LANDING)["motor_watch"]
    (alone,) = read_models(Source("motor_watch.events", EVENTS.encode())).models
    assert found.export() == {"motor_watch.events": EVENTS}
    assert part(found) == part(alone)


def test_another_tool_may_write_the_file() -> None:
    """As EMF does: other blanks, other prefixes, no comments; the maps with their order stay."""
    tree = etree.fromstring(LANDING.encode(), etree.XMLParser(remove_blank_text=True))
    assert tree.tag.endswith("DDIPackage")
    written = etree.tostring(tree, xml_declaration=True, encoding="ASCII").decode("ascii")
    assert written != LANDING
    one, other = models(LANDING), models(written)
    assert one.keys() == other.keys()
    assert part(one["motor_watch"]) == part(other["motor_watch"])
    assert one["motor_watch"].source.sha256 == other["motor_watch"].source.sha256


def test_the_frequency_counts_without_a_configuration() -> None:
    for text, rate in ((LANDING, 10.0), (LANDING.replace('"10"', '"50"'), 50.0)):
        configured, _ = models(text)["motor_watch"].configure(Options())
        assert configured is not None
        assert f"{rate:g} steps a second" in "".join(configured.readme())


def test_what_only_the_rate_decides_is_told_at_the_value() -> None:
    text = LANDING.replace("ONCE(temp > 80 degC, 2s)", "ONCE(temp > 80 degC, 1ms)")
    (model,) = [one for name, one in models(text).items() if name == "motor_watch"]
    configured, (problem, *_) = model.configure(Options(frequency=10.0))
    assert configured is None
    lines = text.splitlines()
    assert "1ms" in lines[(problem.place.line or 0) - 1]


def test_an_error_stops_generation(tmp_path: Path) -> None:
    (tmp_path / "landing.xml").write_text(LANDING.replace("ONCE(temp", "ONCE(tmp"), "utf-8")
    refused = run("generate", "--platform", "plain", "-o", "out", "-m", "landing.xml", cwd=tmp_path)
    assert (refused.status, "[E008]" in refused.err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_safeml_settings_are_those_of_a_file(tmp_path: Path) -> None:
    for name in ("scope.xml", "scope.csv"):
        (tmp_path / name).write_bytes((MODELS / name).read_bytes())
    assert run("export", "scope.xml", "-o", "out", cwd=tmp_path).status == 0
    (alone,) = read_models(read_source(tmp_path / "out" / "camera_scope.safeml.yml")).models
    (found,) = read_models(read_source(tmp_path / "scope.xml")).models
    assert part(alone) == part(found)


@pytest.mark.parametrize("name", ["w.events", "w.xml"])
def test_silence_is_a_matter_of_the_configuration(tmp_path: Path, name: str) -> None:
    model, config = tmp_path / name, tmp_path / "c.yml"
    whole = EVENTS if name == "w.events" else LANDING
    model.write_text(whole.replace(" TIMEOUT 500ms", ""), "utf-8")
    entry = "{id: temp, type: float, requires: [t], field: data, max_age: 0.5}"
    text = (
        f"Model: {{id: motor_watch, type: Event, parameters: [{{model: {name}}}]}}\n"
        "SimulatorOutputs: [{id: t, type: std_msgs.Float64, topic: t}]\n"
        f"EDDIInputs: [{entry}]\n"
        "EDDIOutputs: [{id: e, topic: e}]\n"
    )
    config.write_text(text, "utf-8")

    def codes(*files: Path) -> set[str]:
        return {one.code for one in api.check(files)} & {"W003", "K017"}

    assert codes(model) == codes(model, config) == codes(config) == set()
    config.write_text(text.replace(", max_age: 0.5", ""), "utf-8")
    assert codes(model, config) == codes(config) == {"K017"}
