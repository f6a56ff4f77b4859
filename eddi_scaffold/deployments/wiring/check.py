"""``check`` of monitors that belong together: everything that only their wiring shows."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.deployments.wiring.acceptances import check_acceptances
from eddi_scaffold.deployments.wiring.composition import check_composition
from eddi_scaffold.deployments.wiring.deployment import Member, deployment
from eddi_scaffold.deployments.wiring.hidden import check_hidden
from eddi_scaffold.deployments.wiring.meanings import check_meanings
from eddi_scaffold.deployments.wiring.qualities import check_qualities
from eddi_scaffold.deployments.wiring.support import Participant, check_rings
from eddi_scaffold.deployments.wiring.topics import (
    check_alone,
    check_spellings,
    check_topics,
    check_types,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.problems import Problem


def check_wiring(members: Sequence[Member], others: Sequence[Participant] = ()) -> list[Problem]:
    """Check what monitors read of each other (D001 to D009 but D006 and D008, D016, D017, D019).

    Args:
        members: the monitors that are at hand.
        others: those that run with them.
    """
    together = deployment(members, others)
    rings = list(check_rings(together.participants))
    return [
        *check_meanings(together),
        *check_alone(together.participants),
        *check_composition(together),
        *check_topics(together),
        *check_types(together),
        *check_spellings(together),
        *check_qualities(together.participants),
        *rings,
        *([] if rings else check_hidden(together.participants)),
        *([] if rings else check_acceptances([member.participant for member in members])),
    ]


def members_of(monitors: Sequence[BoundMonitor]) -> list[Member]:
    """Return the monitors that are wired at all: those with a configuration."""
    return [Member(monitor) for monitor in monitors if monitor.config is not None]
