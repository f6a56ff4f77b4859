"""Inputs from expressions: checked in their places, and evaluated by the runtime."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.config.file import from_data
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from tests.checkouts import HERE
from tests.data_files import data_text, tabled

EXAMPLE = HERE / "examples" / "rover-events"
ROVER = data_text("monitors/rover_config.yml")
SECOND = 1_000_000_000


def joined(config: str, folder: Path = Path()) -> tuple[BoundMonitor | None, list[Problem]]:
    (model,) = read_models(read_source(EXAMPLE / "Rover.yml")).models
    file, problems = read_config(Source(str(folder / "c.yml"), config.encode()))
    if file is None:
        return None, problems
    monitor, found = monitor_of(model, file)
    return monitor, [*problems, *found]


def config(battery: str, motor: str = "expression: motor.data < 80", more: str = "") -> str:
    return ROVER.replace("MORE", more).replace("BATTERY", battery).replace("MOTOR", motor)


def sound(result: tuple[BoundMonitor | None, list[Problem]]) -> BoundMonitor:
    monitor, problems = result
    assert monitor is not None, problems
    return monitor


def bound(monitor: BoundMonitor) -> EDDIInputBase:
    eddi_input = EDDIInputBase()
    specs = monitor.compiled.monitor(monitor.id).inputs
    eddi_input.bind(specs)
    eddi_input.requires = {spec.id: spec.requires for spec in specs}
    return eddi_input


def step(
    eddi_input: EDDIInputBase, name: str, t: int, ages: dict[str, float], **messages: Any
) -> Any:
    eddi_input.begin_step(ages, None, t)
    eddi_input.update_expression(
        name,
        lambda *_: setattr(eddi_input, name, eddi_input.expression(name)),
        messages,
        eddi_input.requires[name],
    )
    return getattr(eddi_input, name)


def test_missing_stale_and_nan_are_unknown() -> None:
    eddi_input = bound(sound(joined(config('expression: "battery.percentage > 0.2"'))))
    good = SimpleNamespace(percentage=0.5)
    name = "BatteryIsFine"
    assert step(eddi_input, name, 0, {}) is None
    assert eddi_input.states[name].state == "missing"
    assert step(eddi_input, name, SECOND, {}, battery=good) is True
    assert step(eddi_input, name, 2 * SECOND, {"battery": 1.1}, battery=good) is None
    assert eddi_input.states[name].state == "stale"
    nan = SimpleNamespace(percentage=float("nan"))
    assert step(eddi_input, name, 3 * SECOND, {}, battery=nan) is None
    assert step(eddi_input, name, 4 * SECOND, {}, battery=SimpleNamespace()) is None
    assert step(eddi_input, name, 5 * SECOND, {}, battery=SimpleNamespace(percentage=0.1)) is False


def test_another_input_may_be_named() -> None:
    text = config(
        'expression: "battery.present"', 'expression: "BatteryIsFine AND motor.data < 80"'
    )
    eddi_input = bound(sound(joined(text)))
    messages = {"battery": SimpleNamespace(present=True), "motor": SimpleNamespace(data=20.0)}
    assert step(eddi_input, "BatteryIsFine", 0, {}, **messages) is True
    assert step(eddi_input, "MotorIsCool", 0, {}, **messages) is True


@tabled
def test_what_is_wrong_and_where(battery: str, code: str, line: int, col: int, words: str) -> None:
    monitor, problems = joined(config(battery))
    assert monitor is None
    found = [(p.code, p.place.line, p.place.col) for p in problems if p.level == "error"]
    assert (code, line, col) in found
    assert words in " ".join(problem.message for problem in problems)


SAFETY = data_text("monitors/safety.events")


def from_file(
    folder: Path, keys: str, text: str | None = None, more: str = ""
) -> tuple[BoundMonitor | None, list[Problem]]:
    (folder / "safety.events").write_text(text or SAFETY, encoding="utf-8")
    entry = f"expression_file: safety.events{keys}"
    return joined(config("expression: battery.present", entry, more), folder)


def test_the_event_of_a_file_is_the_expression(tmp_path: Path) -> None:
    monitor, problems = from_file(tmp_path, "\n    event: cool")
    assert monitor is not None, problems
    assert problems == []
    motor = monitor.inputs[1]
    assert [source.id for source in motor.requires] == ["motor"]
    assert motor.text == "cool of safety.events: (NOT hot)"
    eddi_input = bound(monitor)
    name = "MotorIsCool"
    assert step(eddi_input, name, 0, {}) is True  # of a HAZARD, as the file says
    assert step(eddi_input, name, SECOND, {}, motor=SimpleNamespace(data=90.0)) is False
    assert step(eddi_input, name, 2 * SECOND, {}, motor=SimpleNamespace(data=70.0)) is False


def test_the_configuration_says_what_the_event_does_not(tmp_path: Path) -> None:
    monitor, problems = from_file(tmp_path, "\n    event: weak")
    assert monitor is not None, problems
    (problem,) = problems
    assert (problem.code, problem.place.line, problem.place.col) == ("W002", 5, 7)
    monitor, problems = from_file(tmp_path, "\n    event: weak\n    polarity: HAZARD")
    assert monitor is not None, problems
    assert problems == []
    assert step(bound(monitor), "MotorIsCool", 0, {}) is True


def test_a_remembered_configuration_needs_no_file(tmp_path: Path) -> None:
    monitor = sound(from_file(tmp_path, "\n    event: cool"))
    assert monitor.config is not None
    (tmp_path / "safety.events").unlink()
    again = from_data(monitor.config.as_data(), "the configuration that rover remembers")
    other, problems = monitor_of(monitor.model, again)
    assert other is not None, problems
    assert other.compiled.text == monitor.compiled.text
    assert again.as_data() == monitor.config.as_data()


@tabled
def test_what_is_wrong_with_a_file_and_where(keys, text, where, words, tmp_path):
    monitor, problems = from_file(tmp_path, "".join(f"\n    {key}" for key in keys), text)
    assert monitor is None
    (found,) = [one for one in problems if one.level == "error"]
    place = found.place
    assert f"{Path(place.file or '').name}:{place.line}:{place.col} {found.code}" == where
    assert words in f"{found.message}; {found.hint}"


def test_a_file_that_is_no_text_is_reported_in_its_place(tmp_path: Path) -> None:
    (tmp_path / "safty.events").write_bytes(b"x > 1\n// \xe9")
    entry = "expression_file: safty.events"
    _, (problem,) = joined(config("expression: battery.present", entry), tmp_path)
    place = problem.place
    assert (problem.code, place.file, place.line) == ("E001", str(tmp_path / "safty.events"), 2)


KEYED = """  - {id: seen, type: eddi_messages.BayesianNetworkOutput, topic: /seen, max_age: 1}
  - {id: joints, type: sensor_msgs.JointState, topic: /joints, max_age: 1}
