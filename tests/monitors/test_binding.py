"""A model joined with its configuration, where no file of the diagnostics can show it."""

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.monitors.answers import VECTORS, files_of, shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.compiling import from_json
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import data_text, tabled
from tests.diagnosed import assert_reported

SPEED = data_text("monitors/speed.yml")


def config_text(entry: str, sources: str = "", top: str = "") -> str:
    """Return a configuration of SPEED that has one input."""
    text = data_text("monitors/speed_config.yml").replace("TOP", top)
    return text.replace("SOURCES", sources).replace("ENTRY", entry)


def joined(
    entry: str, sources: str = "", top: str = ""
) -> tuple[BoundMonitor | None, list[Problem]]:
    """Join SPEED with a configuration that has one input."""
    text = config_text(entry, sources, top)
    config, problems = read_config(Source("c.yml", text.encode()))
    assert config is not None, problems
    (model,) = read_models(Source("speed.yml", SPEED.encode())).models
    return monitor_of(model, config)


def sound(entry: str, **more: str) -> BoundMonitor:
    monitor, problems = joined(entry, **more)
    assert monitor is not None, problems
    return monitor


def test_the_only_field_of_a_message_is_taken_where_its_type_fits() -> None:
    (binding,) = sound("requires: [lidar]").inputs
    assert binding.expression == "lidar.data"
    text = "  - {id: text, type: std_msgs.String, topic: /text}\n"
    (binding,) = sound("requires: [text], max_age: none", sources=text).inputs
    assert binding.expression is None
    whole = "  - {id: whole, type: std_msgs.Int32, topic: /whole}\n"
    (binding,) = sound("requires: [whole], max_age: none", sources=whole).inputs
    assert binding.expression == "whole.data"


def test_the_shortest_age_of_what_is_required_counts_unless_the_input_says_one() -> None:
    assert sound("requires: [lidar, other]").inputs[0].max_age == 1.5
    assert sound("requires: [lidar], max_age: 0.25").inputs[0].max_age == 0.25
    assert sound("requires: [lidar], max_age: none").inputs[0].max_age == "none"
    never = "  - {id: never, type: std_msgs.Float32, topic: /n, max_age: none}\n"
    assert sound("requires: [never]", sources=never).inputs[0].max_age == "none"
    assert sound("requires: [never, lidar]", sources=never).inputs[0].max_age == 2.0


def test_a_unit_becomes_an_exact_factor() -> None:
    assert sound("requires: [lidar], unit: km").inputs[0].factor == (1000, 1)
    assert sound("requires: [lidar], unit: mm").inputs[0].factor == (1, 1000)
    assert sound("requires: [lidar], unit: m").inputs[0].factor is None
    assert sound("requires: [lidar], unit: meter").inputs[0].factor is None


@tabled
def test_a_default_must_fit_and_must_not_count_as_evidence(default: str, codes: list[str]) -> None:
    problems = joined(f"requires: [lidar], default: {default}")[1]
    assert [problem.code for problem in problems if problem.level == "error"] == codes


def test_facts_are_read_as_they_are_written() -> None:
    monitor = sound("requires: [lidar]", top=", guarantee_ids: class")
    (item,) = monitor.facts.inputs
    assert (item.id, item.requires, item.max_age) == ("Clearance", ("lidar",), 2.0)
    assert from_json(monitor.facts.to_json()) == monitor.facts


@pytest.mark.parametrize("text", ["", "{}", "[" * 10**5, None, '{"format": 1, "kind": 3}'])
def test_damaged_facts_are_refused(text: str | None) -> None:
    with pytest.raises(ValueError, match=r"acts|recursion limit"):
        from_json(text)


def test_without_a_configuration_a_value_of_its_own_id_is_taken() -> None:
    (model,) = read_models(Source("speed.yml", SPEED.encode())).models
    monitor, problems = monitor_of(model, None)
    assert monitor is not None
    assert problems == []
    (binding,) = monitor.inputs
    assert (binding.requires[0].id, binding.expression) == ("Clearance", "Clearance")


def test_two_inputs_with_one_attribute_are_e025() -> None:
    """Kinds that do not check this themselves get it checked here."""
    (model,) = read_models(Source("speed.yml", SPEED.encode())).models
    two = (ModelInput("a-b", "bool"), ModelInput("a.b", "bool"), ModelInput("c", "bool"))
    object.__setattr__(model, "inputs", lambda: two)
    object.__setattr__(model, "configure", lambda _: (model, []))
    monitor, problems = monitor_of(model, None)
    assert monitor is None
    assert_reported("K015", problems)


UNITS = data_text("monitors/units.yml")


def said(entry: str, uom: str = "m") -> list[tuple[str, str, str | None]]:
    """Return the errors of an input of SPEED in another unit."""
    text = SPEED.replace("uom: m", f"uom: {uom}")
    (model,) = read_models(Source("speed.yml", text.encode())).models
    config, problems = read_config(Source("c.yml", config_text(entry, UNITS).encode()))
    assert config is not None, problems
    _, found = monitor_of(model, config)
    return [(one.code, one.message, one.hint) for one in found if one.level == "error"]


@tabled
def test_units_that_agree(entry: str, uom: str) -> None:
    assert said(entry, uom) == []


@tabled
def test_a_unit_that_contradicts_the_message_is_an_error(source, path, uom, told, hint):
    ((code, message, way),) = said(f"requires: [{source}], field: {path}", uom)
    assert (code, message.partition(" is in ")[2]) == ("K022", told)
    unit = told.partition(",")[0]
    assert way == (hint and f"write `unit: {unit}`, which is converted: 1 {unit} is {hint}")


def test_an_expression_has_a_unit_as_well() -> None:
    ((_, message, _),) = said("expression: 'MIN(scan.ranges[*])'", "km")
    assert message == "MIN(scan.ranges[*]) is in m, 'Clearance' in km"


def test_another_unit_asks_for_a_look_and_stands_in_the_comment() -> None:
    metric, road = (
        shared_answers(sound(f"requires: [lidar], unit: {unit}"), "x", {})["inputs"][0]
        for unit in ("m", "km")
    )
    assert metric["region"] != road["region"]
    (comment,) = metric["comments"]
    assert road["comments"] == [comment.replace("in m,", "in km (converted to m),")]


@pytest.mark.parametrize(
    ("comment", "files"),
    [
        ("-----Manual edit begin----- of a person", {}),
        ("plain", {"s.events": b"// plain\nVAR v : NUMBER TIMEOUT 1s\nEVENT Slow := v < 1\n"}),
    ],
)
def test_a_text_with_marks_of_regions_does_not_travel(
    comment: str, files: dict[str, bytes]
) -> None:
    """It would take the place of what a person wrote, or damage the package."""
    events = f"// {comment}\r\nVAR v : NUMBER TIMEOUT 1s  \r\nEVENT Slow := v < 1\r\n"
    (model,) = read_models(Source("s.events", events.encode())).models
    monitor, problems = monitor_of(model, None)
    assert monitor is not None, problems
    assert files_of(monitor).keys() == {*files, "compiled.py", VECTORS}
    assert files_of(monitor).items() >= files.items()
