"""Events that an EDDI names for evidence and for nodes are candidates, and are not evaluated."""

from pathlib import Path

from tests.cli.command import run
from tests.metamodel.expected import FOLDER

TOPICS = """\
SimulatorOutputs:
  - {id: bat, type: sensor_msgs.BatteryState, topic: /power}
  - {id: fit, type: std_msgs.Bool, topic: /fit}
EDDIInputs: []
"""
EVENT = 'name="battery above 30 %"'
WATCH = """
      <keyValueMaps key="eddi.events">
        <values tag="model" value="watch"/>
        <values tag="VAR" value="level : NUMBER TIMEOUT 500ms"/>
        <values tag="EVENT" value="enough (EVIDENCE) := level > 0.3"/>
      </keyValueMaps>"""
CONFIG = """\
Model: {id: watch, type: Event, frequency: 10}
SimulatorOutputs:
  - {id: bat, type: sensor_msgs.BatteryState, topic: /power}
EDDIInputs:
  - {id: level, requires: [bat], field: percentage, max_age: 1}
EDDIOutputs:
  - {id: events, topic: watch/events}
"""


def test_what_the_condition_reads_is_the_first_candidate(tmp_path: Path) -> None:
    (tmp_path / "c.yml").write_text(TOPICS, "utf-8")
    model = FOLDER / "01_consert_minimal.xml"
    drafted = run("connect", str(model), "-o", "c.yml", "--dry-run", cwd=tmp_path).out
    lines = [line.removeprefix("+").strip() for line in drafted.splitlines()]
    first = lines.index("- id: BatteryFit") + 1
    assert lines[first] == (
        "# connect: the EDDI names the event battery above 30 % (battery.percentage > 0.3)"
    )
    assert 'expression: "bat.percentage == TODO"' in lines[first + 2]
    assert "expression: fit.data" in lines[first + 3]
    assert lines[first + 4].startswith("expression: TODO")


def test_the_event_of_another_monitor_is_taken(tmp_path: Path) -> None:
    text = (FOLDER / "01_consert_minimal.xml").read_text("utf-8")
    text = text.replace(EVENT, 'name="enough"')
    system = text.index(">", text.index("<systems ")) + 1
    (tmp_path / "m.xml").write_text(text[:system] + WATCH + text[system:], "utf-8")
    (tmp_path / "watch.yml").write_text(CONFIG, "utf-8")
    drafted = run("connect", "m.xml", "--name", "Rover", "--with", "watch.yml", cwd=tmp_path)
    assert "taken" in drafted.out, drafted.out + drafted.err
    assert "enough fulfils it" in drafted.out
