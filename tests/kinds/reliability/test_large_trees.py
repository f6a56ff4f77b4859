"""Fault trees as large as people have them, which are public and not part of the project.

Expected values are those of CUDD, with orders and a reader of its own. ``EDDI_FOREIGN_DATA`` names
the folder that holds ``aralia/`` (``input/Aralia`` of github.com/rakhimov/scram) and
``generic-pwr/`` (``data/openpsa`` of github.com/openpra-org/generic-pwr-model).
"""

from __future__ import annotations

import time

import pytest
from eddi_runtime.reliability.large_tree import LargeTree

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.reliability.component_text import table
from eddi_scaffold.kinds.reliability.lowering import FaultTree, lower
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import data_file

pytestmark = pytest.mark.slow

ARALIA = {
    "baobab1": 0.00010170807783837207,
    "baobab2": 0.000713018259790331,
    "baobab3": 0.0022411701378016904,
    "cea9601": 0.0014840854304999076,
    "chinese": 0.0011705818107586692,
    "das9201": 0.013423667727275393,
    "das9202": 0.010115381257405312,
    "das9203": 0.0013487971957164993,
    "das9204": 2.1694159512164895e-11,
    "das9205": 1.3840773541217113e-08,
    "das9206": 0.2296868379894425,
    "das9207": 0.3466958883592075,
    "das9208": 0.013017896918879909,
    "das9209": 1.0580018854739494e-13,
    "das9601": 0.004234402887368829,
    "edf9201": 0.3245914467287518,
    "edf9202": 0.7813024513333078,
    "edf9203": 0.5995890976655517,
    "edf9204": 0.5253742884675057,
    "edf9205": 0.209350905758156,
    "edf9206": 8.615001607020534e-12,
    "edfpa14b": 0.29561954567959725,
    "edfpa14o": 0.2970571107512771,
    "edfpa14p": 0.08070592177218577,
    "edfpa14q": 0.29590549092253776,
    "edfpa14r": 0.02099765778337022,
    "edfpa15b": 0.3627365168966793,
    "edfpa15o": 0.362955915219753,
    "edfpa15p": 0.0736302382312845,
    "edfpa15q": 0.3627365168966791,
    "edfpa15r": 0.018975030707001912,
    "elf9601": 0.09662909854254606,
    "ftr10": 0.44867711967828866,
    "isp9601": 0.05712449271553729,
    "isp9602": 0.017244744826397197,
    "isp9603": 0.003233264386959857,
    "isp9604": 0.14275074759287934,
    "isp9605": 1.3717088054554768e-05,
    "isp9606": 0.054317355360333636,
    "isp9607": 9.495101853730964e-07,
    "jbd9601": 0.7550906150565098,
}
PRA = {  # with events of probability 0 and 1: (file, tree) -> value
    ("converted_LOCCW_et_Grp-1_24-02-26_16-01-09.xml", "FT3"): 2.667691327084264e-05,
    ("converted_LOCCW_et_Grp-1_24-02-26_16-01-09.xml", "FT57/FT57.G250"): 1.0,
    ("converted_LOOPGR_et_Grp-1_24-02-26_16-01-22.xml", "FT78/FT78.G444"): 0.00649033276967512,
    ("converted_LOOPGR_et_Grp-1_24-02-26_16-01-22.xml", "FT57/FT57.G250"): 0.0011239857837888312,
    ("converted_EQK-BIN3_et_Grp-4_24-02-26_15-57-49.xml", "FT78/FT78.G444"): 0.8870953643003215,
    ("converted_EQK-BIN3_et_Grp-4_24-02-26_15-57-49.xml", "FT57/FT57.G250"): 0.7492920278833319,
}


def systems(file: str) -> dict[str, ReliabilitySystem]:
    source = Source(file.rpartition("/")[2], data_file(file).read_bytes())
    return {model.data.top: model.data for model in read_models(source).models}


def value(system: ReliabilitySystem) -> float:
    """Return the probability of a tree whose events have fixed ones."""
    tree = lower(system).components[system.top]
    assert isinstance(tree, FaultTree)
    assert tree.diagram is not None
    diagram = tree.diagram

    class Tree(LargeTree):
        names = ()
        modules = table(diagram)  # type: ignore[assignment]

    return Tree().failure([event.values[0] for event in tree.events])


@pytest.mark.parametrize("name", ARALIA)
def test_the_aralia_trees_have_the_values_of_another_program_within_a_minute(name: str) -> None:
    (system,) = systems(f"aralia/{name}.xml").values()
    start = time.process_time()
    assert value(system) == pytest.approx(ARALIA[name], rel=1e-9, abs=0.0)
    assert time.process_time() - start < 60


@pytest.mark.parametrize(("file", "tree"), PRA)
def test_trees_of_a_power_plant_have_the_values_of_another_program(file: str, tree: str) -> None:
    found = value(systems(f"generic-pwr/{file}")[tree])
    assert found == pytest.approx(PRA[file, tree], rel=1e-10, abs=0.0)
