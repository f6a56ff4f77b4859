"""Whether a deployment file knows every robot on whose word something may rest."""

from __future__ import annotations

from eddi_scaffold.deployments.fleet.fleet import Fleet
from eddi_scaffold.deployments.fleet.offers import Offer, Seat
from eddi_scaffold.deployments.wiring.deployment import Member
from eddi_scaffold.deployments.wiring.support import Participant


def is_closed(fleet: Fleet) -> bool:
    """Return whether all circles of a fleet are found in its file.

    Who relies on any robot may rely on one that is not in the file. By its digest its model is one
    of those here, and so no circle leads through it if their guarantees rest on no other monitor.
    """
    offers = dict.fromkeys(one for bond in fleet.bonds if bond.of_any for one in bond.offers)
    if not offers:
        return True
    seats = {seat: Member(seat.monitor, seat.robot.form.prefix).participant for seat in fleet.seats}
    published = {topic for one in seats.values() for topic in one.published()}
    bound: dict[Seat, set[str]] = {}
    for bond in fleet.bonds:
        bound.setdefault(bond.user, set()).add(bond.demand)

    def rests_on_others(offer: Offer) -> bool:
        one: Participant = seats[offer.seat]
        inputs = one.outputs[offer.guarantee]
        read = {topic for input_ in inputs for topic in one.topics(input_)}
        return not (inputs.isdisjoint(bound.get(offer.seat, ())) and read.isdisjoint(published))

    return not any(map(rests_on_others, offers))