"""


def outcome(name: str, value: float) -> SimpleNamespace:
    return SimpleNamespace(outcome_name=name, outcome_value=value)


def test_elements_are_taken_by_their_keys_and_never_by_their_place() -> None:
    path = "seen.output_nodes[Collision].outcomes[High].outcome_value"
    gripper = "ABS(joints.position[gripper]) < 0.05"
    eddi_input = bound(
        sound(joined(config(f"expression: {path} < 0.2", f"expression: {gripper}", KEYED)))
    )
    others = [outcome("Low", 0.9), outcome("High", 0.1)]
    nodes = [
        SimpleNamespace(title="Speed", outcomes=others[::-1]),
        SimpleNamespace(title="Collision", outcomes=others),
    ]
    name = "BatteryIsFine"
    for order in (nodes, nodes[::-1]):
        found = step(eddi_input, name, 0, {}, seen=SimpleNamespace(output_nodes=order))
        assert found is True
        eddi_input.begin_step({}, None, -1)
    assert step(eddi_input, name, 2, {}, seen=SimpleNamespace(output_nodes=nodes[:1])) is None
    reason = "LookupError: no element has the title 'Collision'; there: Speed"
    assert eddi_input.states[name].reason == reason
    joints = SimpleNamespace(name=["arm", "gripper"], position=[1.0, 0.01])
    assert step(eddi_input, "MotorIsCool", 3, {}, joints=joints) is True
    joints.position = []
    assert step(eddi_input, "MotorIsCool", 4, {}, joints=joints) is None
    reason = "LookupError: 0 values have 2 names"
    assert eddi_input.states["MotorIsCool"].reason == reason


@tabled
def test_a_key_that_no_field_is_is_an_error(text: str, message: str) -> None:
    _, problems = joined(config(text, more=KEYED))
    (problem,) = [one for one in problems if one.code == "K020"]
    assert message in problem.message
    assert "battery" in text or "outcome" in problem.message


def test_keys_of_names_that_a_var_declares() -> None:
    more = "  - {id: mine, type: my_msgs.Mine, topic: /mine, max_age: 1}\n"
    declared = 'declarations: ["VAR mine.items[front].good : BOOL"]\n'
    monitor = sound(joined(config('expression: "mine.items[front].good"', more=more + declared)))
    items = [SimpleNamespace(id="rear", good=False), SimpleNamespace(id="front", good=True)]
    mine = SimpleNamespace(items=items)
    assert step(bound(monitor), "BatteryIsFine", 0, {}, mine=mine) is True


SCAN = "  - {id: scan, type: sensor_msgs.LaserScan, topic: /scan, max_age: 1}\n"


def scan_of(*ranges: float, **more: Any) -> SimpleNamespace:
    count = max(1, len(ranges) - 1)
    said = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 2 / count}
    said |= {"range_min": 0.1, "range_max": 30.0, **more}
    return SimpleNamespace(ranges=list(ranges), **said)


INF, NAN = float("inf"), float("nan")


@tabled
def test_scans(expression: str, ranges: tuple[float, ...], wanted: bool | None) -> None:
    monitor = sound(joined(config(f'expression: "{expression}"', more=SCAN)))
    assert step(bound(monitor), "BatteryIsFine", 0, {}, scan=scan_of(*ranges)) is wanted


def test_the_status_says_why_a_list_gives_nothing() -> None:
    text = config('expression: "MIN(scan.ranges[*], LENGTH 3) > 1"', more=SCAN)
    eddi_input = bound(sound(joined(text)))
    for t, scan, reason in (
        (0, scan_of(5.0, NAN, NAN), "2 of 3 elements are not known"),
        (1, scan_of(5.0), "1 elements instead of 3"),
        (2, scan_of(5.0, 5.0, 5.0, range_max=NAN), "the limits are not known"),
        (3, SimpleNamespace(), "AttributeError: 'types.SimpleNamespace' object has no"),
    ):
        assert step(eddi_input, "BatteryIsFine", t, {}, scan=scan) is None
        assert eddi_input.states["BatteryIsFine"].reason.startswith(reason)
    assert step(eddi_input, "BatteryIsFine", 4, {}, scan=scan_of(5.0, 5.0, 5.0)) is True


@tabled
def test_what_the_documentation_calls_no_measurement(source, expression, fields, wanted):
    more = f"  - {{id: x, type: sensor_msgs.{source}, topic: /x, max_age: 1}}\n"
    monitor = sound(joined(config(f'expression: "{expression}"', more=more)))
    message = SimpleNamespace(
        min_range=0.1,
        max_range=4.0,
        latitude=50.0,
        status=SimpleNamespace(status=fields.pop("status", 0)),
        angular_velocity=SimpleNamespace(z=0.5),
        angular_velocity_covariance=[fields.pop("covariance", 0.0)] * 9,
        **fields,
    )
    assert step(bound(monitor), "BatteryIsFine", 0, {}, x=message) is wanted


@tabled
def test_lists_that_cannot_be(text: str, code: str, message: str) -> None:
    _, problems = joined(config(f'expression: "{text}"', more=SCAN))
    (problem,) = [one for one in problems if one.level == "error"]
    assert problem.code == code
    assert message in problem.message


def test_a_var_that_contradicts_the_message_is_an_error() -> None:
    for said, codes in (("UNIT pct", ["E009"]), ("UNIT fraction", []), ("", [])):
        declared = f'declarations: ["VAR battery.percentage : NUMBER {said} TIMEOUT 1s"]\n'
        _, problems = joined(config("expression: battery.percentage > 0.2", more=declared))
        assert [one.code for one in problems if one.level == "error"] == codes


def test_percent_is_a_unit_of_numbers() -> None:
    for text in ("battery.percentage > 20 %", "battery.percentage > 20% AND TRUE"):
        assert joined(config(f'expression: "{text}"'))[1] == []
    _, problems = joined(config('expression: "battery.percentage % 2 > 1"'))
    assert "E001" in {problem.code for problem in problems}
