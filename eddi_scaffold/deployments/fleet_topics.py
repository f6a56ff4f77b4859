"""A fleet as it runs: each robot tells its guarantees to all, and counts the words of others.

The only module that writes the keys of a configuration by which a robot is one of a fleet.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, PeersSection, SimulatorOutput
from eddi_scaffold.deployments.fleet import Fleet
from eddi_scaffold.deployments.offers import DemandBinding, RobotMonitor
from eddi_scaffold.deployments.robots import GuaranteeSource, with_demand_inputs
from eddi_scaffold.monitors.robots import MESSAGE, fleet_message

Digests = Mapping[tuple[str, int], str]
"""Robot and number of its monitor -> SHA-256 of the data of its model."""
_NOT_YET = "0" * 64


def digests_of(fleet: Fleet) -> Digests:
    """Return the digests by which robots know each other's models.

    A digest covers how the inputs of a model are made, though not of whose word: of any robot there
    is a source for each model, and how many these are is known only with the digests of others. It
    settles after as many rounds as there are robots in the longest chain of demands.
    """
    digests: Digests = {}
    for _ in fleet.seats:
        found = dict(_digests(fleet, digests))
        if found == digests:
            break
        digests = found
    return digests


def _digests(fleet: Fleet, known: Digests) -> Iterator[tuple[tuple[str, int], str]]:
    for robot in fleet.robots:
        monitors, _ = fleet.monitors(robot, lambda seat: among_others(fleet, seat, known))
        for index, monitor in enumerate(monitors):
            yield (robot.name, index), monitor.facts.digest


def among_others(
    fleet: Fleet, seat: RobotMonitor, digests: Digests, *, closed: bool = False
) -> ConfigFile:
    """Return the configuration of a monitor on its robot, one of a fleet.

    Args:
        fleet: of the deployment file.
        seat: the monitor on its robot.
        digests: of the models of the others.
        closed: see ``is_closed``.
    """
    shared, config = fleet.file.form.Fleet, seat.config
    if seat.robot.graph is None or fleet_message(seat.monitor.kind) is None:
        return config
    section = FleetSection(
        robot=seat.robot.name, topic=shared.topic, lease=shared.lease, closed=closed
    )
    place = fleet.file.place("Fleet")
    places = dict(config.places)
    places["Fleet",] = place
    places["Fleet", "lease"] = fleet.file.place("Fleet", "lease")
    form = config.config.model_copy(update={"Fleet": section})
    config = replace(config, config=form, places=places)
    for bond in fleet.bonds_of(seat):
        sources = _sources(bond, shared.topic, digests)
        config = with_demand_inputs(config, bond.demand, sources, shared.lease, bond.place)
    return config


def _sources(bond: DemandBinding, topic: str, digests: Digests) -> list[GuaranteeSource]:
    """Return a source for each guarantee of each robot, or, of any robot, of each model."""
    found: dict[PeersSection, None] = {}
    for offer in bond.offers:
        robot, model = offer.seat.robot.name, offer.seat.monitor.model.name
        digest = digests.get((robot, offer.seat.index), _NOT_YET)
        whose: tuple[str, ...] | Literal["any"] = "any" if bond.of_any else (robot,)
        section = PeersSection(robots=whose, model=model, digest=digest, guarantee=offer.guarantee)
        found[section] = None
    return [_source(topic, section) for section in found]


def _source(topic: str, peers: PeersSection) -> GuaranteeSource:
    who = "any" if peers.robots == "any" else peers.robots[0]
    id_ = f"peer_{who}_{attribute(peers.guarantee)}"
    output = SimulatorOutput(id=id_, type=MESSAGE, topic=topic, peers=peers)
    return GuaranteeSource(output, peers.guarantee)
