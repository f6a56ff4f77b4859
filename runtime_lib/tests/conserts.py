"""Small ConSerts, made from short descriptions."""

from __future__ import annotations

from types import SimpleNamespace

from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    Bound,
    CategoricalDimension,
    ConSert,
    Demand,
    Evidence,
    Gate,
    Guarantee,
    NumericDimension,
    Propagation,
    ProvidedService,
    Range,
)
from eddi_scaffold.kinds.consert.options import ConSertOptions
from runtime_lib.tests.bound_models import bound_input, bound_model


def binary(good=True):
    return BinaryDimension("T", value=good)


def categorical(*covered):
    return CategoricalDimension("C", covered, "Demand")


def numeric(*ranges, uom="m"):
    """Ranges as texts: ``[0, 5]`` closed, ``[0, 5)`` half open."""
    covered = []
    for text in ranges:
        start, end = (Bound(one.strip(), float(one)) for one in text[1:-1].split(","))
        covered.append(Range(start, end, text.endswith("]"), start_inclusive=text[0] == "["))
    return NumericDimension("N", tuple(covered), "Guarantee", uom)


def consert(
    evidence=(),
    demands=(),
    gates=(),
    guarantees=(),
    edges=(),
    services=(),
    specs=(),
    order=None,
    paths=(),
    name="Test",
    filtered=None,
    guarantee_ids="source",
):
    """Return a ConSert with its inputs.

    Args:
        evidence: ids (binary) or (id, dimension).
        gates: "id&" for And, "id|" for Or.
        guarantees: ids or dicts.
        edges: "from>to" with ids that have no ">".
        specs: input id -> keys of its entry that differ.
        order: of the inputs.
        paths: id -> fragment path.
        filtered: kind and steps.
    """

    def place(id_):
        return Place("test.yml", path=dict(paths).get(id_))

    known = [one if isinstance(one, tuple) else (one, binary()) for one in evidence]
    rows = [one if isinstance(one, dict) else {"id": one} for one in guarantees]
    pairs = [edge.split(">") if isinstance(edge, str) else edge for edge in edges]
    data = ConSert(
        name,
        tuple(Guarantee(dimensions=(binary(),), place=place(row["id"]), **row) for row in rows),
        tuple(Demand(one, (binary(),), place=place(one)) for one in demands),
        tuple(Evidence(one, dimension, place=place(one)) for one, dimension in known),
        tuple(Gate(one[:-1], {"&": "And", "|": "Or"}[one[-1]]) for one in gates),
        tuple(Propagation(source, target) for source, target in pairs),
        (),
        tuple(ProvidedService(one, "S", tuple(members)) for one, members in services),
    )
    ids = order or [*(one for one, _ in known), *demands]
    inputs = [bound_input(one, **dict(specs).get(one, {})) for one in ids]
    options = ConSertOptions(guarantee_ids, *(filtered or ()))
    return bound_model("consert", name, data, options, inputs)


def monitor(*args, limit=None, **kwargs):
    return consert(*args, **kwargs).monitor(**({} if limit is None else {"limit": limit}))


def give(**values):
    return SimpleNamespace(**values)


def active(rows):
    return [row["id"] for row in rows if row["active"]]


def one_leaf(dimension, **spec):
    """Return a monitor whose guarantee G is active while its only input x is TRUE."""
    return monitor([("x", dimension)], guarantees=["G"], edges=["x>G"], specs={"x": spec})


def nested(**settings):
    """(a or b) and c and n, or d."""
    return monitor(
        evidence=["a", "b", ("c", categorical("low")), ("n", numeric("[0, 10]", "[20, 30)"))],
        demands=["d"],
        gates=["or1|", "and1&", "or2|"],
        guarantees=["G"],
        edges=["a>or1", "b>or1", "or1>and1", "c>and1", "n>and1", "and1>or2", "d>or2", "or2>G"],
        **settings,
    )


GOOD = {"a": True, "b": True, "c": "low", "n": 5.0, "d": True}
