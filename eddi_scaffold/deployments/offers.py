"""Which guarantees of which robots may fulfil a demand, as the deployment file says."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.config.deployment_file import Binding, FleetFile
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.monitors.binding import BoundMonitor

BINDINGS = "Bindings"
_MOST_REASONS = 3
_MOST_FULFILMENTS = 2_500
"""Each is checked, and most are written down: 50 robots of which each relies on any other one."""
_COMPOSE = "`eddi-scaffold compose` shows which guarantees would"


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
    def frequency(self) -> float:
        """Steps per second."""
        return self.config.config.Model.frequency

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
    binder = _Binder(file, monitors)
    entries = range(len(file.form.Bindings))
    problems = [reported for index in entries for reported in binder.bind(index)]
    return list(binder.bindings.values()), problems


class _Binder:
    """Binds demands, entry by entry of the deployment file."""

    def __init__(self, file: FleetFile, monitors: Sequence[RobotMonitor]) -> None:
        self.file, self.monitors = file, monitors
        self.bindings: dict[tuple[str, int, str], DemandBinding] = {}
        self.robots: dict[FleetRobot, list[RobotMonitor]] = {}
        for monitor in monitors:
            self.robots.setdefault(monitor.robot, []).append(monitor)
        self.fulfilments = 0

    def bind(self, index: int) -> Iterator[Problem]:
        """Bind a demand of one robot, or of all that have it; yield what is wrong with that."""
        if self.fulfilments > _MOST_FULFILMENTS:
            return
        binding, place = self.file.form.Bindings[index], partial(self.file.place, BINDINGS, index)
        if unknown := list(self._unknown(binding, place)):
            yield from unknown
            return
        demand = binding.demand
        asked = [
            monitor
            for monitor in self.monitors
            if binding.robot in (None, monitor.robot.name) and binding.monitor in (None, monitor.id)
        ]
        users = [monitor for monitor in asked if demand in monitor.demands]
        if not users:
            known = list(dict.fromkeys(name for monitor in asked for name in monitor.demands))
            hint = SimilarNames(known, "the demands are").hint(demand)
            names = {"demand": demand, "type": binding.robot or "any robot"}
            yield problem("D011.no_demand", place("demand"), hint=hint, **names)
        for user in users:
            key = (*user.key, demand)
            if key in self.bindings:
                line, names = self.bindings[key].place.line, {"demand": demand, "user": user.name}
                yield problem("D011.bound_twice", place("demand"), line=line, **names)
                continue
            fulfilments = tuple((yield from self._fulfilments(binding, user, place)))
            of_any = binding.from_ == "any"
            self.bindings[key] = DemandBinding(user, demand, fulfilments, of_any, place("demand"))
            self.fulfilments += len(fulfilments)
            if self.fulfilments > _MOST_FULFILMENTS:
                yield problem("D004.too_many", place("from"), limit=_MOST_FULFILMENTS)
                return

    def _fulfilments(
        self, binding: Binding, user: RobotMonitor, place: Callable[[str], Place]
    ) -> Generator[Problem, None, list[Fulfilment]]:
        """Return what fulfils a demand; yield which robots do not (D004), or are not heard (D013).

        Of a binding to any robot, it is enough that one does.
        """
        robot, of_any = user.robot, binding.from_ == "any"
        if robot.graph is None:
            platform = robot.platform.name
            yield problem("D013.alone", place("demand"), robot=robot.name, platform=platform)
            return []
        fulfilments: list[Fulfilment] = []
        all_reasons: dict[str, None] = {}

        def never(who: str, reasons: Sequence[str]) -> Problem:
            shown = "; ".join(reasons[:_MOST_REASONS]) or "there is no other ConSert"
            names = {"who": who, "demand": binding.demand, "user": user.name}
            at, hint = place("demand" if of_any else "from"), _COMPOSE if reasons else None
            return problem("D004.never", at, hint=hint, shown=shown, **names)

        for other, monitors in self.robots.items():
            if other is robot or (not of_any and other.name not in binding.from_):
                continue
            if other.graph != robot.graph:
                if not of_any:
                    names = {"robot": robot.name, "other": other.name}
                    reason = _apart(robot, other)
                    yield problem("D013.unheard", place("from"), reason=reason, **names)
                continue
            own: list[Fulfilment] = []
            reasons: list[str] = []
            for monitor in monitors:
                if monitor.bound.kind is not user.bound.kind:
                    continue
                for name in monitor.guarantees:
                    if binding.guarantee not in (None, name):
                        continue
                    model, demand = monitor.bound.model, binding.demand
                    why = model.why_not_fulfilled(name, user.bound.model, demand)
                    own += [Fulfilment(monitor, name)] if why is None else []
                    reasons += [why] if why is not None else []
            all_reasons |= dict.fromkeys(reasons)
            fulfilments += own
            if not own and not of_any:
                yield never(other.name, reasons)
        if not fulfilments and of_any:
            yield never("any robot that it hears", list(all_reasons))
        return fulfilments

    def _unknown(self, binding: Binding, place: Callable[[str], Place]) -> Iterator[Problem]:
        """Report names that nothing has (D011)."""
        robots = list(dict.fromkeys(robot.name for robot in self.robots))
        similar = SimilarNames(robots, "the robots are")
        if binding.robot is not None and binding.robot not in robots:
            hint = similar.hint(binding.robot)
            yield problem("D011.no_robot", place("robot"), hint=hint, robot=binding.robot)
            return
        for name in binding.from_ if binding.from_ != "any" else ():
            if name not in robots:
                yield problem("D011.no_robot", place("from"), hint=similar.hint(name), robot=name)
            elif name == binding.robot:
                yield problem("D011.own_demand", place("from"), name=name)
        monitors = [
            monitor.id for monitor in self.monitors if binding.robot in (None, monitor.robot.name)
        ]
        guarantees = [name for monitor in self.monitors for name in monitor.guarantees]
        monitor, guarantee = binding.monitor, binding.guarantee
        if monitor is not None and monitor not in monitors:
            hint = SimilarNames(monitors, "the monitors are").hint(monitor)
            yield problem("D011.no_monitor", place("monitor"), hint=hint, monitor=monitor)
        if guarantee is not None and guarantee not in guarantees:
            hint = SimilarNames(guarantees, "the guarantees are").hint(guarantee)
            yield problem("D011.no_guarantee", place("guarantee"), hint=hint, guarantee=guarantee)


def _apart(robot: FleetRobot, other: FleetRobot) -> str:
    here, there = robot.graph, other.graph
    if here is None or there is None or here.key != there.key:
        return f"one runs on {robot.platform.name}, the other on {other.platform.name}"
    what, names = f"{here.key}s", (here.name, there.name)
    if here.name == there.name:
        what, names = "partitions", (here.partition, there.partition)
    shown = " and ".join(name or "the default one" for name in names)
    return f"they have different {what}, {shown}"
