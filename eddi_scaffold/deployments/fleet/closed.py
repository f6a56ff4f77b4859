"""Whether a deployment file knows every robot on whose word something may rest."""

from __future__ import annotations

from eddi_scaffold.deployments.fleet.direct import read_directly
from eddi_scaffold.deployments.fleet.fleet import Fleet
from eddi_scaffold.deployments.wiring.deployment import Member
from eddi_scaffold.deployments.wiring.support import supports


def is_closed(fleet: Fleet) -> bool:
    """Return whether all circles of a fleet are found in its file.

    Who relies on any robot may rely on one that is not in the file. By its digest its model is one
    of those here, and so no circle leads through it if their guarantees rest on no other monitor.
    """
    offers = [one for bond in fleet.bonds if bond.of_any for one in bond.offers]
    if not offers:
        return True
    members = [
        Member(monitor, robot.form.prefix)
        for robot in fleet.robots
        for monitor in fleet.monitors(robot, lambda seat: read_directly(fleet, seat))[0]
    ]
    graph = supports([one.participant for one in members])
    named = {(one.namespace, one.config.config.Model.id): one.participant for one in members}
    return not any(
        graph[named[one.seat.robot.form.prefix, one.seat.id].claim(one.guarantee)] for one in offers
    )
