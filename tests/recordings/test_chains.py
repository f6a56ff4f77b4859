"""Recordings through several monitors: what is true at each, and the sentences that say why not."""

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml
from eddi_runtime.why import ClaimWhy

from eddi_scaffold.common.claims import State
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.node import Publications, blank
from eddi_scaffold.recordings.playing import PlayedMonitor, play, played
from tests.checkouts import HERE
from tests.data_files import write_files

ORACLE = Path(__file__).parents[1] / "data" / "oracles" / "users" / "chains.yml"
CASES = {
    case["id"]: case for case in yaml.load(ORACLE.read_text("utf-8"), yaml.CSafeLoader)["cases"]
}
VALUES: Mapping[State, str] = {"active": "true", "not active": "false", "unknown": "unknown"}


@pytest.mark.parametrize("name", CASES)
def test_values(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    write_files(tmp_path, case["files"])
    monitors, _ = monitors_of(None, [tmp_path / one for one in case["configurations"]])
    parts = played([Member(monitor) for monitor in monitors])
    by_name = {one.id: one for one in monitors}
    values: dict[tuple[int, str], Mapping[str, str]] = {}
    whys: dict[tuple[int, str], Mapping[str, ClaimWhy]] = {}
    for part, frame in play(parts, _tape(case["samples"], monitors)):
        id_ = part.name or monitors[0].id
        values[round(frame.t * 1000), id_] = dict(_values(by_name[id_], part, frame.output))
        whys[round(frame.t * 1000), id_] = part.running.why()
    wanted = {(round(w["t"] * 1000), w["monitor"], w["claim"]): w["value"] for w in case["wants"]}
    assert {key: values[key[:2]][key[2]] for key in wanted} == wanted
    for want in case["wants"]:
        claim = whys[round(want["t"] * 1000), want["monitor"]][want["claim"]]
        cause = claim.causes[0] if claim.causes else None
        first = cause and {"topic": cause.topic, "state": cause.state}
        values_of = claim.as_json()
        assert (values_of["value"], claim.sentence) == (want["value"], want.get("text", "")), want
        assert first == want.get("first")


def _tape(samples: str, monitors: list[BoundMonitor]) -> Recording:
    types = {
        monitor.topic(source.topic): source.type
        for monitor in monitors
        for binding in monitor.inputs
        for source in binding.requires
    }
    found: list[Sample] = []
    rows = [*csv.DictReader(samples.splitlines())]
    times = [round(float(row["t"]) * 1000) * 1_000_000 for row in rows]
    for t, row in zip(times, rows, strict=True):
        for topic, cell in row.items():
            if topic != "t" and cell:
                message = blank(types[topic])
                message.data = _value(types[topic], cell)
                found.append(Sample(t, topic, message))
    return Recording(times[0], times[-1], tuple(found), tuple(times))


def _value(message_type: str, cell: str) -> Any:
    if message_type.endswith("MultiArray"):
        return [float(one) for one in cell.split()]
    if message_type.endswith("String"):
        return cell
    if message_type.endswith("Bool"):
        return cell == "true"
    return int(cell) if "Int" in message_type else float(cell)


def _values(monitor: BoundMonitor, part: PlayedMonitor, output: Any) -> Iterator[tuple[str, str]]:
    """Yield each claim and its value, as the messages of a step tell them."""
    if monitor.kind.name == "event":  # of a HAZARD its absence
        hazards = {one.id for one in part.running.events if one.hazard}
        for row in output:
            truth = row["verdict"] if row["id"] not in hazards else _not(row["verdict"])
            yield row["id"], {True: "true", False: "false", None: "unknown"}[truth]
        return
    publisher = Publications(monitor)
    for _, message in publisher.messages(part.running, output, publisher.topics):
        listen = monitor.kind.verdicts.get(message.message_type.partition("/")[2])
        for one in listen(message).verdicts if listen is not None else ():
            yield one.id, VALUES[one.state]


def _not(truth: bool | None) -> bool | None:
    return None if truth is None else not truth


def test_sentences_of_the_warehouse_robot() -> None:
    """What the table of situations says, where a recording can show it."""
    folder = HERE / "examples" / "warehouse-robot"
    monitors, _ = monitors_of(None, [folder / "robot.yml"])
    lines = (folder / "reference_sample.csv").read_text("utf-8").splitlines()
    frames = [line.replace(",", " ") for line in lines if line[:1] != "#"]
    rows = ["t,/lidar/nearest,/localisation/match,/wheels/slip,/battery/level,/drives/available"]
    rows[0] += ",/camera/features"
    for k in range(200):
        nearest = 1.2 if 80 <= k < 90 else 5.0
        cells = [
            nearest if k < 140 else "",
            0.9 if k < 50 or k >= 60 else "",
            0.01,
            90.0 if k < 161 else "",
            4,
            frames[k * 7 % len(frames)],
        ]
        rows.append(",".join(map(str, [k / 10, *cells])))
    parts = played([Member(monitor) for monitor in monitors])
    told = {
        round(frame.t, 1): part.running.why()["FullSpeed"].sentence
        for part, frame in play(parts, _tape("\n".join(rows), monitors))
        if part.name == "warehouse"
    }
    match, lidar = "Localised <- PoseIsGood <- matched <- /localisation/match", "/lidar/nearest"
    assert told[1.0] == "FullSpeed <- PeopleAreSeen <- in_scope: window has 11 of 30 samples"
    assert told[4.0] == ""
    late = f"{match}: nothing for 0.6 s, limit 0.5 s (Lost=Yes 0.001 .. 0.2, limit 0.1)"
    assert told[5.5] == f"FullSpeed <- {late}"
    assert told[8.6] == "FullSpeed <- PathClear: false for 0.6 s (nearest 1.2 m)"
    assert (
        told[14.6]
        == f"FullSpeed <- PathClear <- nearest <- {lidar}: nothing for 0.7 s, limit 0.3 s"
    )
    power = "PowerHolds <- LastsTheShift <- battery_level <- /battery/level"
    assert told[19.9] == (
        f"FullSpeed <- PathClear <- nearest <- {lidar}: nothing for 6.0 s, limit 0.3 s; "
        f"{power}: nothing for 3.9 s, limit 2 s (p_fail 2.1e-9 .. 1, limit 1.0e-4)"
    )
