"""What the answers say of an input."""

from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.monitors.answers import files_of, shared_answers
from eddi_scaffold.monitors.binding import monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "consert-yaml.md"
MODEL = PAGE.read_text(encoding="utf-8").partition("```yaml\n")[2].partition("```")[0]
CONFIG = """
Model: {{id: {id}, type: ConSert}}
SimulatorOutputs: [{{id: odometry, type: std_msgs.Float64, topic: /speed}}]
EDDIInputs: [{{id: WheelSpeed, requires: [odometry], unit: {unit}, max_age: 1}}]
EDDIOutputs: [{{id: rover, topic: /rover/guarantees}}]
"""


def wheel_speed(unit: str) -> dict[str, object]:
    (model,) = read_models(Source("Rover.yml", MODEL.encode())).models
    config, problems = read_config(Source("c.yml", CONFIG.format(id="Rover", unit=unit).encode()))
    assert config is not None, problems
    monitor, problems = monitor_of(model, config)
    assert monitor is not None, problems
    (found,) = [
        i for i in shared_answers(monitor, "x", {})["inputs"] if i["attribute"] == "WheelSpeed"
    ]
    return found


def test_another_unit_asks_for_a_look_and_stands_in_the_comment() -> None:
    metric, road = wheel_speed("m/s"), wheel_speed("km/h")
    assert metric["region_begin"] != road["region_begin"]
    assert metric["comments"] == ["float in m/s, good when MeasuredSpeed in [0, 2] m/s"]
    assert road["comments"] == [
        "float in km/h (converted to m/s), good when MeasuredSpeed in [0, 2] m/s"
    ]


def text_that_travels(description: str) -> dict[str, bytes]:
    events = f"// {description}\r\nVAR v : NUMBER TIMEOUT 1s  \r\nEVENT Slow := v < 1\r\n"
    (model,) = read_models(Source("slow.events", events.encode())).models
    monitor, problems = monitor_of(model, None)
    assert monitor is not None, problems
    return files_of(monitor)


def test_a_text_with_marks_of_regions_does_not_travel() -> None:
    """It would take the place of what a person wrote, or damage the package."""
    assert text_that_travels("-----Manual edit begin----- of a person") == {}
    assert text_that_travels("plain") == {
        "slow.events": b"// plain\nVAR v : NUMBER TIMEOUT 1s\nEVENT Slow := v < 1\n"
    }
