"""Fault trees as large as people have them, which are public and not part of the project.

Expected values are those of CUDD, with orders and a reader of its own. ``EDDI_FOREIGN_DATA`` names
the folder that holds ``aralia/`` (``input/Aralia`` of github.com/rakhimov/scram) and
``generic-pwr/`` (``data/openpsa`` of github.com/openpra-org/generic-pwr-model).
"""

import json
import time

import pytest
from eddi_runtime.reliability.large_tree import LargeTree

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.reliability.compile import table
from eddi_scaffold.kinds.reliability.lowering import FaultTree, lower
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import data_file

pytestmark = pytest.mark.slow

VALUES = json.loads(data_file("large_trees.json").read_text("utf-8"))


def systems(file: str) -> dict[str, ReliabilitySystem]:
    source = Source(file.rpartition("/")[2], data_file(file).read_bytes())
    return {model.data.top: model.data for model in read_models(source).models}


def value(system: ReliabilitySystem) -> float:
    tree = lower(system).components[system.top]
    assert isinstance(tree, FaultTree)
    assert tree.diagram is not None
    diagram = tree.diagram

    class Tree(LargeTree):
        names = ()
        modules = table(diagram)  # type: ignore[assignment]

    return Tree().failure([event.values[0] for event in tree.events])


@pytest.mark.parametrize(("name", "expected"), VALUES["aralia"].items())
def test_the_aralia_trees_have_the_values_of_another_program_within_a_minute(
    name: str, expected: float
) -> None:
    (system,) = systems(f"aralia/{name}.xml").values()
    start = time.process_time()
    assert value(system) == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert time.process_time() - start < 60


@pytest.mark.parametrize(("file", "tree", "expected"), VALUES["generic-pwr"])
def test_trees_of_a_power_plant_have_the_values_of_another_program(
    file: str, tree: str, expected: float
) -> None:
    """With events of probability 0 and 1."""
    found = value(systems(f"generic-pwr/{file}")[tree])
    assert found == pytest.approx(expected, rel=1e-10, abs=0.0)
