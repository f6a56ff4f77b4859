"""The age limit of an input that has none: 2.5 periods of the monitors that it reads."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.problems import Problem
from tests.cli.command import run
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
    return [spec["max_age"] for spec in json.loads(monitor.model_json)["inputs"]]


def codes(problems: list[Problem]) -> list[str]:
    return [one.code for one in problems if one.code in ("K017", "K029", "K053")]


@pytest.mark.parametrize(
    ("source", "entry", "limit", "told"),
    [
        (BASE, READ, 0.625, ["K053"]),
        (LINK.format("/base"), READ, 0.625, ["K053"]),  # one topic, relative and absolute
        (BASE, f"{READ}, max_age: 3", 3.0, []),
        (BASE, f"{READ}, max_age: none", "none", []),
        (LINK.format("other"), READ, None, ["K017"]),  # whose, is not known here
        (SENSOR, "requires: [s]", None, ["K017"]),
        (  # the limit would be one for both
            f"{BASE}\n{SENSOR}",
            "expression: 'b.guarantees[G].active AND s.data'",
            None,
            ["K017"],
        ),
        (BASE, "expression: 'b.guarantees[G].active'", 0.625, ["K053"]),
        (
            BASE.replace("Output", "Status").replace("/out", "/out/status"),
            "expression: 'b.guarantees[G].verdict == 2'",
            0.625,
            ["K053"],
        ),
    ],
)
def test_the_limit_of_an_input_that_reads_a_monitor(
    source: str, entry: str, limit: object, told: list[str], tmp_path: Path
) -> None:
    base = written(tmp_path, "base", SENSOR, f"{LIMITED}, field: data")
    monitors, problems = read(written(tmp_path, "top", source, entry, 100.0), base)
    assert limits(monitors["top"]) == [limit]
    assert limits(monitors["base"]) == [0.5]
    assert codes(problems) == told


def test_it_is_told_with_the_number(tmp_path: Path) -> None:
    base = written(tmp_path, "base", SENSOR, LIMITED, 10.0)
    _, problems = read(base, written(tmp_path, "top", BASE, READ))
    (one,) = (one for one in problems if one.code == "K053")
    assert (one.level, one.place.line) == ("info", 4)
    assert one.message == (
        "input 'E' has no max_age: it is unknown after 0.25 s, "
        "2.5 periods of the monitor that publishes it"
    )


def test_the_slowest_publisher_counts(tmp_path: Path) -> None:
    sources = f"{BASE}\n{LINK.format('slow').replace('id: b', 'id: c')}"
    entry = "expression: 'b.guarantees[G].active AND c.guarantees[G].active'"
    monitors, _ = read(
        written(tmp_path, "base", SENSOR, LIMITED, 10.0),
        written(tmp_path, "slow", SENSOR, LIMITED, 1.0),
        written(tmp_path, "top", sources, entry),
    )
    assert limits(monitors["top"]) == [2.5]


def test_a_newer_model_keeps_the_limit(tmp_path: Path) -> None:
    written(tmp_path, "base", SENSOR, LIMITED)
    top = written(tmp_path, "top", BASE, READ)
    words = ["generate", "-w", "ws", "-c", "base_config.yml", "-c", top.name]
    (tmp_path / "ws").mkdir()
    made = run(*words, cwd=tmp_path)
    assert made.status == 0, made.err
    record = tmp_path / "ws/src/eddi_monitor/top/config/model.json"
    newer = tmp_path / "newer"
    newer.mkdir()
    text = CONSERT.format().replace("type: Fine", "type: Finer")
    (newer / "top.yml").write_text(text, "utf-8")

    def limit() -> object:
        (spec,) = json.loads(record.read_text("utf-8"))["inputs"]
        return spec["max_age"]

    assert limit() == 0.625
    model = ["upgrade", "-w", "ws", "-m", "newer/top.yml"]
    done = run(*model, cwd=tmp_path)
    assert done.status == 0, done.err
    assert "Finer" in record.read_text("utf-8")
    assert limit() == 0.625
    # a newer configuration without a limit gets it again, from the package beside it
    done = run(*model, "-c", top.name, cwd=tmp_path)
    assert done.status == 0, done.err
    assert limit() == 0.625
