#!/usr/bin/env python3
"""Count the rooms, floors and arrows of a package, from its imports.

    script/rooms.py                          # of eddi_scaffold in this checkout
    script/rooms.py PATH/TO/eddi_scaffold    # of another one, such as an older checkout

A room is a module or a package directly below the root. An arrow goes from a room to each room that
it imports. A floor is the longest way down from a room, where rooms of one circle count as one.
Imports for type checkers and imports inside functions count as well.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

Graph = dict[str, set[str]]


def modules(root: Path) -> dict[str, Path]:
    """Return dotted name -> file of every module of a package."""
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """Yield the names of the modules that a module imports; of ``from a import b`` also ``a.b``."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield inner if inner in known else node.module


def rooms(root: Path) -> Graph:
    """Return room -> the rooms that it imports."""
    known = modules(root)
    graph: Graph = {}
    for name, path in known.items():
        room = _room(name)
        below = graph.setdefault(room, set())
        wanted = (one for one in imports(path, known) if one in known)
        below.update(_room(one) for one in wanted if _room(one) != room)
    return graph


def floors(graph: Graph) -> list[list[str]]:
    """Return the rooms of each floor, the lowest first.

    Raises:
        CycleError: rooms import each other in a circle.
    """
    floor: dict[str, int] = {}
    for room in TopologicalSorter(graph).static_order():
        floor[room] = 1 + max((floor[below] for below in graph[room]), default=0)
    highest = max(floor.values(), default=0)
    return [sorted(r for r, f in floor.items() if f == one) for one in range(1, highest + 1)]


def main(root: Path) -> int:
    """Print the table; the exit status is 1 when there is a circle."""
    graph = rooms(root)
    print(f"{len(graph)} rooms, {sum(map(len, graph.values()))} arrows")
    try:
        for number, names in enumerate(floors(graph), start=1):
            print(f"{number:3}  {' '.join(names)}")
    except CycleError as found:
        print(f"a circle: {' -> '.join(found.args[1])}")
        return 1
    return 0


def _room(module: str) -> str:
    return module.split(".")[1] if "." in module else "__init__"


if __name__ == "__main__":
    here = Path(__file__).resolve().parents[1] / "eddi_scaffold"
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else here))
