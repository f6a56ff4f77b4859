"""Which guarantees of which robots may fulfil a demand, as the deployment file says."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.config.deployment_file import Binding, FleetFile
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.monitors.binding import BoundMonitor

_MOST_REASONS = 3
_MOST_FULFILMENTS = 2_500
"""Each is checked, and most are written down: 50 robots of which each relies on any other one."""


@dataclass(frozen=True, eq=False)
class RobotMonitor:
    """A monitor on its robot."""

    robot: FleetRobot  # where it runs
    index: int  # of the monitor among those of the robot
    bound: BoundMonitor  # its model and configuration, as they are without other robots

    @property
    def config(self) -> ConfigFile:
        """Its configuration, as it is without other robots."""
        assert self.bound.config is not None
        return self.bound.config

    @property
    def id(self) -> str:
        """``Model: id:`` of its configuration."""
        return self.config.config.Model.id

    @property
    def name(self) -> str:
        """Robot and monitor, for people."""
        return f"{self.robot.name}/{self.id}"

    @property
    def key(self) -> tuple[str, int]:
        """Robot and number of the monitor among those of it."""
        return self.robot.name, self.index

    @property
    def demands(self) -> Sequence[str]:
        """Ids of its demands."""
        return [input_.model.id for input_ in self.bound.inputs if input_.model.is_demand]

    @property
    def guarantees(self) -> Sequence[str]:
        """Ids of its guarantees in messages."""
        keys = self.bound.model.element_keys() if self.bound.kind.between_robots else {}
        return [key for of_list in keys.values() for key in of_list]


@dataclass(frozen=True)
class Fulfilment:
    """A guarantee that may fulfil a demand."""

    provider: RobotMonitor
    guarantee: str


@dataclass(frozen=True)
class DemandBinding:
    """A demand, and what may fulfil it."""

    user: RobotMonitor  # whose demand it is
    demand: str  # its id
    fulfilments: tuple[Fulfilment, ...]  # of the robots of the deployment file
    of_any: bool  # whether it may be any robot; else those of the fulfilments
    place: Place  # in the deployment file


def demand_bindings(
    file: FleetFile, monitors: Sequence[RobotMonitor]
) -> tuple[list[DemandBinding], list[Problem]]:
    """Return every bound demand, and what is wrong with the bindings (D004, D011, D013)."""
    bindings: dict[tuple[str, int, str], DemandBinding] = {}
    problems: list[Problem] = []
    number = 0
    for index, binding in enumerate(file.form.Bindings):
        place, demand = partial(file.place, "Bindings", index), binding.demand
        own = [of for of in monitors if binding.robot in (None, of.robot.name)]
        asked = [of for of in own if binding.monitor in (None, of.id)]
        known = {
            "robot": [of.robot.name for of in monitors],
            "from": [of.robot.name for of in monitors],
            "monitor": [of.id for of in own],
            "guarantee": [name for of in monitors for name in of.guarantees],
            "demand": [name for of in asked for name in of.demands],
        }
        if unknown := _unknown(binding, known, place):
            problems += unknown
            continue
        for user in (of for of in asked if demand in of.demands):
            key = (*user.key, demand)
            if key in bindings:
                line, names = bindings[key].place.line, {"demand": demand, "user": user.name}
                problems.append(problem("D011.bound_twice", place("demand"), line=line, **names))
                continue
            fulfilments, reported = _fulfilments(binding, user, monitors, place)
            of_any = binding.from_ == "any"
            bindings[key] = DemandBinding(user, demand, tuple(fulfilments), of_any, place("demand"))
            problems += reported
            number += len(fulfilments)
            if number > _MOST_FULFILMENTS:
                problems.append(problem("D004.too_many", place("from"), limit=_MOST_FULFILMENTS))
                return list(bindings.values()), problems
    return list(bindings.values()), problems


def _unknown(
    binding: Binding, known: Mapping[str, Sequence[str]], place: Callable[[str], Place]
) -> list[Problem]:
    """Report the names of the first key that nothing has (D011)."""
    for key, names in known.items():
        given = binding.from_ if key == "from" else getattr(binding, key)
        given = (given,) if isinstance(given, str) else given or ()
        what = "robot" if key == "from" else key
        similar = SimilarNames(dict.fromkeys(names), f"the {what}s are")
        unknown = [name for name in given if name not in names and (key, name) != ("from", "any")]
        if unknown:
            return [
                problem("D011.unknown", place(key), hint=similar.hint(name), what=what, name=name)
                for name in unknown
            ]
    return []


def _fulfilments(
    binding: Binding,
    user: RobotMonitor,
    monitors: Sequence[RobotMonitor],
    place: Callable[[str], Place],
) -> tuple[list[Fulfilment], list[Problem]]:
    """Return what fulfils a demand, and which robots do not (D004), or are not heard (D013).

    Of a binding to any robot, it is enough that one does.
    """
    robot, platform = user.robot, user.robot.platform.name
    if robot.graph is None:
        at = place("demand")
        return [], [problem("D013.alone", at, robot=robot.name, platform=platform)]
    offers: dict[FleetRobot, list[Fulfilment]] = {}
    for monitor in (of for of in monitors if of.robot is not robot):
        ids = monitor.guarantees if monitor.bound.kind is user.bound.kind else ()
        own = [Fulfilment(monitor, id_) for id_ in ids if binding.guarantee in (None, id_)]
        offers.setdefault(monitor.robot, []).extend(own)
    problems: list[Problem] = []
    groups = {"any robot that it hears": [of for of in offers if of.graph == robot.graph]}
    if binding.from_ != "any":
        named = [of for of in offers if of.name in binding.from_]
        groups = {of.name: [of] for of in named if of.graph == robot.graph}
        for other in (of for of in named if of.name not in groups):
            names = {"robot": robot.name, "other": other.name}
            where = {"here": robot.where, "there": other.where}
            problems.append(problem("D013.unheard", place("from"), **names, **where))
        if not named:
            problems.append(problem("D011.own_demand", place("from"), name=robot.name))
    fulfilments: list[Fulfilment] = []
    for who, others in groups.items():
        reasons: dict[str, None] = {}
        before = len(fulfilments)
        for of in (of for other in others for of in offers[other]):
            model = of.provider.bound.model
            why = model.why_not_fulfilled(of.guarantee, user.bound.model, binding.demand)
            if why is None:
                fulfilments.append(of)
            else:
                reasons[why] = None
        if len(fulfilments) == before:
            shown = "; ".join([*reasons][:_MOST_REASONS]) or "there is no other ConSert"
            names = {"who": who, "demand": binding.demand, "user": user.name}
            at = place("demand" if binding.from_ == "any" else "from")
            problems.append(problem("D004.never", at, shown=shown, **names))
    return fulfilments, problems
