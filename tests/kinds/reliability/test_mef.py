"""Fault trees of Open-PSA files."""

import itertools
import math
import random
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.kinds.reliability.show import at_start
from eddi_scaffold.kinds.reliability.system import (
    BasicEvent,
    ComponentModel,
    FaultTree,
    Gate,
    Law,
    ReliabilitySystem,
)
from eddi_scaffold.kinds.reliability.write import to_open_psa
from eddi_scaffold.monitors.loading import read_models
from tests.kinds.reliability.monitors import sound

DATA = Path(__file__).parents[2] / "data"
NUMBERS = {"a": 0.25, "b": 0.5, "c": 0.125}


def read(text: str) -> ReadResult:
    return read_models(Source("t.xml", text.encode()))


def tree(formula: str, more: str = "") -> str:
    events = "".join(
        f'<define-basic-event name="{name}"><float value="{p}"/></define-basic-event>\n'
        for name, p in NUMBERS.items()
    )
    return (
        '<opsa-mef>\n<define-fault-tree name="T">\n'
        f'<define-gate name="top"><label>t</label>{formula}</define-gate>\n'
        f"{events}{more}</define-fault-tree>\n</opsa-mef>\n"
    )


def p_fail(model: Model) -> float:
    return at_start(model.data).p_fail


def refs(*names: str) -> str:
    return "".join(f'<basic-event name="{name}"/>' for name in names)


@pytest.mark.parametrize(
    ("formula", "holds"),
    [
        (f"<and>{refs('a', 'b', 'c')}</and>", lambda a, b, c: a and b and c),
        (f"<or>{refs('a', 'b', 'c')}</or>", lambda a, b, c: a or b or c),
        (f"<xor>{refs('a', 'b')}</xor>", lambda a, b, c: a != b),
        (f"<not>{refs('a')}</not>", lambda a, b, c: not a),
        (f"<nand>{refs('a', 'b')}</nand>", lambda a, b, c: not (a and b)),
        (f"<nor>{refs('a', 'b', 'c')}</nor>", lambda a, b, c: not (a or b or c)),
        (f"<iff>{refs('a', 'b')}</iff>", lambda a, b, c: a == b),
        (f"<imply>{refs('a', 'b')}</imply>", lambda a, b, c: not a or b),
        (f'<atleast min="2">{refs("a", "b", "c")}</atleast>', lambda a, b, c: a + b + c >= 2),
        (refs("c"), lambda a, b, c: c),
        (
            f'<and><nor>{refs("a", "b")}</nor><or>{refs("c")}<constant value="false"/></or></and>',
            lambda a, b, c: not (a or b) and c,
        ),
        (f'<and><constant value="true"/>{refs("b")}</and>', lambda a, b, c: b),
    ],
)
def test_formulas(formula: str, holds: object) -> None:
    (model,) = read(tree(formula)).models
    wanted = math.fsum(
        math.prod(
            p if is_true else 1.0 - p for p, is_true in zip(NUMBERS.values(), case, strict=True)
        )
        for case in itertools.product([False, True], repeat=3)
        if holds(*case)  # type: ignore[operator]
    )
    assert model.name == "T"
    assert p_fail(model) == pytest.approx(wanted, rel=1e-12)


def event(law: str, more: str = "") -> ReadResult:
    text = f'<define-basic-event name="e">{law}</define-basic-event>\n{more}'
    return read(tree('<event name="e"/>', text))


MISSION = "<system-mission-time/>"
CHANCE = f'<exponential><parameter name="l"/>{MISSION}</exponential>'
RATE = '<define-parameter name="l" unit="{}"><float value="{}"/></define-parameter>'


