"""Events and SafeML settings that stand in an EDDI, as maps that every tool of the ODE keeps."""

from dataclasses import replace
from pathlib import Path

import pytest
from lxml import etree

from eddi_scaffold import api
from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import Model, Options
from eddi_scaffold.monitors.binding import monitor_of
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import run

MODELS = Path(__file__).parents[2] / "eddi_xml" / "models"
LANDING = (MODELS / "landing.xml").read_text("utf-8")
EVENTS = """// of the winding
VAR temp : NUMBER UNIT degC RANGE -40 .. 200 TIMEOUT 500ms
EVENT hot (HAZARD) := ONCE(temp > 80 degC, 2s)
EVENT MotorFit (EVIDENCE) := AVERAGE(temp, 2s) < 70 degC AND NOT hot
"""


def models(text: str) -> dict[str, Model]:
    reading = read_models(Source("landing.xml", text.encode()))
    assert [one for one in reading.problems if one.level == "error"] == []
    return {model.name: model for model in reading.models}


def part(model: Model) -> object:
    monitor, problems = monitor_of(replace(model, name="m"), None)
    assert monitor is not None, problems
    lines = monitor.compiled.text.partition("\nclass ")[2].splitlines()
    return [line for line in lines if not line.lstrip().startswith(("digest =", "#"))]


def problems(text: str) -> list[Problem]:
    return list(read_models(Source("landing.xml", text.encode())).problems)


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
    column = lines[(problem.place.line or 0) - 1].partition('value="')[2].index("1ms") + 1
    assert problem.message.startswith(f"EVENT, column {column}: ")


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('"model" value="motor_watch"', '"model" value="a..b"', "X010"),
        ('tag="VAR"', 'tag="VARR"', "X031"),
        ("TIMEOUT 500ms", "TIMEOUT 500ms // slow", "X031"),
        ("ONCE(temp", "ONCE(tmp", "E008"),
        ("motor_watch/hot", "motor_watch/cold", "X033"),
    ],
)
def test_an_error_stops_every_command(tmp_path: Path, old: str, new: str, code: str) -> None:
    (tmp_path / "landing.xml").write_text(LANDING.replace(old, new), "utf-8")
    refused = run("generate", "--platform", "plain", "-o", "out", "-m", "landing.xml", cwd=tmp_path)
    assert refused.status == 2
    assert f"[{code}]" in refused.err
    assert "landing.xml:" in refused.err
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
