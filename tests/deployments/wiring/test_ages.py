"""Age limits of what one monitor reads of another."""

from pathlib import Path

import pytest

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from tests.deployments.wiring.test_bounds import LINK, READ, SENSOR
from tests.deployments.wiring.test_wiring import CONFIG, CONSERT

BASE = LINK.format("base")
LIMITED = "requires: [s], max_age: 0.5"


def written(folder: Path, name: str, sources: str, entry: str, frequency: float = 4.0) -> Path:
    """Write a ConSert and its configuration; ``entry`` is what its input is made of."""
    (folder / f"{name}.yml").write_text(CONSERT.format(), "utf-8")
    text = CONFIG.format(id=name, sources=sources, input=entry, topic=f"{name}/out")
    text = text.replace(", max_age: 0.5}]", "}]")
    text = text.replace("type: ConSert,", f"type: ConSert, frequency: {frequency},")
    config = folder / f"{name}_config.yml"
    config.write_text(text, "utf-8")
    return config


def read(*configs: Path) -> tuple[dict[str, BoundMonitor], list[Problem]]:
    monitors, problems = monitors_of(None, configs)
    return {one.package: one for one in monitors}, problems


def limits(monitor: BoundMonitor) -> list[object]:
    return [input_.max_age for input_ in monitor.facts.inputs]


def told(problems: list[Problem]) -> list[tuple[str, str]]:
    return [(one.code, one.level) for one in problems if one.code in ("K017", "K029")]


EXPRESSION = "expression: 'b.guarantees[G].active'"
STATUS = BASE.replace("Output", "Status").replace("/out", "/out/status")
READ_STATUS = "expression: 'b.guarantees[G].verdict == 2'"
SENSOR_AND_MONITOR = f"{BASE}\n{SENSOR}"


@pytest.mark.parametrize(
    ("source", "entry", "limit", "found"),
    [
        (BASE, READ, 1.0, []),
        (LINK.format("/base"), READ, 1.0, []),
        (LINK.format("other"), READ, 1.0, []),  # whose, does not matter
        (STATUS, READ_STATUS, 1.0, []),
        (BASE, f"{READ}, max_age: 3", 3.0, []),
        (BASE, f"{READ}, max_age: none", "none", []),
        (BASE.replace("}", ", max_age: 2}"), READ, 2.0, []),
        (BASE, EXPRESSION, 1.0, []),
        (SENSOR, "requires: [s]", None, [("K017", "warning")]),
        # of a sensor a person decides, also where an expression reads a monitor beside it
        (
            SENSOR_AND_MONITOR,
            "expression: 'b.guarantees[G].active AND s.data'",
            None,
            [("K017", "warning")],
        ),
        # what is written by hand gets both messages or none
        (SENSOR_AND_MONITOR, "requires: [b, s]", 1.0, []),
        (f"{BASE}\n{SENSOR.replace('}', ', max_age: 0.4}')}", "requires: [b, s]", 0.4, []),
    ],
)
def test_a_message_of_a_monitor_is_unknown_after_a_second(
    source: str, entry: str, limit: object, found: list[tuple[str, str]], tmp_path: Path
) -> None:
    base = written(tmp_path, "base", SENSOR, f"{LIMITED}, field: data")
    top = written(tmp_path, "top", source, entry, 100.0)
    alone, problems = read(top)
    assert (limits(alone["top"]), told(problems)) == ([limit], found)
    together, problems = read(top, base)
    assert (limits(together["top"]), told(problems)) == ([limit], found)
    assert together["top"].compiled.text == alone["top"].compiled.text


@pytest.mark.parametrize(
    ("frequency", "age", "text"),
    [
        (2.0, "", None),
        (1.0, ", max_age: 2", None),
        (1.0, ", max_age: none", None),
        (1.0, "", "error: input 'E' is unknown after 1 s, but base publishes only every 1 s"),
        (
            1.0,
            ", max_age: 1.9",
            "warning: input 'E' is unknown after 1.9 s, but base publishes only every 1 s",
        ),
    ],
)
@pytest.mark.parametrize("how", ["requires", "expression", "status"])
def test_a_publisher_that_is_too_slow_for_the_limit(
    frequency: float, age: str, text: str | None, how: str, tmp_path: Path
) -> None:
    source = STATUS if how == "status" else BASE
    entry = {"requires": READ, "status": READ_STATUS, "expression": EXPRESSION}[how]
    files = [
        written(tmp_path, "base", SENSOR, LIMITED, frequency),
        written(tmp_path, "top", source, f"{entry}{age}"),
    ]
    for given in (files, files[::-1]):
        problems = [one for one in check_files(given) if one.code == "K029"]
        assert [f"{one.level}: {one.message}" for one in problems] == ([text] if text else [])
        hints = {
            "error": "write `max_age: 2.5` in its",
            "warning": "at least 2 periods: max_age: 2",
        }
        assert all((one.hint or "").startswith(hints[one.level]) for one in problems)
