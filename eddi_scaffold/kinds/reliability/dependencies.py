"""Order and cycles of what uses each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence


def order(top: str, below: Mapping[str, Sequence[str]]) -> tuple[list[str], tuple[str, ...]]:
    """Return all that the top reaches, each behind what it uses, and a cycle if there is one.

    Args:
        top: where to begin.
        below: what each uses; what has no entry uses nothing.

    Returns:
        The order, incomplete when there is a cycle, and the members of the first cycle, each
        using the next one and the last the first; empty for none.
    """
    done: dict[str, None] = {}
    path: dict[str, None] = {}
    waiting: list[tuple[str, bool]] = [(top, False)]
    while waiting:
        node, leaving = waiting.pop()
        if leaving:
            path.pop(node)
            done[node] = None
        elif node in path:
            members = list(path)
            return list(done), tuple(members[members.index(node) :])
        elif node not in done:
            path[node] = None
            waiting.append((node, True))
            waiting += [(n, False) for n in reversed(below.get(node, ()))]
    return list(done), ()
