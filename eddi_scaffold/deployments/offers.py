"""Which guarantees of which robots may fulfil a demand, as the deployment file says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.config.deployment_file import Binding, FleetFile
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.monitors.binding import BoundMonitor

BINDINGS = "Bindings"
_MOST_REASONS = 3
_MOST_OFFERS = 2_500
"""Each is checked, and most are written down: 50 robots of which each relies on any other one."""
_COMPOSE = "`eddi-scaffold compose` shows which guarantees would"


@dataclass(frozen=True, eq=False)
class RobotMonitor:
    """A monitor on its robot.

    Attributes:
        robot: where it runs.
        index: of the monitor among those of the robot.
        monitor: its model and configuration, as they are without other robots.
    """

    robot: FleetRobot
    index: int
    monitor: BoundMonitor

    @property
    def config(self) -> ConfigFile:
        """Its configuration, as it is without other robots."""
        assert self.monitor.config is not None
        return self.monitor.config

    @property
    def id(self) -> str:
        """``Model: id:`` of its configuration."""
        return self.config.config.Model.id

    @property
    def name(self) -> str:
        """Robot and monitor, for people."""
        return f"{self.robot.name}/{self.id}"

    @property
    def frequency(self) -> float:
        """Steps per second."""
        return self.config.config.Model.frequency

    @property
    def demands(self) -> Sequence[str]:
        """Ids of its demands."""
        return [input_.model.id for input_ in self.monitor.inputs if input_.model.is_demand]

    @property
    def guarantees(self) -> Sequence[str]:
        """Ids of its guarantees in messages."""
        if not self.monitor.kind.between_robots:
            return []
        ids = self.monitor.model.element_keys()
        return [key for keys in ids.values() for key in keys]


@dataclass(frozen=True)
class Fulfilment:
    """A guarantee that may fulfil a demand."""

    seat: RobotMonitor
    guarantee: str


@dataclass(frozen=True)
class DemandBinding:
    """A demand, and what may fulfil it.

    Attributes:
        user: whose demand it is.
        demand: its id.
        offers: of the robots of the deployment file.
        of_any: whether it may be any robot; else those of the offers.
        place: in the deployment file.
    """

    user: RobotMonitor
    demand: str
    offers: tuple[Fulfilment, ...]
    of_any: bool
    place: Place


def bonds_of(
    file: FleetFile, seats: Sequence[RobotMonitor]
) -> tuple[list[DemandBinding], list[Problem]]:
    """Return every bound demand, and what is wrong with the bindings (D004, D011, D013)."""
    binder = _Binder(file, seats)
    for index, binding in enumerate(file.form.Bindings):
        if not binder.add(index, binding):
            break
    return list(binder.bonds.values()), binder.problems


@dataclass
class _Binder:
    file: FleetFile
    seats: Sequence[RobotMonitor]
    bonds: dict[tuple[str, int, str], DemandBinding] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    offers: int = 0

    def __post_init__(self) -> None:
        """Note which monitors each robot has."""
        self._of: dict[FleetRobot, list[RobotMonitor]] = {}
        for seat in self.seats:
            self._of.setdefault(seat.robot, []).append(seat)

    def add(self, index: int, binding: Binding) -> bool:
        """Bind a demand of one robot, or of all that have it; return whether there may be more."""
        unknown = list(self._unknown(index, binding))
        if unknown:
            self.problems += unknown
            return True
        users = [asker for asker in self._askers(binding) if binding.demand in asker.demands]
        if not users:
            known = list(dict.fromkeys(d for asker in self._askers(binding) for d in asker.demands))
            of = binding.robot or "any robot"
            hint = SimilarNames(known, "the demands are").hint(binding.demand)
            self.problems.append(
                problem(
                    "D011.no_demand",
                    self._place(index, "demand"),
                    hint=hint,
                    demand=binding.demand,
                    type=of,
                )
            )
        for user in users:
            self._bind(index, binding, user)
            if self.offers > _MOST_OFFERS:
                self.problems.append(
                    problem("D004.too_many", self._place(index, "from"), limit=_MOST_OFFERS)
                )
                return False
        return True

    def _bind(self, index: int, binding: Binding, user: RobotMonitor) -> None:
        place = self._place(index, "demand")
        key = (user.robot.name, user.index, binding.demand)
        if key in self.bonds:
            line = self.bonds[key].place.line
            self.problems.append(
                problem("D011.bound_twice", place, demand=binding.demand, user=user.name, line=line)
            )
            return
        offers: list[Fulfilment] = []
        reasons: dict[str, None] = {}
        for robot in self._providers(index, binding, user):
            found, misses = _offers(user, binding, self._of[robot])
            reasons.update(dict.fromkeys(misses))
            offers += found
            if not found and binding.from_ != "any":
                self._refuse(index, binding, user, robot.name, misses)
        if not offers and binding.from_ == "any" and user.robot.graph is not None:
            self._refuse(index, binding, user, "any robot that it hears", list(reasons))
        of_any = binding.from_ == "any"
        self.bonds[key] = DemandBinding(user, binding.demand, tuple(offers), of_any, place)
        self.offers += len(offers)

    def _providers(self, index: int, binding: Binding, user: RobotMonitor) -> Iterator[FleetRobot]:
        """Yield the robots that may fulfil a demand and are heard by the one that has it (D013)."""
        names = binding.from_
        if user.robot.graph is None:
            self.problems.append(
                problem(
                    "D013.alone",
                    self._place(index, "demand"),
                    robot=user.robot.name,
                    platform=user.robot.platform.name,
                )
            )
            return
        for robot in self._of:
            if robot is user.robot or (names != "any" and robot.name not in names):
                continue
            if robot.graph == user.robot.graph:
                yield robot
            elif names != "any":
                self.problems.append(
                    problem(
                        "D013.unheard",
                        self._place(index, "from"),
                        robot=user.robot.name,
                        other=robot.name,
                        reason=_apart(user.robot, robot),
                    )
                )

    def _refuse(
        self, index: int, binding: Binding, user: RobotMonitor, who: str, reasons: Sequence[str]
    ) -> None:
        shown = "; ".join(reasons[:_MOST_REASONS]) or "there is no other ConSert"
        key = "demand" if binding.from_ == "any" else "from"
        hint = _COMPOSE if reasons else None
        self.problems.append(
            problem(
                "D004.never",
                self._place(index, key),
                hint=hint,
                who=who,
                demand=binding.demand,
                user=user.name,
                shown=shown,
            )
        )

    def _unknown(self, index: int, binding: Binding) -> Iterator[Problem]:
        """Report names that nothing has (D011)."""
        robots = list(dict.fromkeys(seat.robot.name for seat in self.seats))
        near = SimilarNames(robots, "the robots are")
        if binding.robot is not None and binding.robot not in robots:
            yield problem(
                "D011.no_robot",
                self._place(index, "robot"),
                hint=near.hint(binding.robot),
                robot=binding.robot,
            )
            return
        for name in binding.from_ if binding.from_ != "any" else ():
            if name not in robots:
                yield problem(
                    "D011.no_robot", self._place(index, "from"), hint=near.hint(name), robot=name
                )
            elif name == binding.robot:
                yield problem("D011.own_demand", self._place(index, "from"), name=name)
        monitors = [seat.id for seat in self.seats if binding.robot in (None, seat.robot.name)]
        if binding.monitor is not None and binding.monitor not in monitors:
            place, near = self._place(index, "monitor"), SimilarNames(monitors, "the monitors are")
            hint = near.hint(binding.monitor)
            yield problem("D011.no_monitor", place, hint=hint, monitor=binding.monitor)
        known = [name for seat in self.seats for name in seat.guarantees]
        if binding.guarantee is not None and binding.guarantee not in known:
            place, near = self._place(index, "guarantee"), SimilarNames(known, "the guarantees are")
            hint = near.hint(binding.guarantee)
            yield problem("D011.no_guarantee", place, hint=hint, guarantee=binding.guarantee)

    def _askers(self, binding: Binding) -> list[RobotMonitor]:
        return [
            seat
            for seat in self.seats
            if binding.robot in (None, seat.robot.name) and binding.monitor in (None, seat.id)
        ]

    def _place(self, index: int, key: str) -> Place:
        return self.file.place(BINDINGS, index, key)


def _offers(
    user: RobotMonitor, binding: Binding, seats: Sequence[RobotMonitor]
) -> tuple[list[Fulfilment], list[str]]:
    """Return the guarantees of a robot that fulfil a demand, and why others do not."""
    offers: list[Fulfilment] = []
    misses: list[str] = []
    for seat in seats:
        provider = seat.monitor.model
        if seat.monitor.kind is not user.monitor.kind:
            continue
        for name in seat.guarantees:
            if binding.guarantee in (None, name):
                why = provider.why_not_fulfilled(name, user.monitor.model, binding.demand)
                if why is None:
                    offers.append(Fulfilment(seat, name))
                else:
                    misses.append(why)
    return offers, misses


def _apart(one: FleetRobot, other: FleetRobot) -> str:
    here, there = one.graph, other.graph
    if here is None or there is None or here.key != there.key:
        return f"one runs on {one.platform.name}, the other on {other.platform.name}"
    if here.name != there.name:
        return f"they have different {here.key}s, {_shown(here.name)} and {_shown(there.name)}"
    parts = f"{_shown(here.partition)} and {_shown(there.partition)}"
    return f"they have different partitions, {parts}"


def _shown(name: str) -> str:
    return name or "the default one"
