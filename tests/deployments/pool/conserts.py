"""ConSerts: guarantees over one to three inputs of any sort."""

from collections.abc import Iterator, Mapping
from random import Random
from typing import Any

from tests.deployments.pool.templates import (
    BAD,
    GOOD,
    INVERTED,
    OUT,
    SOURCE_TYPES,
    SOURCES,
    Config,
    Reading,
    Slot,
    Template,
    dump,
)

FORMS: tuple[tuple[Mapping[str, Any], int], ...] = (
    ({"G": 0}, 1),
    ({"G": ("And", 0, 1)}, 2),
    ({"G": ("Or", 0, 1)}, 2),
    ({"G": ("And", 0, 1), "H": ("Or", 0, 1)}, 2),
    ({"G": ("And", 0, ("Or", 1, 2))}, 3),
    ({"G": ("Or", ("And", 0, 1), 2), "H": 0}, 3),
)
"""Guarantee -> inputs by number, and how many there are."""
GOOD_VALUES: Mapping[str, Any] = {"float": 10.0, "str": "clear", "bool": True}
"""Type of an input -> a value that its evidence covers."""


def conserts(count: int) -> Iterator[Template]:
    ways = [SOURCES["flag"], SOURCES["size"], SOURCES["text"], *GOOD.values()]
    for number in range(count):
        rng = Random(f"consert {number}")
        form, size = rng.choice(FORMS)
        # Each way comes early once; several monitors' outputs in one ConSert, too.
        first = ways[number % len(ways)]
        readings = [first, *(rng.choice(ways) for _ in range(size - 1))]
        yield _consert(f"consert{number}", form, readings, rng)


def unsound_conserts() -> Iterator[Template]:
    """Yield a ConSert for each reading that a check refuses."""
    for number, (fault, reading) in enumerate({**BAD, **INVERTED}.items()):
        rng = Random(fault)
        yield _consert(f"unsound{number}", FORMS[0][0], [reading], rng, fault)


def ring() -> Iterator[Template]:
    """Yield two ConSerts that wait for each other, or for a source."""
    for name in ("left", "right"):
        readings = [SOURCES["flag"], GOOD["guarantee"]]
        yield _consert(name, FORMS[2][0], readings, Random(name), "cycle")


def _consert(
    name: str, form: Mapping[str, Any], readings: list[Reading], rng: Random, fault: str = ""
) -> Template:
    slots = [_slot(f"s{k}", reading, rng, plain=bool(fault)) for k, reading in enumerate(readings)]
    every = 1000 if not fault and rng.random() < 0.1 else 500
    config = Config(name, "ConSert", ("model", f"{name}.yml"), every)
    for k, slot in enumerate(slots):
        default = {"default": True, "allow_unsafe_default": True} if slot.accepts_default else {}
        config.input(f"E{k}", slot, **default)
    alone = {"id": "alone", "topic": f"{OUT}/alone", "field": "guarantees[G].active"}
    config.alone.append(alone)
    if not fault and rng.random() < 0.2:
        config.model["filter"] = {"kind": "debounce", "regain_after": 2}
    files = {f"{name}.yml": _model(form, slots), f"{name}_config.yml": config.text()}
    offers = {"guarantee": "", "status": "/status", "alone": "/alone"}
    return Template(name, "consert", files, tuple(slots), offers, every, fault)


def _slot(source: str, reading: Reading, rng: Random, *, plain: bool) -> Slot:
    is_source = reading.offer in SOURCE_TYPES
    limit: float | None = rng.choice((0.7, 0.7, 1.2) if is_source else (1.2, 1.7))
    default = False
    if not plain and rng.random() < 0.06:
        limit = None
    elif not plain and reading is SOURCES["flag"] and rng.random() < 0.1:
        default = True
    good = GOOD_VALUES[reading.type] if is_source and reading.expression is None else 10.0
    return Slot(source, reading, limit, accepts_default=default, good=good)


def _model(form: Mapping[str, Any], slots: list[Slot]) -> str:
    gates, edges = _tree(form)
    names = sorted({edge["from"] for edge in edges if edge["from"].startswith("E")})
    by_name = {name: slots[int(name[1:])] for name in names}
    demands = [name for name, slot in by_name.items() if slot.reading is GOOD["guarantee"]]
    evidence = [name for name in names if name not in demands]
    needed = {"id": "Needs", "functional_service_type": "Support", "demands": demands}
    given = {"id": "Gives", "functional_service_type": "Support", "guarantees": list(form)}
    document = {
        "guarantees": [{"id": g, "dimensions": [_binary(g)]} for g in form],
        "demands": [{"id": name, "dimensions": [_binary("G")]} for name in demands],
        "evidence": [{"id": n, "dimension": _dimension(n, by_name[n].reading)} for n in evidence],
        "gates": gates,
        "tree_propagations": edges,
        "required_services": [needed] if demands else [],
        "provided_services": [given],
    }
    return dump(document)


def _tree(form: Mapping[str, Any]) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Return the gates of some guarantees, and the edges between gates, inputs and guarantees."""
    gates: list[dict[str, str]] = []
    edges: list[dict[str, str]] = []

    def add(part: Any, to: str) -> None:
        if isinstance(part, int):
            edges.append({"from": f"E{part}", "to": to})
            return
        gate = f"Gate{len(gates)}"
        gates.append({"id": gate, "function": part[0]})
        for one in part[1:]:
            add(one, gate)
        edges.append({"from": gate, "to": to})

    for guarantee, part in form.items():
        add(part, guarantee)
    return gates, edges


def _binary(name: str) -> dict[str, Any]:
    return {"Binary": {"type": f"{name}Holds"}}


def _dimension(name: str, reading: Reading) -> dict[str, Any]:
    if reading.type == "str":
        covered = ["clear", "cloudy"]
        return {"Categorical": {"type": f"{name}Is", "covered": covered, "subset": "Demand"}}
    if reading.type == "float":
        span = [{"Inclusive": {"start": 0, "end": reading.covers}}]
        return {"Numeric": {"type": f"{name}Is", "covered": span, "subset": "Demand", "uom": ""}}
    return _binary(name)
