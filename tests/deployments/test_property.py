"""Random deployments: nothing good is claimed because something is silent.

Each run looks at 200 deployments, `--hypothesis-profile=long` at 100,000, always the same ones.
"""

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from eddi_runtime.expressions import expression
from hypothesis import settings

from eddi_scaffold.common.problems import EddiError, has_errors
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.program import running as execution
from eddi_scaffold.recordings import node
from tests.data_files import data_text
from tests.deployments.cases import deployment_of as deployment_of_case
from tests.deployments.cases import read_case
from tests.deployments.drafts import Draft, Instance, deployment_of, running_of
from tests.deployments.drawing import RUNTIME, draft_of, faulty, fleet, robot_of
from tests.deployments.pool.events import UNSOUND
from tests.deployments.pool.templates import BAD, INVERTED, OUT, dump, with_topics
from tests.deployments.properties import Check
from tests.deployments.world import Observer, World


def text_of(draft: Draft, name: str, about: str) -> str:
    """Return a draft with all its files, as a case of the oracle without its wants."""
    history = draft.history
    read = {topic for instance in draft.instances for topic in instance.topics.values()}
    files: dict[str, str] = {}
    for instance in draft.instances:
        files.update(_files(instance))
    document: dict[str, Any] = {
        "id": name,
        "about": about,
        "files": files,
        "monitors": [_row(instance) for instance in draft.instances],
        "until": history.until / 1000,
        "latching": history.latching,
        "dead": [[who, begin / 1000, end / 1000] for who, begin, end in history.dead],
        "restarts": [[t / 1000, who] for t, who in history.restarts],
        "clock": [[t / 1000, by / 1000] for t, by in history.clock],
        "samples": [
            [one.t / 1000, one.topic, one.value, *(["latched"] if one.latched else [])]
            for one in draft.values
            if one.topic in read
        ],
    }
    return dump(document)


def _files(instance: Instance) -> Mapping[str, str]:
    template = instance.template
    files = dict(with_topics(template, {**instance.topics, OUT: instance.out}))
    config = files.pop(f"{template.name}_config.yml")
    return {**files, f"{instance.name}_config.yml": config}


def _row(instance: Instance) -> dict[str, Any]:
    every, delay = instance.template.every / 1000, instance.delay / 1000
    row = {"name": instance.name, "config": f"{instance.name}_config.yml", "every": every}
    return {**row, "delay": delay} if delay else row


SIZE = 100
"""Deployments of one test."""
SHARDS = 1000 if settings.default.max_examples > 1000 else 2
FAULTS = (*BAD, *UNSOUND, "cycle", *RUNTIME)
PATIENCE = 60
"""Deployments with a fault of which one at least must be found."""


@pytest.fixture(autouse=True, scope="module")
def _compile_once() -> Iterator[None]:
    """Compile equal expressions once: a process that begins anew compiles its own again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(execution, "compile", cache(compile), raising=False)
        yield


@pytest.mark.slow
@pytest.mark.parametrize("shard", range(SHARDS))
def test_silence_claims_nothing(shard: int) -> None:
    compared = 0
    for seed in range(shard * SIZE, (shard + 1) * SIZE):
        rng = Random(seed)
        check = Check(draft_of(rng), rng)
        violation = check.violation()
        assert violation is None, text_of(check.draft, f"seed {seed}", str(violation))
        compared += check.compared
    assert compared > 20 * SIZE


@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_found(fault: str) -> None:
    """As long as the product does not refuse it itself."""
    for number in range(PATIENCE):
        rng = Random(f"{fault} {number}")
        try:
            check = Check(faulty(fault, rng), rng, RUNTIME.get(fault, Observer))
        except EddiError:
            return
        if check.violation() is not None:
            return
    pytest.fail(f"{fault} was not found in {PATIENCE} deployments")


@pytest.mark.parametrize("reading", INVERTED)
def test_what_is_read_inverted_is_no_fault(reading: str) -> None:
    """Nothing comes of silence, also where `check` does not know who publishes it."""
    for number in range(PATIENCE // 3):
        rng = Random(f"{reading} {number}")
        check = Check(faulty(reading, rng), rng)
        assert check.violation() is None, number


@pytest.fixture
def taken_as_false(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a fault back: who reads a claim takes it as it is, and false when it is not given."""

    def as_it_is(value: object, *_: object) -> object:
        return value

    monkeypatch.setitem(node._HELPERS, "given", as_it_is)
    monkeypatch.setattr(expression, "given", as_it_is)


@pytest.mark.usefixtures("taken_as_false")
def test_a_claim_that_is_not_given_and_taken_as_false_is_found() -> None:
    rngs = [Random(f"not given {number}") for number in range(PATIENCE)]
    assert sum(Check(draft_of(rng), rng).violation() is not None for rng in rngs) > 1


def test_a_bound_is_not_known_to_be_too_high(tmp_path: Path) -> None:
    """While a message was missed, ``p_fail`` is the worst that may be, for FALSE as for TRUE."""
    case = read_case(data_text("deployments/bound.yml"), tmp_path)
    claims = {t: dict(of) for t, of in World(deployment_of_case(case)).run()}
    assert [claims[t]["m5.G"] for t in (0, 500, 1000)] == [False, False, True]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(20))
def test_check_accepts_them_as_files(number: int, tmp_path: Path) -> None:
    """And the files give the same claims as the monitors of the pool."""
    draft = draft_of(Random(f"files {number}"))
    case = read_case(text_of(draft, "drawn", ""), tmp_path)
    problems = check_files(case.files)
    # one template drawn twice would be one package in one workspace, here it is two processes
    assert not has_errors(one for one in problems if one.code != "G004"), problems
    assert list(World(deployment_of_case(case)).run()) == list(World(deployment_of(draft)).run())


@pytest.mark.parametrize("shared", [False, True])
def test_robots_do_not_lean_on_each_other(shared: bool) -> None:
    """But where a topic of a monitor is the same for both, which must be found."""
    leaning = 0
    for number in range(20):
        draft = fleet(Random(number), shared=shared)
        running = running_of(draft)
        one = robot_of(draft, "r1")
        alone = dict(World(deployment_of(one), running=running).run())
        for t, claims in World(deployment_of(draft), running=running).run():
            leaning += any(claims[name] and not claimed for name, claimed in alone[t].items())
    assert bool(leaning) is shared
