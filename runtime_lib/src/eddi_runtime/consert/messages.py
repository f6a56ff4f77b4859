"""Outputs as message trees, without ROS: plain values of checked types only."""

from __future__ import annotations

from typing import Any, List, Optional, Sequence, Tuple

from ..monitor import Tree
from ..plain_values import plain


def output_message(output: object, published: Sequence[str]) -> Tuple[Tree, Tuple[str, ...]]:
    """Return the ``ConSertOutput`` tree of an output and what was wrong with it; never raises.

    Args:
        output: what ``execute_step`` gave, or what a person's code made of it.
        published: ids that are published as not active when the output is no list at all.
    """
    faults: List[str] = []
    rows: Sequence[object]
    if issubclass(type(output), (list, tuple)) and isinstance(output, (list, tuple)):
        rows = output
    else:
        faults.append("the output is not a list; nothing is published as active")
        rows = [{"id": one, "active": False} for one in published]
    trees = [_row_tree(row, faults) for row in rows]
    guarantees = [tree for tree in trees if tree is not None]
    return ("ConSertOutput", {"guarantees": guarantees}), tuple(faults)


def _row_tree(row: Any, faults: List[str]) -> Optional[Tree]:
    try:
        name, active = plain(row["id"]), plain(row["active"])
    except Exception:  # noqa: BLE001 - a person's code may have put anything there
        faults.append("a row of the output has no 'id' or no 'active'; it is left out")
        return None
    if not isinstance(name, str):
        faults.append("the 'id' of a row of the output is not a text; it is left out")
        return None
    if not isinstance(active, bool):
        faults.append(f"'active' of {name!r} is not a bool; published as not active")
        active = False
    return "Guarantee", {"id": name, "active": active}
