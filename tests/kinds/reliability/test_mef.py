"""Fault trees of Open-PSA files: read, written, and compared with SCRAM where it is installed."""

from __future__ import annotations

import itertools
import math
import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.kinds.reliability.system import (
    BasicEvent,
    ComponentModel,
    FaultTree,
    Gate,
    Law,
    ReliabilitySystem,
)
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.kinds.reliability.write import to_mef
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import run
from tests.diagnosed import assert_reported
from tests.kinds.reliability.monitors import sound

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


def test_what_is_assumed_is_told_once() -> None:
    values = "".join(f'<float value="{value}"/>' for value in (1e-5, 3, 0.95))
    rate = f"<lognormal-deviate>{values}</lognormal-deviate>"
    law = f"<exponential>{rate}{MISSION}</exponential>"
    more = f'<define-basic-event name="f">{law}</define-basic-event>\n'
    reading = event(law, more)
    assert [(one.code, one.level) for one in reading.problems] == [
        ("R004", "warning"),
        ("R018", "warning"),
    ]
    assert_reported("R018", reading.problems[1:])
    assert reading.models[0].data.components["T"].content.events["e"].law == Law(
        "exponential", (1e-5,)
    )


CONTAINERS = """\
<opsa-mef><define-fault-tree name="T">
  <define-gate name="G"><and><gate name="t.G"/><event name="E"/></and></define-gate>
  <define-component name="t" role="private">
    <define-gate name="G"><or><gate name="H"/><house-event name="on"/></or></define-gate>
    <define-gate name="H"><event name="E"/></define-gate>
    <define-component name="u">
      <define-basic-event name="E"><parameter name="p"/></define-basic-event>
      <define-parameter name="p"><float value="0.5"/></define-parameter>
    </define-component>
    <define-house-event name="on"><constant value="true"/></define-house-event>
  </define-component>
  <define-basic-event name="E" role="public"><float value="0.25"/></define-basic-event>
</define-fault-tree>
<model-data><define-house-event name="off"/></model-data></opsa-mef>
"""


def test_names_are_looked_up_from_the_inside_out() -> None:
    reading = read(CONTAINERS)
    (model,) = reading.models
    content = model.data.components["T"].content
    assert content.gates["G"].of == ("T.t.G", "E")
    assert content.gates["T.t.G"].of == ("T.t.H", "T.t.on")
    assert content.gates["T.t.H"].of == ("E",)
    assert p_fail(model) == pytest.approx(0.25)


def test_a_tree_of_several_tops() -> None:
    reading = read(tree(refs("a"), f'<define-gate name="other">{refs("b")}</define-gate>'))
    assert {model.name: p_fail(model) for model in reading.models} == {
        "T/top": 0.25,
        "T/other": 0.5,
    }


def told(reading: ReadResult) -> list[tuple[str, int | None, str]]:
    return [(p.code, p.place.line, p.message) for p in reading.problems]


@pytest.mark.parametrize(
    ("formula", "more", "wanted"),
    [
        ('<gate name="G"/>', "", ("R001", 3, "there is no gate or event 'G'")),
        (
            '<cardinality min="1" max="2"/>',
            "",
            ("R017", 3, "the formula `cardinality` is not supported"),
        ),
        (refs("a") + refs("b"), "", ("R017", 3, "gate 'top' has 2 formulas, expected 1")),
        (refs("a"), '<define-basic-event name="a"/>', ("R001", 7, "'a' is defined twice")),
        (
            refs("a"),
            '<define-basic-event name="x y"/>',
            ("R001", 7, "'x y' is not a name of a `define-basic-event`"),
        ),
        (
            refs("a"),
            "<include file='/etc/passwd'/>",
            ("R017", 7, "`include` '/etc/passwd': other files are not read"),
        ),
        (
            refs("a"),
            '<model-data><define-CCF-group name="c"/></model-data>',
            ("R017", 7, "`define-CCF-group` 'c': common causes are not read"),
        ),
        (
            refs("a"),
            '<define-substitution name="s"/>',
            ("R017", 7, "`define-substitution` 's': substitutions are not read"),
        ),
        (refs("a"), '<define-rule name="c"/>', ("R018", 7, "`define-rule` is not read")),
    ],
)
def test_what_is_wrong_with_a_tree(formula: str, more: str, wanted: tuple[str, int, str]) -> None:
    assert told(read(tree(formula, more))) == [wanted]


