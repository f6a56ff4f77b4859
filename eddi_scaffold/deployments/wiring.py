"""Monitors that are wired to each other by topics, and whether what is wired may be relied on.

A monitor by itself takes a missing or old message as unknown. Behind another monitor that is not
enough: its messages go on when its own sources have died. So every field of a monitor's message
that is read must have a meaning only where something is known, each demand must be fulfilled by the
guarantee that it is wired to, and no claim may rest on itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.deployments.meanings import check_meanings
from eddi_scaffold.deployments.support import (
    WiredMonitor,
    check_acceptances,
    check_rings,
    supports,
    wired,
)
from eddi_scaffold.deployments.topics import (
    Deployment,
    check_alone,
    check_spellings,
    check_topics,
    check_types,
)
from eddi_scaffold.monitors.binding import BoundMonitor


def check_hidden(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report what is told to other robots and rests by topics on a statement of a robot (D003)."""
    relying: dict[str, WiredMonitor] = {}
    for monitor in participants:
        sources = {source.id for source in monitor.config.config.SimulatorOutputs if source.peers}
        fed = {input_.id for input_ in monitor.facts.inputs if sources & set(input_.requires)}
        claims = [claim.id for claim in monitor.facts.claims if fed & claim.rests_on]
        relying |= dict.fromkeys(map(monitor.claim, claims), monitor)
    graph = supports(participants) if relying else {}
    for monitor in participants if relying else ():
        fleet = monitor.config.config.Fleet
        if fleet is None or fleet.closed:  # nobody relies on it whose circles were not looked for
            continue
        for claim in map(monitor.claim, monitor.claims):
            behind = reached(graph, [claim])
            hidden = (name for name, of in relying.items() if name in behind and of is not monitor)
            if (name := next(hidden, None)) is not None:
                place, names = monitor.config.place("Fleet"), {"monitor": name}
                yield problem("D003.hidden_circle", place, claim=claim, name=monitor.name, **names)
                break


def check_wiring(
    members: Sequence[WiredMonitor], others: Sequence[WiredMonitor] = ()
) -> list[Problem]:
    """Check what monitors read of each other (D001 to D009 but D006 and D008)."""
    together = Deployment(members, others)
    rings = list(check_rings(together.participants))
    return [
        *check_meanings(together),
        *check_alone(together),
        *check_topics(together),
        *check_types(together),
        *check_spellings(together),
        *rings,
        *([] if rings else check_hidden(together.participants)),
        *([] if rings else check_acceptances(members)),
    ]


def members_of(monitors: Sequence[BoundMonitor]) -> list[WiredMonitor]:
    """Return the monitors that are wired at all: those with a configuration."""
    return [wired(monitor) for monitor in monitors if monitor.config is not None]
