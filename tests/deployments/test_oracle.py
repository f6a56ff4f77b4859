"""Every deployment of the oracle: what `check` says of its files, and what is claimed at each time.

A case that `check` refuses is done with that: what its monitors would claim counts only as long as
somebody can start them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.common.problems import Problem, has_errors
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.deployments.support import wired
from eddi_scaffold.deployments.wiring import check_wiring
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.playing import StepRule, play, played
from tests.data_files import ORACLES, data_file
from tests.deployments.cases import Case, deployment_of, read_case
from tests.deployments.world import MS, Claims, World

NAMES = sorted(path.stem for path in (ORACLES / "deployments").glob("*.yml"))

CODES = {"error": {"D001", "D002", "D003", "D005"}, "warning": {"D009", "K029"}}
"""By what `check` may refuse, or warn, where the oracle wants that."""


@pytest.fixture
def case(request: pytest.FixtureRequest, tmp_path: Path) -> Case:
    file = ORACLES / "deployments" / f"{request.param}.yml"
    return read_case(file.read_text("utf-8"), tmp_path)


@pytest.mark.parametrize("case", NAMES, indirect=True)
def test_check(case: Case) -> None:
    wanted, problems = case.content["check"], [*check_files(case.files), *_of_robots(case)]
    assert wanted == "error" or not has_errors(problems)
    if wanted in CODES:
        assert CODES[wanted] & {one.code for one in problems if one.level == wanted}, problems


def _of_robots(case: Case) -> list[Problem]:
    """Return what the wiring of robots in namespaces shows beside their files."""
    rows = [row for row in case.content["monitors"] if row.get("namespace")]
    members = [
        wired(monitors_of(None, [case.folder / row["config"]])[0][0], row["namespace"])
        for row in rows
    ]
    return check_wiring(members)


@pytest.mark.parametrize("case", NAMES, indirect=True)
def test_claims(case: Case) -> None:
    if case.content["check"] == "error":
        return
    deployment = deployment_of(case)
    hazards = {f"{m.name}.{name}" for m in deployment.members for name in m.publisher.hazards}
    steps = dict(World(deployment).run())
    assert [line for want in case.content["wants"] for line in _wrong(want, steps, hazards)] == []


def _wrong(
    want: Mapping[str, Any], steps: Mapping[int, Claims], hazards: set[str]
) -> Iterator[str]:
    first, last, output = round(want["from"] * 1000), round(want["to"] * 1000), want["output"]
    assert output in steps[first], (output, first)
    assert output in steps[last], (output, last)
    must = {"must_be_active": True, "must_be_inactive": False}.get(want["allow"])
    for t, claims in steps.items():
        if first <= t <= last and must is not None and output in claims:
            active = claims[output] != (output in hazards)
            if active is not must:
                yield f"{output} at {t / 1000} s {want['allow']}: {want['why']}"


NOT_ON_A_TAPE = {"dead", "restarts", "clock", "latching"}


def is_played(case: Case) -> bool:
    """Tell whether nothing happens but messages, to monitors of different configurations."""
    rows = case.content["monitors"]
    return (
        case.content["check"] != "error"
        and not NOT_ON_A_TAPE & case.content.keys()
        and not any(row.get("namespace") or row.get("delay") for row in rows)
        and not any("latched" in row[3:] for row in case.content["samples"])
        and len({row["config"] for row in rows}) == len(rows)
    )


@pytest.mark.parametrize("name", NAMES)
def test_the_same_is_claimed(name: str, tmp_path: Path) -> None:
    case = read_case(data_file(f"deployments/{name}.yml").read_text("utf-8"), tmp_path)
    if not is_played(case):
        return
    deployment = deployment_of(case)
    members = {one.monitor.id: one for one in deployment.members}
    parts = played([Member(one.monitor) for one in deployment.members])
    ordered = [members[part.name or next(iter(members))] for part in parts]
    rules = [StepRule(one.every * MS, on_change=False) for one in ordered]
    parts = [replace(part, rule=rule) for part, rule in zip(parts, rules, strict=True)]
    world = dict(World(replace(deployment, members=tuple(ordered))).run())
    samples = sorted(deployment.history.samples, key=lambda one: one.t)
    heard = tuple(Sample(one.t * MS, one.topic, one.message) for one in samples)
    claims: dict[int, dict[str, bool]] = {}
    for part, frame in play(parts, Recording(0, deployment.history.until * MS, heard)):
        member = members[part.name or next(iter(members))]
        publisher = member.publisher
        told = publisher.messages(part.running, frame.output, set(deployment.subscribers))
        said: Claims = publisher.claims(told)
        now = claims.setdefault(round(frame.t * 1000), {})
        now.update({f"{member.name}.{key}": claimed for key, claimed in said.items()})
    assert claims == {t: said for t, said in world.items() if said}
