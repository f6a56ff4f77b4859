#!/usr/bin/env python3
"""Print the import graph of a package: its subpackages in layers, and how many imports join them.

    script/import_graph.py                          # of eddi_scaffold in this checkout
    script/import_graph.py PATH/TO/eddi_scaffold    # of another one, such as an older checkout

A node is a module or a package directly below the root; an edge goes from it to each node that it
imports. The layer of a node is the length of the longest path down from it. Imports for type
checkers and imports inside functions count as well.
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


def import_graph(root: Path) -> Graph:
    """Return node -> the nodes that it imports."""
    known = modules(root)
    graph: Graph = {}
    for name, path in known.items():
        node = _node(name)
        below = graph.setdefault(node, set())
        wanted = (one for one in imports(path, known) if one in known)
        below.update(_node(one) for one in wanted if _node(one) != node)
    return graph


def layers(graph: Graph) -> list[list[str]]:
    """Return the nodes of each layer, the lowest first.

    Raises:
        CycleError: nodes import each other in a cycle.
    """
    layer: dict[str, int] = {}
    for node in TopologicalSorter(graph).static_order():
        layer[node] = 1 + max((layer[below] for below in graph[node]), default=0)
    highest = max(layer.values(), default=0)
    return [sorted(n for n, at in layer.items() if at == one) for one in range(1, highest + 1)]


def main(root: Path) -> int:
    """Print the layers; the exit status is 1 when there is a cycle."""
    graph = import_graph(root)
    print(f"{len(graph)} nodes, {sum(map(len, graph.values()))} edges")
    try:
        for number, names in enumerate(layers(graph), start=1):
            print(f"{number:3}  {' '.join(names)}")
    except CycleError as found:
        print(f"a cycle: {' -> '.join(found.args[1])}")
        return 1
    return 0


def _node(module: str) -> str:
    return module.split(".")[1] if "." in module else "__init__"


if __name__ == "__main__":
    here = Path(__file__).resolve().parents[1] / "eddi_scaffold"
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else here))
