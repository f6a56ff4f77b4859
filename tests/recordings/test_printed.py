"""The examples' recordings as text, as CSV, as JSON and as a picture: they say the same."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.cli.command import ROOT, run

RECORDED = {
    "bayesian_network": "pedestrian/pedestrian.xml -c pedestrian/eddi_config.yml",
    "consert": "two-conserts/two_conserts.xml -c two-conserts/consert_a_config.yml",
    "event": "motor-watch/motor_watch.events -c motor-watch/motor_config.yml",
    "reliability": "drone/drone.xml -c drone/reliability_config.yml",
    "safeml": "safeml/safeml_config.yml -c safeml/perception_config.yml",
}
EXAMPLES = ROOT / "examples"


def printed(kind: str, *options: str | Path) -> str:
    words = RECORDED[kind].split()
    recording = Path(words[0]).with_name("recording.csv")
    result = run("run", *words, "--inputs", recording, *options, cwd=EXAMPLES)
    assert result.status == 0, result.err
    return result.out


@pytest.mark.parametrize("kind", RECORDED)
def test_every_form_has_the_same_steps(kind: str, tmp_path: Path) -> None:
    rows = list(csv.DictReader(printed(kind, "--csv").splitlines()))
    objects = [json.loads(line) for line in printed(kind, "--json").splitlines()]
    assert [float(row["t"]) for row in rows] == [one["t"] for one in objects]
    assert len({tuple(row) for row in rows}) == 1
    assert None not in rows[0]

    text = printed(kind, "--plot", tmp_path / "p.svg")
    changes = [float(line.split()[0]) for line in text.splitlines()]
    assert changes == sorted(set(changes))
    assert set(changes) <= {round(one["t"], 3) for one in objects}
    names = {"".join(one.itertext()).strip() for one in ET.parse(tmp_path / "p.svg").iter()}
    assert {name for name in rows[0] if name not in ("t", "reason", "unknown")} <= names


def test_json_tells_an_infinite_number_from_one_that_is_not_known(tmp_path: Path) -> None:
    recording = tmp_path / "r.csv"
    recording.write_text("t,vehicleSpeed,pedestrianDistance\n0,inf,-inf\n0.1,nan,nan\n")
    words = [*RECORDED["bayesian_network"].split(), "--inputs", recording, "--json"]
    rows = [
        json.loads(line)["inputs"] for line in run("run", *words, cwd=EXAMPLES).out.splitlines()
    ]
    assert [list(row.values()) for row in rows] == [["inf", "-inf"], [None, None]]
