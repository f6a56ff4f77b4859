"""Two EDDIs written by hand, with all that mixes, and what a slip in them gives.

``lift.xml`` has several roots, other prefixes, spellings of D7.2 and of the public metamodel, all
relations of demands; ``pump.xml`` has ``xmi:id``, a top event, a common cause, a network.
"""

import re
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.kinds.consert.compose import compose
from eddi_scaffold.kinds.consert.consert import ConSert
from eddi_scaffold.kinds.reliability.show import at_start
from tests.metamodel.expected import changed

MODELS = Path(__file__).parent / "models"


def reading(file: str, *pairs: tuple[str, str]) -> ReadResult:
    return changed(MODELS / file, *pairs)


def errors(file: str, *pairs: tuple[str, str]) -> list[tuple[str, int | None]]:
    found = reading(file, *pairs)
    problems: list[Problem] = list(found.problems)
    for model in found.models:
        problems += model.check()
    return [(one.code, one.place.line) for one in problems if one.level == "error"]


def test_all_is_read() -> None:
    assert errors("lift.xml") == errors("pump.xml") == []
    lift, camera = (one.data for one in reading("lift.xml").models)
    assert isinstance(lift, ConSert)
    assert isinstance(camera, ConSert)
    (sees,) = lift.demands
    relations = [getattr(one, "subset", None) for one in sees.dimensions]
    assert relations == ["Demand", "Guarantee", "Intersection", None]
    assert [one.id for one in lift.evidence] == ["OilWarm", "Load"]
    composed = compose([("Lift", lift), ("Camera", camera)])
    assert composed.bindings == {("Lift", "Sees"): (("Camera", "Looks"),)}
    network, tree, _ = reading("pump.xml").models
    assert network.name == "Risk net"
    # flood, or both pumps, or a storm and pump A
    a, b = 1 - 0.9999000049998333, 1 - 0.9998000199986667
    rest = a * (1 - 0.8 * (1 - b))
    assert at_start(tree.data).p_fail == pytest.approx(0.01 + 0.99 * rest, rel=1e-9)


LOAD = '<end inclusive="true"><value number="1.0E4" numberType="SPFP"/></end>'
SLIPS = [
    re.fullmatch(r"(\S+):(\d+) (\S+) (.*?) =>(?: (.*))?", line)
    for line in Path(__file__).with_name("slips.txt").read_text("utf-8").splitlines()
    if not line.startswith("#")
]


@pytest.mark.parametrize("slip", SLIPS, ids=[slip[4] for slip in SLIPS if slip])
def test_a_slip_is_an_error_at_its_line(slip: re.Match[str]) -> None:
    file, line, code, old, new = slip.groups(default="")
    assert errors(file, (old, new)) == [(code, int(line))]


def test_a_range_is_read_as_it_is_written_whatever_its_class_is_called() -> None:
    covered = '<covered start="2" end="3" inclusive="true"/>'
    lift = reading("lift.xml", (LOAD, covered)).models[0].data
    assert isinstance(lift, ConSert)
    (one,) = lift.evidence[1].dimension.covered  # type: ignore[union-attr]
    assert (one.start.value, one.end.value) == (2.0, 3.0)  # type: ignore[union-attr]


def test_a_requirement_may_be_in_another_file_and_a_part_may_not() -> None:
    at = 'requirements="/2/@dependabilityRequirements.0"'
    far = reading("lift.xml", (at, 'requirements="goals.xml#//@dependabilityRequirements.0"'))
    (said,) = (one for one in far.problems if one.code == "X007")
    assert (said.level, said.place.line) == ("warning", 34)
    part = '<runtimeEvidences name="LensClean"/>'
    inside = reading("lift.xml", (part, '<runtimeEvidences href="parts.xml#//"/>'))
    assert ("error", "X007") in {(one.level, one.code) for one in inside.problems}
