"""Random models of every kind as files, each made from its number alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import yaml

from tests.conditions.formulas import DECLARATIONS, Formulas
from tests.deployments.pool import conserts, events, networks, reliabilities
from tests.deployments.pool.templates import Template
from tests.metamodel.eddis import random_eddi

Files = Mapping[str, str]
_SCOPE = Path(__file__).with_name("scope_config.yml")
POOL = 70
"""So many of a kind come from the pool of deployments, with their configurations."""


@cache
def _pool(kind: str) -> Sequence[Template]:
    """Return monitors whose configurations name every topic."""
    return {
        "consert": lambda: tuple(conserts.conserts(POOL)),
        "bayesian_network": lambda: tuple(networks.networks(POOL)),
        "event": lambda: tuple(events.events()),
        "reliability": lambda: tuple(reliabilities.reliabilities(POOL)),
    }[kind]()


def _turns(kind: str, number: int, others: Sequence[Callable[[Random], Files]]) -> Files:
    """Return files of the pool and of other makers in turn."""
    turn, index = number % (1 + len(others)), number // (1 + len(others))
    pool = _pool(kind)
    if turn == 0 and index < len(pool):
        return pool[index].files
    return others[max(turn - 1, 0)](Random(f"{kind} {number}"))


def _dump(content: Any) -> str:
    return yaml.dump(content, Dumper=yaml.CSafeDumper, sort_keys=False)


def _random_eddi(rng: Random) -> Files:
    text = random_eddi(rng.randrange(10**6)).data.decode()
    return {"eddi.xml": text.replace('name="C"', 'name="Cell"').replace('name="T"', 'name="Tree"')}


def _consert(number: int) -> Files:
    return _turns("consert", number, [_random_eddi, _gates])


def _gates(rng: Random) -> Files:
    """Return a ConSert of any evidence, below gates below gates."""
    dimensions = {
        "Binary": {},
        "Categorical": {"covered": ["A", "B c"], "subset": rng.choice(["Demand", "Guarantee"])},
        "Numeric": {
            "covered": [{"Inclusive": {"start": rng.randint(-5, 0), "end": rng.randint(1, 9)}}],
            "subset": "Demand",
            "uom": rng.choice(["", "meter", "second"]),
        },
    }
    sorts = {f"E{k}": rng.choice(list(dimensions)) for k in range(rng.randint(1, 5))}
    demands = [f"D{k}" for k in range(rng.randint(0, 2))]
    below, gates, edges = [*sorts, *demands], [], []
    for k in range(rng.randint(0, 5)):
        gates.append({"id": f"T{k}", "function": rng.choice(["And", "Or"])})
        of = rng.sample(below, rng.randint(1, min(3, len(below))))
        edges += [{"from": one, "to": f"T{k}"} for one in of]
        below.append(f"T{k}")
    guarantees = [f"G{k}" for k in range(rng.randint(1, 4))]
    edges += [{"from": rng.choice(below), "to": one} for one in guarantees]

    def dimension(id_: str, sort: str) -> Mapping[str, Any]:
        return {sort: {"type": f"Of{id_}", **dimensions[sort]}}

    needs = {"id": "Needs", "functional_service_type": "Help", "demands": demands}
    gives = {"id": "Gives", "functional_service_type": "Help", "guarantees": guarantees}
    document = {
        "guarantees": [{"id": g, "dimensions": [dimension(g, "Binary")]} for g in guarantees],
        "demands": [{"id": d, "dimensions": [dimension(d, "Binary")]} for d in demands],
        "evidence": [{"id": e, "dimension": dimension(e, sort)} for e, sort in sorts.items()],
        "gates": gates,
        "tree_propagations": edges,
        "required_services": [needs] if demands else [],
        "provided_services": [gives],
    }
    return {"consert.yml": _dump(document)}


def _bayesian_network(number: int) -> Files:
    return _turns("bayesian_network", number, [_network, _network])


def _network(rng: Random) -> Files:
    """Return a network of up to eight nodes; rows have zeros, and numbers of any length."""
    count = rng.randint(1, 8)
    states = [rng.randint(2, 4) for _ in range(count)]
    lines = ["network n {\n}"]
    for k in range(count):
        names = ", ".join(f"s{j}" for j in range(states[k]))
        lines.append(f"variable N{k} {{\n  type discrete [ {states[k]} ] {{ {names} }};\n}}")
    for k in range(count):
        parents = rng.sample(range(k), min(k, rng.randint(0, 3)))
        rows = math.prod(states[p] for p in parents)
        table = [_row(rng, states[k]) for _ in range(rows)]
        if not parents:
            lines.append(f"probability ( N{k} ) {{\n  table {table[0]};\n}}")
            continue
        given = ", ".join(f"N{p}" for p in parents)
        lines.append(f"probability ( N{k} | {given} ) {{")
        for row, numbers in enumerate(table):
            lines.append(f"  ({', '.join(_states(row, [states[p] for p in parents]))}) {numbers};")
        lines.append("}")
    return {"network.bif": "\n".join(lines) + "\n"}


def _row(rng: Random, count: int) -> str:
    weights = [rng.choice([0, 1, 1, 2, 5, 7]) for _ in range(count)]
    weights[rng.randrange(count)] += 1
    return ", ".join(repr(one / sum(weights)) for one in weights)


def _states(row: int, counts: Sequence[int]) -> list[str]:
    """Return the states of the parents in a row, the first parent slowest."""
    found = []
    for count in reversed(counts):
        row, state = divmod(row, count)
        found.append(f"s{state}")
    return found[::-1]


def _event(number: int) -> Files:
    return _turns("event", number, [_formulas, _formulas])


def _formulas(rng: Random) -> Files:
    formulas = Formulas(rng)
    lines = [
        f"EVENT e{k} ({rng.choice(['EVIDENCE', 'HAZARD'])}) := {formulas.boolean(3)}"
        for k in range(3)
    ]
    return {"formulas.events": DECLARATIONS + "\n".join(lines) + "\n"}


def _reliability(number: int) -> Files:
    return _turns("reliability", number, [_random_eddi, _tree, _chain])


def _tree(rng: Random) -> Files:
    """Return a fault tree of laws of several sorts, some of its events observed."""
    events: dict[str, Any] = {}
    for k in range(rng.randint(1, 6)):
        law = rng.choice(
            [
                {"p": round(rng.random(), 3)},
                {"rate": f"{10 ** rng.uniform(-6, -1):.3g} 1/h"},
                {"scale": f"{rng.randint(10, 9000)} h", "shape": rng.choice([0.7, 2.0])},
            ]
        )
        observed = {"observed": True} if "shape" not in law and rng.random() < 0.4 else {}
        events[f"e{k}"] = {**law, **observed}
    gates: dict[str, Any] = {}
    for k in range(rng.randint(1, 6)):
        below = [*events, *gates]
        of = rng.sample(below, rng.randint(1, min(4, len(below))))
        type_ = rng.choice(["OR", "AND", "VOTE", "OR", "AND", "NOT", "XOR"])
        of = of[:1] if type_ == "NOT" else of
        vote = {"k": rng.randint(1, len(of))} if type_ == "VOTE" else {}
        gates[f"g{k}"] = {"type": type_, **vote, "of": of}
    tree = {"type": "fault_tree", "top": f"g{len(gates) - 1}", "gates": gates, "events": events}
    return {"tree.yml": _dump(_system(rng, tree))}


def _chain(rng: Random) -> Files:
    """Return a Markov chain."""
    names = [f"S{k}" for k in range(rng.randint(2, 6))]
    arcs = [
        {"from": a, "to": b, "rate": f"{10 ** rng.uniform(-5, 0):.3g} 1/h"}
        for a in names
        for b in names
        if a != b and rng.random() < 0.5
    ]
    chain = {"type": "markov", "initial": "S0", "fail": [names[-1]], "arcs": arcs}
    return {"chain.yml": _dump(_system(rng, chain))}


def _system(rng: Random, model: Mapping[str, Any]) -> Mapping[str, Any]:
    level = round(rng.uniform(0.001, 0.5), 4)
    threshold = {"id": "fit", "activate": level, "release": level * rng.choice([1, 2])}
    mode = rng.choice(["worst_case", "inactive"])
    horizon = rng.choice(["30 min", "1 h", "90 s"])
    return {
        "horizon": horizon,
        "on_unknown": mode,
        "models": {"m": dict(model)},
        "thresholds": [threshold],
    }


def _safeml(number: int) -> Files:
    """Return a SafeML monitor: any metric, components, calibration and omission."""
    rng = Random(f"safeml {number}")
    features, rows = rng.randint(1, 3), rng.choice([40, 60, 160])
    calibration = rng.choice(["iid", "iid", "stream"])
    settings = {
        "window_size": rng.choice([5, 6, 8]),
        "reference_sample_file": "reference.csv",
        "significance_level": rng.choice([0.05, 0.1]),
        "distance_metric": rng.choice(["KolmogorovSmirnov", "CramerVonMises", "AndersonDarling"])
        + "Distance",
        "n_components": rng.choice([None, None, 0, features]),
        "standardize": rng.random() < 0.5,
        "residual_test": rng.random() < 0.5,
        "calibration": calibration,
        "stride": rng.choice([1, 1, 2]),
        "on_omission": rng.choice(["hold", "clear"]),
        "max_age": rng.choice([0.5, 1.2]),
        "input_dtype": rng.choice(["float32", "float64", "auto"]),
    }
    value, lines = [0.0] * features, []
    for _ in range(rows):
        value = [0.5 * one + rng.gauss(0, 1 + k) for k, one in enumerate(value)]
        lines.append(",".join(f"{one:.3f}" for one in value))
    files = {"scope.yml": _dump(settings), "reference.csv": "\n".join(lines) + "\n"}
    return {**files, "scope_config.yml": _SCOPE.read_text("utf-8")}


_EMF = """<?xml version="1.0" encoding="UTF-8"?>
<i:DDIPackage xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:i="http://www.deis-project.eu/ode/integration"
 xmlns:e="http://www.sesame-project.eu/ode/event"
 xmlns:f="http://www.deis-project.eu/ode/failureLogic">
