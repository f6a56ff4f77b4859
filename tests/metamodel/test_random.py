"""Random EDDIs against truth tables, and damaged ones of every kind."""

from itertools import product

import pytest
from hypothesis import settings

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.reliability.show import at_start
from eddi_scaffold.monitors.loading import read_models
from tests.kinds.consert.example import monitor_of
from tests.metamodel.eddis import random_eddi

IS_LONG = settings().max_examples > 1000
SEEDS = range(500 if IS_LONG else 50)
NOT_OURS = {"X009", "X010", "X011"}
NOT_THESE = {"X014.no_input"}
NOT_THESE |= {"X007.at", "X007.nothing", "X007.token"}

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", SEEDS)
def test_random_eddis_give_what_truth_tables_say(seed: int) -> None:
    eddi = random_eddi(seed)
    reading = read_models(Source(f"{seed}.xml", eddi.data))
    assert not [one for one in reading.problems if one.level == "error"]
    consert, tree = reading.models
    problems = [
        *reading.problems,
        *(p for model in reading.models for p in model.check()),
    ]
    assert not {one.code for one in problems} & NOT_OURS
    assert not {one.case for one in problems} & NOT_THESE
    monitor, inputs = monitor_of(consert)
    for row in product([False, True], repeat=len(eddi.leaves)):
        true = dict(zip(eddi.leaves, row, strict=True))
        found = {one["id"]: one["active"] for one in monitor.execute_step(inputs(true))}
        assert found == {name: holds(true) for name, holds in eddi.guarantees.items()}
    assert at_start(tree.data).p_fail == pytest.approx(eddi.p_fail, rel=1e-9, abs=1e-12)
