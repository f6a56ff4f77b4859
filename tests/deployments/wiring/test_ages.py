"""The age limit of an input that has none: 2.5 periods of the monitors that it reads."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.problems import Problem
from tests.cli.command import Result, run
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


def _monitors(folder: Path) -> None:
    written(folder, "base", SENSOR, f"{LIMITED}, field: data")
    written(folder, "middle", BASE, READ, 2.0)


def _generate(folder: Path, target: str, *names: str) -> Result:
    configs = [word for name in names for word in ("-c", f"{name}_config.yml")]
    return run("generate", "--platform", "plain", "-o", target, *configs, cwd=folder)


def _files(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_one_by_one_the_packages_are_the_same_as_together(tmp_path: Path) -> None:
    _monitors(tmp_path)
    assert _generate(tmp_path, "all", "base", "middle").status == 0
    for name in ("base", "middle"):  # the publisher is there before its reader
        assert _generate(tmp_path, "one", name).status == 0
    assert _files(tmp_path / "one") == _files(tmp_path / "all")
    again = _generate(tmp_path, "all", "middle")
    assert (again.status, "K017" in again.err) == (0, False)
    assert _files(tmp_path / "one") == _files(tmp_path / "all")
    # a package knows its limit: without its publisher, and in the end by a word of acceptance
    shutil.rmtree(tmp_path / "one/base")
    lost = _generate(tmp_path, "one", "middle")
    assert lost.status == 3
    line = "middle: input 'E' has no age limit any more: it was unknown after 0.625 s"
    assert line in lost.err
    written(tmp_path, "middle", BASE, f"{READ}, max_age: none", 2.0)
    given_up = _generate(tmp_path, "all", "middle")
    assert (given_up.status, "no age limit any more" in given_up.err) == (0, False)


def test_a_reader_that_was_there_first_is_named_until_it_is_generated_again(tmp_path: Path) -> None:
    _monitors(tmp_path)
    first = _generate(tmp_path, "one", "middle")
    assert (first.status, "K017" in first.err) == (0, True)
    second = _generate(tmp_path, "one", "base")
    assert second.status == 3
    assert (
        "left alone: middle: input 'E' (from /base/out) has no max_age, and stays as it was if its "
        "publisher dies; 0.625 s, 2.5 periods, if its configuration is given to `generate` again"
    ) in second.err
    found = run("status", "one/base", "one/middle", cwd=tmp_path)
    assert (found.status, "look at: middle: input 'E' (from /base/out)" in found.out) == (1, True)
    assert _generate(tmp_path, "one", "middle").status == 0
    assert run("status", "one/base", "one/middle", cwd=tmp_path).status == 0
    assert _generate(tmp_path, "all", "base", "middle").status == 0
    assert _files(tmp_path / "one") == _files(tmp_path / "all")