@pytest.mark.parametrize(
    ("law", "wanted"),
    [
        ('<float value="1.5"/>', ("R002", 7, "event 'e': 1.5 is not a probability")),
        ('<float value="1_0"/>', ("R002", 7, "'1_0' is not a number")),
        ('<float value="inf"/>', ("R002", 7, "'inf' is not a number")),
        ('<parameter name="l"/>', ("R001", 7, "there is no parameter 'l'")),
        ("<GLM/>", ("R017", 7, "the expression `GLM` is not supported")),
        (
            '<div><float value="1"/><float value="0"/></div>',
            ("R002", 7, "`div` gives no number"),
        ),
        (
            '<pow><float value="1e300"/><float value="9"/></pow>',
            ("R002", 7, "`pow` gives no number"),
        ),
        ("<neg/>", ("R002", 7, "`neg` gives no number")),
        (
            f'<exponential><float value="-1"/>{MISSION}</exponential>',
            ("R002", 7, "-1 is below 0"),
        ),
        (
            f'<Weibull><float value="0"/><float value="1"/><float value="0"/>{MISSION}</Weibull>',
            ("R002", 7, "event 'e': scale and shape must be above 0, the location 0"),
        ),
        (
            '<float value="0.1"/><float value="0.2"/>',
            ("R017", 7, "event 'e' has 2 expressions"),
        ),
    ],
)
def test_what_is_wrong_with_a_number(law: str, wanted: tuple[str, int, str]) -> None:
    assert told(event(law)) == [wanted]


@pytest.mark.parametrize(
    ("inner", "code"),
    [
        ('><parameter name="p"/></define-parameter>', "R012"),
        (' unit="meters"><float value="1"/></define-parameter>', "R004"),
        ("/>", "R017"),
    ],
)
def test_parameters_that_have_no_value(inner: str, code: str) -> None:
    parameters = f'<define-parameter name="p"{inner}'
    reading = event('<parameter name="p"/>', parameters)
    assert [problem.code for problem in reading.problems] == [code]


def test_the_examples_of_the_codes() -> None:
    group = '<define-CCF-group name="Pumps" model="beta-factor"/>'
    assert_reported("R017", read(tree(refs("a"), group)).problems)


def test_an_event_without_a_probability_and_a_cycle() -> None:
    (model,) = event("").models
    assert [problem.code for problem in model.check()] == ["R002"]
    inner = "<or><and><gate name='top'/><gate name='x'/></and><gate name='x'/></or>"
    for below in ('<gate name="top"/>', inner):  # also through a formula without a name
        text = tree('<gate name="x"/>', f'<define-gate name="x">{below}</define-gate>')
        (model,) = read(text).models
        assert [problem.code for problem in model.check()] == ["R012"]


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
        text = to_mef(system)
        assert text is not None
        reading = read(text)
        assert reading.problems == (), text
        found = at_start(reading.models[0].data).p_fail
        assert found == pytest.approx(at_start(system).p_fail, rel=1e-12), text


@pytest.mark.skipif(shutil.which("scram") is None, reason="scram is not installed")
def test_scram_computes_the_same(tmp_path: Path) -> None:
    chance = random.Random(2)
    path = tmp_path / "t.xml"
    for _ in range(20):
        system = drawn(chance)
        path.write_text(to_mef(system) or "")
        words = ("scram", "--bdd", "--probability", "1", "--mission-time", "1", str(path))
        told = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        (found,) = re.findall(r'<sum-of-products.*?probability="(\S+)"', told)
        assert float(found) == pytest.approx(at_start(system).p_fail, rel=1e-5, abs=1e-12)


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
    assert to_mef(sound(text).data) is not None
    assert change[0] in text
    assert to_mef(sound(text.replace(*change)).data) is None


def test_the_commands(tmp_path: Path) -> None:
    text = tree(f"<and>{refs('a', 'b')}</and>").replace('name="T"', 'name="Tank"')
    (tmp_path / "t.opsa").write_text(text)
    shown = run("show", "t.opsa", cwd=tmp_path)
    assert (shown.status, "AND top" in shown.out) == (0, True), shown.err
    assert run("check", "t.opsa", cwd=tmp_path).status == 0
    assert run("export", "t.opsa", "-o", ".", cwd=tmp_path).out == "Tank.opsa.xml\nTank.yml\n"
    answers = run("answers", "-m", "Tank.opsa.xml", "--platform", "plain", "-o", "a", cwd=tmp_path)
    assert answers.status == 0, answers.err


def test_constants_are_put_in_before_the_diagram_is_built() -> None:
    """Thousands of combinations of what is certain or cannot happen are no nodes (field)."""
    file = Path(__file__).parents[2] / "data/oracles/field/constant-events/plant.xml"
    reading = read_models(Source(file.name, file.read_bytes()))
    assert p_fail(reading.models[0]) == pytest.approx(2.999997000001e-06, rel=1e-12)
