"""Which parts of the runtime a compiled monitor needs beside the core: no other travels with it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.compiling.document import ModelFile

PARTS: Mapping[str, tuple[str, ...]] = {
    "bayesian_network": ("clock", "thresholds"),
    "clock": (),
    "consert": (),
    "event": ("clock", "expressions"),
    "expressions": (),
    "reliability": ("clock", "thresholds"),
    "safeml": ("clock",),
    "testing": (),
    "thresholds": (),
}
"""Part of ``eddi_runtime``, a folder or a module -> other parts that it imports.

``testing`` is for the tests of people who have the distribution; no monitor needs it.
"""


def parts_of(model_file: ModelFile) -> tuple[str, ...]:
    """Return the parts of the runtime that the monitor of a model needs, sorted."""
    wanted = [model_file.kind]
    if any(one.expression is not None for one in model_file.inputs):
        wanted.append("expressions")
    return with_needed(wanted)


def with_needed(parts: Iterable[str]) -> tuple[str, ...]:
    """Return parts with all that they import, sorted."""
    found: set[str] = set()
    waiting = list(parts)
    while waiting:
        part = waiting.pop()
        if part not in found:
            found.add(part)
            waiting += PARTS[part]
    return tuple(sorted(found))
