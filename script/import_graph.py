#!/usr/bin/env python3
"""Print how the parts of the project import each other: rooms, floors, arrows and circles.

    script/import_graph.py                   # of this checkout
    script/import_graph.py PATH/TO/CHECKOUT  # of another one, such as an older one

A room is a module or a folder directly below `eddi_scaffold`; the runtime, the benchmarks and the
scripts are one each. An arrow leads from a room to one that it imports, for type checkers or inside
a function as well. A room is on the floor above the highest one that it imports. A circle is a
group of modules that need each other, or of rooms; the exit status is then 1.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from pathlib import Path

Graph = dict[str, set[str]]
ROOTS = ("eddi_scaffold", "runtime_lib/src/eddi_runtime", "benchmarks", "script")


def modules(checkout: Path) -> dict[str, Path]:
    """Return dotted name -> file of every module."""
    found = {}
    for root in map(checkout.joinpath, ROOTS):
        for path in root.rglob("*.py"):
            parts = path.relative_to(root.parent).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(name: str, path: Path, known: Mapping[str, Path]) -> Iterator[str]:
    """Yield the modules that a module imports; of ``from a import b`` ``a.b`` if that is one."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            start = package.split(".")[: len(package.split(".")) + 1 - node.level]
            base = ".".join([*(start if node.level else ()), *filter(None, [node.module])])
            inner = [f"{base}.{alias.name}" for alias in node.names]
            yield from (one if one in known else base for one in inner if base in known)


def room_of(module: str) -> str:
    """Return the room of a module."""
    root, *below = module.split(".")
    return root if root != "eddi_scaffold" else (below or ["__init__"])[0]


def rooms_of(graph: Graph) -> Graph:
    """Return room -> the other rooms that its modules import."""
    rooms: Graph = {}
    for module, imported in graph.items():
        room = room_of(module)
        rooms.setdefault(room, set()).update({room_of(one) for one in imported} - {room})
    return rooms


def circles(graph: Graph) -> list[list[str]]:
    """Return the groups of nodes that reach each other (Tarjan)."""
    index: dict[str, int] = {}
    lowest: dict[str, int] = {}
    path: list[str] = []
    found = []

    def visit(node: str) -> None:
        index[node] = lowest[node] = len(index)
        path.append(node)
        for other in sorted(graph[node]):
            if other not in index:
                visit(other)
            if other in path:
                lowest[node] = min(lowest[node], lowest[other])
        if lowest[node] == index[node]:
            group = path[path.index(node) :]
            del path[path.index(node) :]
            if len(group) > 1:
                found.append(sorted(group))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def floors(graph: Graph) -> list[list[str]]:
    """Return the nodes of each floor, the lowest first; of a circle all are on one."""
    group = {node: frozenset([node]) for node in graph}
    group |= {node: frozenset(circle) for circle in circles(graph) for node in circle}
    floor: dict[AbstractSet[str], int] = {}

    def floor_of(nodes: AbstractSet[str]) -> int:
        if nodes not in floor:
            below = {group[other] for node in nodes for other in graph[node]} - {nodes}
            floor[nodes] = 1 + max(map(floor_of, below), default=0)
        return floor[nodes]

    number = {node: floor_of(group[node]) for node in sorted(graph)}
    highest = max(number.values(), default=0)
    return [[n for n, at in number.items() if at == one] for one in range(1, highest + 1)]


def main(checkout: Path) -> int:
    """Print the floors from the top, and the circles."""
    known = modules(checkout)
    graph = {name: set(imports(name, path, known)) - {name} for name, path in known.items()}
    rooms = rooms_of(graph)
    found = [*circles(rooms), *circles(graph)]
    arrows, storeys = sum(map(len, rooms.values())), floors(rooms)
    print(f"{len(rooms)} rooms, {len(storeys)} floors, {arrows} arrows, {len(found)} circles")
    for number in range(len(storeys), 0, -1):
        print(f"{number:3}  {' '.join(storeys[number - 1])}")
    for circle in found:
        print(f"circle: {' '.join(circle)}")
    return 1 if found else 0


if __name__ == "__main__":
    here = Path(__file__).resolve().parents[1]
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else here))
