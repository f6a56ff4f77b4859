"""Which parts of the runtime a compiled monitor needs: no other travels with it."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable, Mapping

from eddi_scaffold.common.graphs import reached

PARTS: Mapping[str, tuple[str, ...]] = {
    "bayesian_network": (),
    "bayesian_network/arrays": ("bayesian_network",),
    "bayesian_network/claims": ("bayesian_network", "thresholds"),
    "bayesian_network/direct": ("bayesian_network",),
    "bayesian_network/explain": ("bayesian_network",),
    "bayesian_network/memory": ("bayesian_network/readers",),
    "bayesian_network/readers": ("bayesian_network",),
    "bayesian_network/schedule": ("bayesian_network/arrays",),
    "bayesian_network/tables": ("bayesian_network",),
    "consert": (),
    "consert/filters": ("consert",),
    "consert/search": ("consert",),
    "event": ("expressions",),
    "expressions": (),
    "expressions/expression": ("expressions", "history"),
    "expressions/hold": ("expressions",),
    "expressions/lists": ("expressions",),
    "expressions/stacks": ("expressions/window",),
    "expressions/window": ("expressions/hold",),
    "expressions/windows": ("expressions/window",),
    "history": (),
    "node/life_cycle": (),
    "peers": (),
    "reliability": ("thresholds",),
    "reliability/battery": ("reliability/laws",),
    "reliability/chain": ("reliability",),
    "reliability/large_chain": ("reliability/chain",),
    "reliability/large_tree": ("reliability/tree",),
    "reliability/laws": ("reliability",),
    "reliability/observed": ("reliability/chain",),
    "reliability/processor": ("reliability/laws",),
    "reliability/rotors": ("reliability",),
    "reliability/tree": ("reliability",),
    "reliability/units": ("reliability",),
    "safeml": ("history",),
    "state_machine": ("event", "history"),
    "testing": (),
    "thresholds": (),
    "transports/ros1/host": (),
    "transports/ros2/lifecycle": ("node/life_cycle",),
}
"""Part of ``eddi_runtime``, a folder or a module -> other parts that it imports."""

_ON_NUMPY = frozenset(
    ["bayesian_network/arrays", "reliability/large_chain", "reliability/large_tree", "safeml"]
)
TESTING = "testing"  # what runs the test vectors of a monitor
PEERS = "peers"  # what a monitor needs that is one of a fleet

LIFE_CYCLE = "transports/ros2/lifecycle"
"""What a monitor needs of which others say when it is active."""

HOST = "transports/ros1/host"  # runs all monitors of a workspace in one process


def runtime_parts_of(text: str) -> tuple[str, ...]:
    """Return the parts of the runtime that a ``compiled.py`` needs, sorted."""
    head, _, _ = text.partition("\neddi_runtime.needs(")  # the rest may be megabytes of numbers
    imported: list[str] = []
    for node in ast.parse(head).body:
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            runtime, _, part = node.module.partition(".")
            if runtime == "eddi_runtime":
                imported += [f"{part}/{name.name}" if part else name.name for name in node.names]
    return with_needed(part for part in imported if part in PARTS)


def with_needed(parts: Iterable[str]) -> tuple[str, ...]:
    """Return parts with all that they import, sorted."""
    # what is always there needs none
    return tuple(sorted(reached(defaultdict(tuple, PARTS), parts)))


def requirements_of(parts: Iterable[str]) -> list[str]:
    """Return what parts of the runtime need from PyPI."""
    return [] if _ON_NUMPY.isdisjoint(parts) else ["numpy"]
