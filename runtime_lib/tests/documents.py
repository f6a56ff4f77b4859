"""Small ConSerts as model documents, written by hand or made from short descriptions."""

from __future__ import annotations

from types import SimpleNamespace

from eddi_scaffold.compiling.compilation import module_text
from eddi_scaffold.compiling.consert.emission import FORMAT, STRAIGHT_LINE_LIMIT, lines_of
from eddi_scaffold.compiling.document import check_document, digest_of
from eddi_scaffold.compiling.execution import module_of


def binary():
    return {"kind": "binary", "type": "T"}


def categorical(*covered):
    return {"kind": "categorical", "type": "C", "covered": list(covered), "subset": "Demand"}


def numeric(*ranges, uom="m"):
    """Ranges as texts: ``[0, 5]`` closed, ``[0, 5)`` half open."""
    covered = []
    for text in ranges:
        start, end = text[1:-1].split(",")
        closed = text.endswith("]")
        covered.append({"start": start.strip(), "end": end.strip(), "inclusive": closed})
    kind = {"kind": "numeric", "type": "N", "subset": "Guarantee", "uom": uom}
    return dict(kind, covered=covered)


def document(
    evidence=(), demands=(), gates=(), guarantees=(), edges=(), services=(), specs=(), **settings
):
    """Return a model document.

    Args:
        evidence: ids (binary) or (id, dimension).
        gates: "id&" for And, "id|" for Or.
        guarantees: ids or dicts.
        edges: "from>to" with ids that have no ">".
        specs: input id -> keys of its entry that differ.
    """
    known = [one if isinstance(one, tuple) else (one, binary()) for one in evidence]
    rows = [one if isinstance(one, dict) else {"id": one} for one in guarantees]
    inputs = []
    for name in [*(name for name, _ in known), *demands]:
        entry = {"id": name, "attribute": name, "requires": [], "max_age": None}
        entry.update(factor=None, default=None)
        entry.update(dict(specs).get(name, {}))
        inputs.append(entry)
    data = {
        "format": 1,
        "kind": "consert",
        "id": "Test",
        "source": {"file": "test.yml", "sha256": "", "path": None},
        "inputs": inputs,
        "model": {
            "evidence": [{"id": name, "dimension": dimension} for name, dimension in known],
            "demands": [{"id": name, "dimensions": [binary()]} for name in demands],
            "gates": [{"id": g[:-1], "function": {"&": "And", "|": "Or"}[g[-1]]} for g in gates],
            "guarantees": [
                dict({"class_name": row["id"] + "Class", "default": False, "ranking": None}, **row)
                for row in rows
            ],
            "edges": [edge.split(">") if isinstance(edge, str) else list(edge) for edge in edges],
            "provided_services": [
                {"id": name, "functional_service_type": "S", "guarantees": list(members)}
                for name, members in services
            ],
            "required_services": [],
        },
        "settings": settings,
    }
    return signed(data)


def signed(data):
    return dict(data, sha256=digest_of(data))


def monitor(*args, allow_unsupported=False, limit=STRAIGHT_LINE_LIMIT, **kwargs):
    made = document(*args, **kwargs)
    return compiled(made, allow_unsupported=allow_unsupported, limit=limit)


def compiled(data, *, allow_unsupported=False, limit=STRAIGHT_LINE_LIMIT):
    """Return the monitor of a model document."""
    model_file = check_document(data)
    lines = lines_of(model_file, allow_unsupported=allow_unsupported, limit=limit)
    return module_of(module_text(model_file, {"consert": FORMAT}, lines), data["id"]).Monitor()


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
