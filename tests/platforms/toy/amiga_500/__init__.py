"""A platform that exists in tests only: one node and one list of nodes, for no robot at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.monitors.answers import files_of, identity_answers, shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.platforms import PackageAnswers, Platform

_TEMPLATES = ("robot", "fleet")


def _monitor(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    files = files_of(monitor)
    answers = shared_answers(monitor, _TEMPLATES[0], files) | {"colour": "red"}
    return PackageAnswers(monitor.package, answers, files), []


def _support(monitors: Sequence[str]) -> list[PackageAnswers]:
    identity = identity_answers("all_robots", "All of them", None)
    return [
        PackageAnswers(
            "all_robots", {"template": _TEMPLATES[1], **identity, "monitors": [*monitors]}
        )
    ]


def _taken_names(_root: Path | None) -> Mapping[str, str]:
    return {"all_robots": "it is the list of all"}


def _next_steps(place: Path, monitors: Sequence[str]) -> Sequence[str]:
    return [f"cd {place}", *(f"switch on {name}" for name in monitors)]


PLATFORM = Platform(
    name="amiga_500",
    templates=_TEMPLATES,
    workspace="box of floppy disks",
    root="src/eddi_monitor",
    needs_config=True,
    monitor=_monitor,
    support=_support,
    taken_names=_taken_names,
    next_steps=_next_steps,
)
