"""The control station: one more robot, whose ConSert has every guarantee of those that it hears."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.common.problems import EddiError, Problem, problem
from eddi_scaffold.config.deployment_file import Robot
from eddi_scaffold.deployments.fleet import Fleet
from eddi_scaffold.deployments.offers import DemandBinding, Fulfilment, RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot, Pair, graph_of
from eddi_scaffold.deployments.support import wired
from eddi_scaffold.monitors.binding import monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.platforms import MeetingPlace, Platform, chosen
from eddi_scaffold.yaml_text.nodes import dump_plain

STATION = "Station"
_DEMAND = "told_"  # before the name of a guarantee: the demand that it is active


def with_station(fleet: Fleet) -> Fleet:
    """Return a fleet with its control station, without one where there is nothing to hear.

    Raises:
        EddiError: there is no such platform (G008).
    """
    name = fleet.file.form.Station.name
    platform, graph = _place(fleet)
    offered: dict[str, Fulfilment] = {}  # by a name that tells whose they are
    for fulfilment in _heard(fleet):
        whose = f"{fulfilment.provider.robot.name}_{attribute(fulfilment.guarantee)}"
        offered[free_name(whose, offered)] = fulfilment
    if platform is None or not offered:
        return fleet
    model, config = _pair(name, offered)
    entry = Robot.model_construct(name=name, platform=platform.name, monitors=[])
    robot = FleetRobot(entry, len(fleet.robots), platform, graph, ((model, config),))
    bound, problems = monitor_of(model, config)
    if bound is None:
        raise EddiError(*problems)
    monitor, place = RobotMonitor(robot, 0, bound), fleet.file.place(STATION)
    bindings = [
        DemandBinding(monitor, f"{_DEMAND}{id_}", (fulfilment,), of_any=False, place=place)
        for id_, fulfilment in offered.items()
    ]
    return replace(
        fleet,
        robots=(*fleet.robots, robot),
        monitors=(*fleet.monitors, monitor),
        bindings=(*fleet.bindings, *bindings),
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
    graph, meeting = graph_of(form, platform), platform.meeting
    is_named = (form.master, form.domain, form.partition) != (None, None, None)
    if first is None or first.graph is None or meeting is None or is_named:
        return platform, graph
    can_be_there = meeting.key == first.graph.key and (
        meeting.has_partitions or not first.graph.partition
    )
    return platform, first.graph if can_be_there else graph


def _heard(fleet: Fleet) -> list[Fulfilment]:
    """Return the guarantees of all robots where the station is."""
    _, graph = _place(fleet)
    return [
        Fulfilment(monitor, guarantee)
        for monitor in fleet.monitors
        if graph is not None and monitor.robot.graph == graph
        for guarantee in monitor.guarantees
    ]


def _pair(name: str, offered: Mapping[str, Fulfilment]) -> Pair:
    dimensions = [{"Binary": {"type": "Active"}}]
    model = {
        "guarantees": [
            {
                "id": id_,
                "description": f"{fulfilment.provider.name} guarantees {fulfilment.guarantee}",
                "dimensions": dimensions,
            }
            for id_, fulfilment in offered.items()
        ],
        "demands": [{"id": f"{_DEMAND}{id_}", "dimensions": dimensions} for id_ in offered],
        "evidence": [],
        "gates": [],
        "tree_propagations": [{"from": f"{_DEMAND}{id_}", "to": id_} for id_ in offered],
        "required_services": [],
        "provided_services": [],
    }
    frequency = max(fulfilment.provider.frequency for fulfilment in offered.values())
    config = {
        "Model": {"id": name, "type": "ConSert", "frequency": frequency},
        "EDDIOutputs": [{"id": "station", "topic": "guarantees"}],
    }
    reading = read_models(Source(f"{name}.yml", dump_plain(model).encode()))
    file, problems = read_config(Source(f"{name}_config.yml", dump_plain(config).encode()))
    if file is None or not reading.models:
        raise EddiError(*reading.problems, *problems)
    return reading.models[0], file


def is_closed(fleet: Fleet) -> bool:
    """Return whether all circles of a fleet are found in its file.

    Who relies on any robot may rely on one that is not in the file. By its digest its model is one
    of those here, and so no circle leads through it if their guarantees rest on no other monitor.
    """
    of_any = [binding.fulfilments for binding in fleet.bindings if binding.of_any]
    if not of_any:
        return True
    monitors = {
        monitor: wired(monitor.bound, monitor.robot.form.prefix) for monitor in fleet.monitors
    }
    published = {topic for monitor in monitors.values() for topic, _ in monitor.published}
    bound_demands = {(binding.user, binding.demand) for binding in fleet.bindings}

    def rests_on_others(fulfilment: Fulfilment) -> bool:
        provider, monitor = fulfilment.provider, monitors[fulfilment.provider]
        return any(
            (provider, input_) in bound_demands
            or any(topic in published for topic, _ in monitor.topics_read.get(input_, ()))
            for input_ in monitor.claims[fulfilment.guarantee].rests_on
        )

    return not any(rests_on_others(fulfilment) for each in of_any for fulfilment in each)
