"""Outputs as message trees, without ROS: plain values of checked types only."""

from __future__ import annotations

from typing import Any, List, Mapping, Optional, Sequence, Tuple

from ..monitor import Tree
from ..plain_values import plain

FALSE, UNKNOWN, TRUE = 0, 1, 2
"""Verdicts as ``EventOutput`` has them."""


def output_messages(
    output: object, accepted: Mapping[str, Sequence[str]]
) -> Tuple[List[Tree], Tuple[str, ...]]:
    """Return the ``EventOutput`` trees of an output and what was wrong with it; never raises.

    Args:
        output: what ``execute_step`` gave, or what a person's code made of it.
        accepted: event -> acceptances in use.
    """
    if not (issubclass(type(output), (list, tuple)) and isinstance(output, (list, tuple))):
        return [], ("the output is not a list; nothing is published",)
    faults: List[str] = []
    trees = [_tree(row, accepted, faults) for row in output]
    return [tree for tree in trees if tree is not None], tuple(faults)


def _tree(row: Any, accepted: Mapping[str, Sequence[str]], faults: List[str]) -> Optional[Tree]:
    try:
        name, verdict = plain(row["id"]), plain(row["verdict"])
        flags = {key: plain(row[key]) for key in ("active", "raised", "cleared")}
        known = isinstance(verdict, bool) or row["verdict"] is None
    except Exception:  # noqa: BLE001 - a person's code may have put anything there
        faults.append("a row of the output is not as execute_step gives it; it is left out")
        return None
    sound = {key: flag for key, flag in flags.items() if isinstance(flag, bool)}
    if not isinstance(name, str) or not known or len(sound) < len(flags):
        faults.append("a row of the output has values of wrong types; it is left out")
        return None
    truth = UNKNOWN if verdict is None else TRUE if verdict else FALSE
    accepts = list(accepted.get(name, ()))
    return "EventOutput", {"id": name, "verdict": truth, **sound, "accepted": accepts}
