"""Whether the text of a package is the model that its source has: nothing of it is imported."""

from __future__ import annotations

import importlib
from dataclasses import dataclass

from eddi_scaffold.evidence.conditions import expressions
from eddi_scaffold.evidence.emitted import Emitted, Finding, UnprovedError
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.program.monitor_text import Declaration


@dataclass(frozen=True)
class Checked:
    """What became of the text of a monitor."""

    proved: tuple[str, ...]  # what is proved, in a line each
    findings: list[Finding]  # what keeps it from being proved, empty where nothing does


def checked(monitor: BoundMonitor, text: str) -> Checked:
    """Compare a text with a model and its configuration."""
    kind, proved = monitor.model.kind, list[str]()
    declared = Declaration(monitor.model.name, monitor.facts.digest, monitor.bound)
    parts = {part: f"eddi_runtime.{part}" for part in (kind, "expressions")}
    modules = {"eddi_runtime": "eddi_runtime", **parts}
    formats = {part: importlib.import_module(name).FORMAT for part, name in modules.items()}
    emitted = Emitted(text, kind, declared, formats)
    try:
        emitted.read()
        proved += monitor.model.verify(emitted)
        proved += [f"{len(monitor.bound)} inputs", *expressions(emitted)]
        emitted.end()
    except UnprovedError as refused:
        emitted.findings.append(Finding(refused.line, f"not proved: {refused}", differs=False))
    return Checked(tuple(proved) if not emitted.findings else (), emitted.findings)
