"""The short form of a ConSert in today's full form, as far as the oracle `chains.yml` uses it."""

import re
from collections.abc import Mapping
from typing import Any

import yaml

_RANGE = re.compile(r"(\S+) \.\. (\S+) (\S+)")


def full_form(text: str) -> str:
    """Return the full form; parentheses are one level deep, the word around them is OR."""
    short = yaml.safe_load(text)
    gates: list[dict[str, Any]] = []
    edges: list[dict[str, str]] = []

    def into(target: str, row: str) -> None:
        """Lead a row of inputs into a node that is an And."""
        if " OR " in row:
            gate = f"{target}_or"
            gates.append({"id": gate, "function": "Or"})
            edges.append({"from": gate, "to": target})
            for number, part in enumerate(row.split(" OR ")):
                if part.startswith("("):
                    inner = f"{target}_and_{number}"
                    gates.append({"id": inner, "function": "And"})
                    edges.append({"from": inner, "to": gate})
                    into(inner, part.strip("()"))
                else:
                    edges.append({"from": part, "to": gate})
            return
        edges.extend({"from": one, "to": target} for one in row.split(" AND "))

    for name, row in short["guarantees"].items():
        into(name, row)
    evidence = short["evidence"].items()
    document = {
        "guarantees": [
            {"id": name, "dimensions": [{"Binary": {"type": name}}]} for name in short["guarantees"]
        ],
        "demands": [],
        "evidence": [{"id": name, "dimension": _dimension(name, what)} for name, what in evidence],
        "gates": gates,
        "tree_propagations": edges,
        "required_services": [],
        "provided_services": [],
    }
    return yaml.safe_dump(document, sort_keys=False)


def _dimension(name: str, what: str | list[str]) -> Mapping[str, Any]:
    if what == "bool":
        return {"Binary": {"type": name}}
    if isinstance(what, list):
        return {"Categorical": {"type": name, "covered": what, "subset": "Demand"}}
    found = _RANGE.fullmatch(what)
    if found is not None:
        bounds: dict[str, Any] = {"Inclusive": {"start": float(found[1]), "end": float(found[2])}}
        unit = found[3]
    else:
        below, limit, unit = what.split()
        assert below == "below"
        bounds = {"Exclusive": {"start": float("-inf"), "end": float(limit)}}
    uom = "percent" if unit == "%" else unit
    return {"Numeric": {"type": name, "covered": [bounds], "subset": "Demand", "uom": uom}}
