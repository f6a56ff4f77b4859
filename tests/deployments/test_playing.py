"""What ``run`` plays of several monitors is what the world of the deployments says of them."""

from dataclasses import replace
from pathlib import Path

import pytest

from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.playing import StepRule, of_messages, play
from tests.data_files import data_file
from tests.deployments.cases import Case, deployment_of, read_case
from tests.deployments.test_oracle import NAMES
from tests.deployments.world import MS, Claims, World

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
    rules = [StepRule(one.every * MS, on_change=False) for one in deployment.members]
    parts = of_messages([one.monitor for one in deployment.members], rules)
    members = {one.monitor.config.config.Model.id: one for one in deployment.members}
    ordered = [members[part.name or next(iter(members))] for part in parts]
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
