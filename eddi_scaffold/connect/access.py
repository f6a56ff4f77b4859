"""How a configuration takes a value from a message: ``field:`` or ``expression:``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from eddi_scaffold import units
from eddi_scaffold.connect.needs import Need
from eddi_scaffold.connect.topics import Leaf, RobotTopic
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.kinds import TODO

_SCANS = ("LaserScan", "MultiEchoLaserScan")
_DISTANCES = ("distance", "dist", "range", "clearance", "proximity", "nearest", "closest")


@dataclass(frozen=True)
class Access:
    """What is written for an input.

    Attributes:
        key: ``field`` or ``expression``.
        text: its value.
        unit: the value is in this one, and converted; ``None`` where it is that of the model.
        is_complete: nothing in it is left to a person.
    """

    key: Literal["field", "expression"]
    text: str
    unit: str | None = None
    is_complete: bool = True


def units_of(leaf: Leaf) -> tuple[str, ...] | None:
    """Return the units of a value as it is taken: of a variance, that of the deviation."""
    if leaf.units is None or not leaf.is_variance:
        return leaf.units
    return tuple(units.root(unit) or unit for unit in leaf.units)


def access(need: Need, topic: RobotTopic, leaf: Leaf) -> Access:
    """Return how an input takes a value of a topic."""
    if not leaf.path:
        return Access("field", TODO, is_complete=False)
    path, name = leaf.text.replace("[]", f"[{TODO}]"), attribute(topic.id)
    unit, is_own = _unit(need, leaf), topic.is_of_monitor
    if need.type.endswith("[]") and leaf.lists == 1 and leaf.text.endswith("[]"):
        return Access("field", leaf.text.removesuffix("[]"), unit)
    if leaf.is_variance:
        return Access("expression", f"SQRT({name}.{path})", unit, not leaf.lists)
    if topic.message in _SCANS and leaf.path[0] == "ranges[]" and _is_distance(need):
        every = re.sub(r"\[\]", "[*]", leaf.text)
        return Access("expression", f"MIN({name}.{every}, COVERAGE 0.9)", unit)
    if need.type == "bool" and leaf.type != "bool":
        return Access("expression", f"{name}.{path} == {TODO}", None, is_complete=False)
    return Access("field", path, unit, not leaf.lists and not is_own)


def _is_distance(need: Need) -> bool:
    """Return whether an input is a distance: by its unit, else by its words.

    A scan has other numbers as well: the share of it that fits a map is not its least range.
    """
    return need.type in ("float", "int") and (need.unit is not None or need.says(*_DISTANCES))


def _unit(need: Need, leaf: Leaf) -> str | None:
    """Return the unit of the value where it has to be converted."""
    given = units_of(leaf)
    if need.unit is None or not given:
        return None
    factors = [(unit, units.factor(unit, need.unit)) for unit in given]
    if any(exact == 1 for _, exact in factors):
        return None
    return next((unit for unit, exact in factors if exact is not None), None)