<p xsi:type="e:EventPackage">{events}</p>
<p xsi:type="f:FailureLogicPackage">
<failureModels xsi:type="f:StateMachine" name="machine">{states}{transitions}</failureModels>
{actions}</p>
</i:DDIPackage>
"""


def _state_machine(number: int) -> Files:
    rng = Random(f"state_machine {number}")
    sizes = rng.randint(2, 6), rng.randint(2, 9), rng.randint(2, 5), rng.randint(1, 5)
    count, arcs, triggers, actions = sizes

    def refer(path: str, most: int, limit: int) -> str:
        chosen = rng.sample(range(most), rng.randint(0, min(limit, most)))
        return " ".join(f"{path}.{k}" for k in chosen)

    parts: dict[str, list[str]] = {"events": [], "states": [], "transitions": [], "actions": []}
    for k in range(triggers):
        of = rng.choice(["Condition", "Condition", "External"])
        keeps = ' isPersistent="true"' * (rng.random() < 0.2)
        parts["events"].append(
            f'<events xsi:type="e:{of}Event" name="t{k}" condition="t {k}"{keeps}/>'
        )
    for k in range(count):
        flags = f'isInitialState="{str(k == 0).lower()}" isFailState="{str(k % 3 == 2).lower()}"'
        path = "//@p.1/@actions"
        on = f'onEntry="{refer(path, actions, 2)}" onExit="{refer(path, actions, 1)}"'
        parts["states"].append(f'<states name="S {k}" {flags} {on}/>')
    for k in range(arcs):
        a, b = rng.randrange(count), rng.randrange(count)
        path = "//@p.1/@failureModels.0/@states"
        on = refer("//@p.0/@events", triggers, 2)
        key, value = rng.choice([("after", "2 s"), ("priority", "1"), ("", "")])
        value = f'<values tag="value" value="{value}"/>'
        text = f'<keyValueMaps key="eddi.{key}">{value}</keyValueMaps>' if key else ""
        ends = f'fromState="{path}.{a}" toState="{path}.{b}"'
        parts["transitions"].append(
            f'<transitions name="a{k}" {ends} triggers="{on}">{text}</transitions>'
        )
    for k in range(actions):
        of, key = rng.choice([("Function", "function"), ("Warning", "warning")])
        parts["actions"].append(f'<actions xsi:type="f:{of}Action" name="x" {key}="do {k}"/>')
    return {"machine.xml": _EMF.format(**{key: "".join(of) for key, of in parts.items()})}


MAKERS: Mapping[str, Callable[[int], Files]] = {
    "bayesian_network": _bayesian_network,
    "consert": _consert,
    "event": _event,
    "reliability": _reliability,
    "safeml": _safeml,
    "state_machine": _state_machine,
}
"""Kind -> what makes the files of a number."""
