"""Static checks of one ConSert: S001 to S007."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.model import ConSert
    from eddi_scaffold.problems import Problem


def static_checks(consert: ConSert) -> list[Problem]:
    """Return findings."""
    return []
