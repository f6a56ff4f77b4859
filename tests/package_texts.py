"""What packages hold: an input module as the templates write it, and the facts of the monitor."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eddi_scaffold.monitors.compiling import MonitorFacts, from_json
from eddi_scaffold.packages.rendering import read_answers
from eddi_scaffold.packages.running import packages_in
from eddi_scaffold.regions.markers import Digests, begin_marker, digest, end_marker

INPUT = "src/pkg/EDDIInput.py"


def eddi_input(names: Sequence[str], former: str = "") -> str:
    """Return the module for some inputs, each known as its name behind ``former`` before."""
    methods = "".join(
        _method(name, (f"process_{former}{name}",) if former else ()) for name in names
    )
    return (
        "# fmt: off\n"
        '"""Inputs of the monitor."""\n\nfrom eddi_runtime import EDDIInputBase\n\n\n'
        "class EDDIInput(EDDIInputBase):\n    def __init__(self):\n"
        "        super().__init__(Monitor.inputs)\n"
        + "".join(f"        self.{name} = False\n" for name in names)
        + methods
        + "\n    def processing(self, simulator_outputs):\n        self.begin_processing()\n"
        + "".join(
            f"        self.update({n!r}, self.process_{n}, simulator_outputs)\n" for n in names
        )
    )


def _method(name: str, was: tuple[str, ...]) -> str:
    body = f"        self.{name} = message.data\n"
    begin = begin_marker(f"process_{name}", "python", Digests(digest(body), "81fdda7e"), was)
    end = end_marker(f"process_{name}", "python")
    return f"\n    def process_{name}(self, message):\n        {begin}\n{body}        {end}\n"


def facts_in(package: Path) -> MonitorFacts:
    """Return the facts in the answers of a package."""
    return from_json((read_answers(package) or {})["facts"])


def loaded(package: Path) -> tuple[Any, Any]:
    """Return an ``EDDIMonitor`` and an ``EDDIInput`` of a package."""
    (member,) = packages_in([package]).members()
    assert member.code is not None
    return member.code.new()
