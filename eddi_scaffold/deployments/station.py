"""The control station: one more robot, whose ConSert has every guarantee of those that it hears."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.common.problems import EddiError, Problem, problem
from eddi_scaffold.config.deployment_file import Robot
from eddi_scaffold.config.reading import read_config
from eddi_scaffold.deployments.fleet import Fleet
from eddi_scaffold.deployments.offers import DemandBinding, Fulfilment, RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot, Pair, graph_of
from eddi_scaffold.deployments.support import WiredMonitor
from eddi_scaffold.deployments.topics import Member
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.binding import monitor_of
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.platforms import MeetingPlace, Platform, chosen
from eddi_scaffold.yaml_text.nodes import dump_plain

STATION = "Station"
_KIND = "consert"
_FOUND = "told_"
"""Before the name of a guarantee: the demand that it is active."""


def with_station(fleet: Fleet) -> Fleet:
    """Return a fleet with its control station, without one where there is nothing to hear.

    Raises:
        EddiError: there is no such platform (G008).
    """
    form = fleet.file.form.Station
    platform, graph = _place(fleet)
    offers = _named(_heard(fleet))
    if platform is None or not offers:
        return fleet
    model, config = _pair(form.name, offers)
    entry = Robot.model_construct(name=form.name, platform=platform.name, monitors=[])
    robot = FleetRobot(entry, len(fleet.robots), platform, graph, ((model, config),))
    monitor, problems = monitor_of(model, kinds()[_KIND], config)
    if monitor is None:
        raise EddiError(*problems)
    seat, place = RobotMonitor(robot, 0, monitor), fleet.file.place(STATION)
    bonds = [
        DemandBinding(seat, f"{_FOUND}{name}", (offer,), of_any=False, place=place)
        for name, offer in offers.items()
    ]
    return replace(
        fleet,
        robots=(*fleet.robots, robot),
        seats=(*fleet.seats, seat),
        bonds=(*fleet.bonds, *bonds),
    )


def check_station(fleet: Fleet) -> Iterator[Problem]:
    """Report a station that hears nothing where it was put (D013)."""
    place = fleet.file.place(STATION)
    if place != fleet.file.place() and not _heard(fleet):
        yield problem("D013.station", place, station=fleet.file.form.Station.name)


def _place(fleet: Fleet) -> tuple[Platform | None, MeetingPlace | None]:
    """Return platform and place of the station: by default those of the first robot that has one.

    Raises:
        EddiError: there is no such platform (G008).
    """
    form = fleet.file.form.Station
    first = next((robot for robot in fleet.robots if robot.graph is not None), None)
    if form.platform is not None:
        platform = chosen(form.platform)
    elif first is not None:
        platform = first.platform
    else:
        return None, None
    graph = graph_of(form, platform)
    named = (form.master, form.domain, form.partition) != (None, None, None)
    if first is None or first.graph is None or graph is None or named:
        return platform, graph
    return platform, _reached(first.graph, platform) or graph


def _reached(graph: MeetingPlace, platform: Platform) -> MeetingPlace | None:
    """Return a place if robots of a platform can be there."""
    meeting = platform.meeting
    if meeting is None or meeting.key != graph.key:
        return None
    return graph if meeting.has_partitions or not graph.partition else None


def _heard(fleet: Fleet) -> list[Fulfilment]:
    """Return the guarantees of all robots where the station is."""
    graph = _place(fleet)[1]
    heard = [seat for seat in fleet.seats if graph is not None and seat.robot.graph == graph]
    return [Fulfilment(seat, name) for seat in heard for name in seat.guarantees]


def _named(offers: Sequence[Fulfilment]) -> Mapping[str, Fulfilment]:
    """Return guarantees by a name that tells whose they are."""
    names: dict[str, Fulfilment] = {}
    for offer in offers:
        wanted = f"{offer.seat.robot.name}_{attribute(offer.guarantee)}"
        names[free_name(wanted, names)] = offer
    return names


def _pair(name: str, offers: Mapping[str, Fulfilment]) -> Pair:
    model = {
        "guarantees": [
            {
                "id": id_,
                "description": f"{offer.seat.name} guarantees {offer.guarantee}",
                "dimensions": [_binary("Active")],
            }
            for id_, offer in offers.items()
        ],
        "demands": [{"id": f"{_FOUND}{id_}", "dimensions": [_binary("Active")]} for id_ in offers],
        "evidence": [],
        "gates": [],
        "tree_propagations": [{"from": f"{_FOUND}{id_}", "to": id_} for id_ in offers],
        "required_services": [],
        "provided_services": [],
    }
    config = {
        "Model": {
            "id": name,
            "type": "ConSert",
            "frequency": max(offer.seat.frequency for offer in offers.values()),
        },
        "EDDIOutputs": [{"id": "station", "topic": "guarantees"}],
    }
    reading = read_models(_source(f"{name}.yml", model))
    file, problems = read_config(_source(f"{name}_config.yml", config))
    if file is None or not reading.models:
        raise EddiError(*reading.problems, *problems)
    return reading.models[0], file


def _binary(type_: str) -> dict[str, object]:
    return {"Binary": {"type": type_}}


def _source(name: str, data: Mapping[str, object]) -> Source:
    return Source(name, dump_plain(data).encode())


def is_closed(fleet: Fleet) -> bool:
    """Return whether all circles of a fleet are found in its file.

    Who relies on any robot may rely on one that is not in the file. By its digest its model is one
    of those here, and so no circle leads through it if their guarantees rest on no other monitor.
    """
    offers = dict.fromkeys(one for bond in fleet.bonds if bond.of_any for one in bond.offers)
    if not offers:
        return True
    seats = {seat: Member(seat.monitor, seat.robot.form.prefix).participant for seat in fleet.seats}
    published = {topic for monitor in seats.values() for topic, _ in monitor.published}
    bound: dict[RobotMonitor, set[str]] = {}
    for bond in fleet.bonds:
        bound.setdefault(bond.user, set()).add(bond.demand)

    def rests_on_others(offer: Fulfilment) -> bool:
        one: WiredMonitor = seats[offer.seat]
        inputs = one.claims[offer.guarantee].rests_on
        read = {topic for input_ in inputs for topic, _ in one.topics_read.get(input_, ())}
        return not (inputs.isdisjoint(bound.get(offer.seat, ())) and read.isdisjoint(published))

    return not any(map(rests_on_others, offers))