@pytest.mark.parametrize(
    ("law", "more", "wanted"),
    [
        ('<float value="0.3"/>', "", Law("fixed", (0.3,))),
        (CHANCE, RATE.format("hours-1", "1e-5"),
         Law("exponential", (1e-5,))),
        (CHANCE, RATE.format("fit", "50"),
         Law("exponential", (50 * 1e-9,))),
        (CHANCE, RATE.format("years-1", "2"),
         Law("exponential", (2 / 8760,))),
        (f'<exponential><parameter name="l"/><mul><int value="20"/>{MISSION}</mul></exponential>',
         RATE.format("hours-1", "1e-5"), Law("exponential", (20 * 1e-5,))),
        ('<exponential><parameter name="l"/><float value="10"/></exponential>',
         RATE.format("hours-1", "1e-3"), Law("fixed", (-math.expm1(-0.01),))),
        (f'<Weibull><parameter name="l"/><float value="2"/><float value="0"/>{MISSION}</Weibull>',
         RATE.format("years", "2"), Law("weibull", (17520.0, 2.0))),
        ('<sub><float value="1"/><mul><int value="2"/><float value="0.25"/></mul></sub>', "",
         Law("fixed", (0.5,))),
        ('<div><add><int value="1"/><neg><float value="0.5"/></neg></add><float value="2"/></div>',
         "", Law("fixed", (0.25,))),
    ],
)  # fmt: skip
def test_laws(law: str, more: str, wanted: Law) -> None:
    reading = event(law, more)
    assert reading.problems == ()
    assert reading.models[0].data.components["T"].content.events["e"].law == wanted


def test_containers_have_the_names_of_the_file() -> None:
    reading = read((DATA / "reliability/containers.opsa.xml").read_text("utf-8"))
    (model,) = reading.models
    content = model.data.components["T"].content
    assert content.gates["G"].of == ("inner", "E")
    assert content.gates["inner"].of == ("H", "on")
    assert p_fail(model) == pytest.approx(0.25)


def test_constants_are_put_in_before_the_diagram_is_built() -> None:
    """Thousands of combinations of what is certain or cannot happen are no nodes (field)."""
    file = DATA / "oracles/field/constant-events/plant.xml"
    reading = read_models(Source(file.name, file.read_bytes()))
    assert p_fail(reading.models[0]) == pytest.approx(2.999997000001e-06, rel=1e-12)


def drawn(chance: random.Random) -> ReliabilitySystem:
    """Return a random tree of every gate and law that the format has."""
    laws = [
        lambda: Law("exponential", (chance.random() * 2,)),
        lambda: Law("weibull", (chance.random() * 3 + 0.1, chance.random() * 3 + 0.3)),
        lambda: Law("fixed", (chance.choice([0.0, 1.0, chance.random()]),)),
    ]
    names = [f"E{k}" for k in range(chance.randint(2, 6))]
    events = {name: BasicEvent(name, chance.choice(laws)()) for name in names}
    gates = {}
    for k in range(chance.randint(1, 5)):
        of = chance.choice(["AND", "OR", "XOR", "NOT", "VOTE"])
        count = 1 if of == "NOT" else chance.randint(1, min(4, len(names)))
        below = tuple(chance.sample(names, count))
        least = chance.randint(1, count) if of == "VOTE" else None
        names.append(f"G{k}")
        gates[f"G{k}"] = Gate(f"G{k}", of, below, least)
    content = FaultTree(names[-1], events, gates)
    return ReliabilitySystem({"T": ComponentModel("T", "fault_tree", content)}, "T")


def test_what_is_written_is_read_back() -> None:
    chance = random.Random(1)
    for _ in range(100):
        system = drawn(chance)
        text = to_open_psa(system)
        assert text is not None
        reading = read(text)
        assert reading.problems == (), text
        found = at_start(reading.models[0].data).p_fail
        assert found == pytest.approx(at_start(system).p_fail, rel=1e-12), text


@pytest.mark.parametrize(
    "change",
    [
        ("{type: OR, of: [A, B]}", "{type: PAND, of: [A, B]}"),
        ("{rate: 1e-3 1/h}", "{rate: 1e-3 1/h, age: 5 h}"),
        ("    gates:", "    age: 5 h\n    gates:"),
        ("models:", "models:\n  c: {type: k_out_of_n, k: 2, rate: 1e-3 1/h, max: 3}"),
    ],
)
def test_what_the_format_does_not_have_is_not_written(change: tuple[str, str]) -> None:
    text = (
        "models:\n  t:\n    type: fault_tree\n    gates: {T: {type: OR, of: [A, B]}}\n"
        "    events: {A: {rate: 1e-3 1/h}, B: {rate: 1e-4 1/h}}\n"
    )
    assert to_open_psa(sound(text).data) is not None
    assert change[0] in text
    assert to_open_psa(sound(text.replace(*change)).data) is None
