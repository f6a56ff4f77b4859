"""Fault trees, chains and state machines as EMF tools write them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds.reliability.show import at_start, cut_sets
from eddi_scaffold.kinds.reliability.system import Chain, FaultTree, ReliabilitySystem
from tests.metamodel.expected import FOLDER, cases, changed, expected, models

TREES, CHAINS = cases("fault_tree"), cases("markov_chain")


def named(given: list[tuple[str, dict[str, Any]]]) -> Any:
    ids = [f"{file}:{want['name']}" for file, want in given]
    return pytest.mark.parametrize(("file", "want"), given, ids=ids)


def system_of(file: str, name: str) -> ReliabilitySystem:
    (found,) = (model for model in models(file) if model.name == name)
    return found.data  # type: ignore[no-any-return]


def p_fail(system: ReliabilitySystem, hours: float) -> float:
    return at_start(replace(system, horizon=hours)).p_fail


@named(TREES)
def test_tops_cut_sets_and_probabilities(file: str, want: dict[str, Any]) -> None:
    system = system_of(file, want["name"])
    component = system.components[system.top]
    tree = component.content
    assert isinstance(tree, FaultTree)
    assert tree.top == want["top"]
    # a common cause is analysed: it is a cut set of its own
    common = [["Low pressure"]] if "with_common_cause" in expected()[file] else []
    found = cut_sets(component.name, tree)
    assert found is not None
    assert {frozenset(one) for one in found} == {frozenset(o) for o in want["cut_sets"] + common}
    for hours, probability in want["probability"].items():
        # and it makes the top more probable than the product of its members
        right = expected()[file].get("with_common_cause", probability)
        assert p_fail(system, hours) == pytest.approx(right, rel=1e-9)
    assert {
        key: f"{event.law.model}/{chain.fail[0]}"
        for key, event in tree.events.items()
        if event.law
        and event.law.model
        and isinstance(chain := system.components[event.law.model].content, Chain)
    } == want.get("uses", {})


@named(CHAINS)
def test_a_state_machine_with_rates_alone_is_a_chain(file: str, want: dict[str, Any]) -> None:
    system = system_of(file, want["name"])
    chain = system.components[system.top].content
    assert isinstance(chain, Chain)
    assert list(chain.states) == want["states"]
    assert list(chain.fail) == want["fail"]
    rates = np.zeros((len(chain.states), len(chain.states)))
    for arc in chain.arcs:
        source, target = chain.states.index(arc.source), chain.states.index(arc.target)
        rates[source, target] += arc.rate
        rates[source, source] -= arc.rate
    for hours, states in want["probability_of_states"].items():
        found = expm(rates * hours)[chain.states.index(*chain.initial)]
        assert dict(zip(chain.states, found, strict=True)) == pytest.approx(states, rel=1e-9)
        failed = sum(states[state] for state in want["fail"])
        assert p_fail(system, hours) == pytest.approx(failed, rel=1e-9)


def problems_of(file: str, *pairs: tuple[str, str]) -> list[Problem]:
    return list(changed(FOLDER / file, *pairs).problems)


def codes(problems: list[Problem]) -> list[tuple[str, int | None]]:
    return [(one.code, one.place.line) for one in problems]


TOP = 'topEvent="//@odeProductPackages.0/@failureModels.0/@causes.9"'
EXIT = 'onExit="//@odeProductPackages.2/@actions.1"'
TRIGGERS = 'triggers="//@odeProductPackages.1/@events.3"'
FIVE = '<states name="Five"/>'
ODD = ("X014", "warning", 6)
ROWS = [
    # no other top is taken
    ("08_fault_tree", TOP, TOP.replace(".9", ".99"), ("X007", "error", 4), ""),
    ("08_fault_tree", TOP, TOP.replace("@causes.9", "@failures.9"), ("X009", "error", 4), ""),
    # references that nothing uses
    ("11_state_machine", EXIT, f'{EXIT[:-2]}9"', ("X007", "error", 21), ""),
    ("11_state_machine", TRIGGERS, f'{TRIGGERS[:-2]}9"', ("X007", "error", 29), ""),
    # a common cause is named with its members
    ("09_common_cause", "", "", ("R013", "warning", 15), "Front, Rear"),
    # what would change a chain
    ("12_markov_chain", FIVE, f"{FIVE[:-2]}><initialProb/></states>", ODD, "initialProb"),
    ("12_markov_chain", FIVE, f"{FIVE}<transitionMatrices/>", ODD, "transitionMatrices"),
]


@pytest.mark.parametrize(("file", "old", "new", "expected", "words"), ROWS)
def test_what_is_reported(
    file: str, old: str, new: str, expected: tuple[str, str, int], words: str
) -> None:
    (said,) = problems_of(f"{file}.xml", *[(old, new)] * bool(old))
    assert (said.code, said.level, said.place.line)[: len(expected)] == expected
    assert words in said.message


def test_a_normal_event_without_a_law_has_no_probability() -> None:
    law = 'type="Fixed">\n          <parameters name="p" value="0.2"/>'
    (model,) = changed(FOLDER / "08_fault_tree.xml", (law, 'type="NONE">')).models
    assert codes(list(model.check())) == [("R002", 68)]


def test_a_common_cause_that_is_an_event_itself_is_that_event() -> None:
    gate, end = 'gateType="AND" causes="', "    </failureModels>"
    tree = "//@odeProductPackages.0/@failureModels.0"
    cause = f'<causes name="Pressure" causeType="BasicEvent" failure="{tree}/@failures.2"/>'
    pairs = ((gate, f"{gate}{tree}/@causes.3 "), (end, cause + end))
    (model,) = changed(FOLDER / "09_common_cause.xml", *pairs).models
    assert p_fail(model.data, 1.0) == pytest.approx(5e-4, rel=1e-9)


def test_two_states_of_one_chain_are_not_independent() -> None:
    belt = ' failure="//@odeProductPackages.0/@failureModels.1/@failures.1"/>'
    worn = ' state="//@odeProductPackages.0/@failureModels.0/@states.1"/>'
    problems = problems_of("10_tree_over_chain.xml", (belt, worn))
    assert [one.code for one in problems if one.level == "error"] == ["R009"]


def test_a_state_that_is_not_the_failure_of_its_chain_is_a_chain_of_its_own() -> None:
    fails = ('name="Worn"', 'name="Worn" isFailState="true"')
    _, tree = changed(FOLDER / "10_tree_over_chain.xml", fails).models
    assert tree.data.top == "No drive"
    assert list(tree.data.components) == ["Motor/Seized", "No drive"]
    assert p_fail(tree.data, 100.0) == pytest.approx(0.07003996450556045, rel=1e-9)


def test_rates_beside_triggers_are_no_chain_and_said() -> None:
    rate = 'name="gets dirty"'
    problems = problems_of("11_state_machine.xml", (rate, rate + ' transition="0.1"'))
    assert ("X014", 25) in codes(problems)
    assert sum("StateMachine" in one.message for one in problems) == 1


def test_an_unavailability_is_no_law() -> None:
    old = '<failures name="Alarm lost failure"'
    horn = '<failures name="Horn failure"'
    top = (TOP, TOP.replace(".9", ".13"))
    (said,) = problems_of("08_fault_tree.xml", (horn, horn + ' unavailability="0.25"'), top)
    assert (said.code, said.level) == ("X014", "warning")
    assert "0.25 is a result at a time that is not stated" in said.message
    assert problems_of("08_fault_tree.xml", (old, old + ' unavailability="0.25"'), top) == []
