"""Reliability monitors for tests, made of models as they are lowered; the last one is the top."""

from __future__ import annotations

from types import ModuleType
from typing import Any, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple

from eddi_runtime.reliability import Reliability

from eddi_scaffold.kinds.reliability.chains import (
    STATES_WRITTEN_OUT,
    Chain,
    battery_chain,
    rotors_chain,
    survived,
)
from eddi_scaffold.kinds.reliability.compile import NODES_WRITTEN_OUT, compile_system
from eddi_scaffold.kinds.reliability.fault_tree import Gate
from eddi_scaffold.kinds.reliability.lowering import (
    Battery,
    Event,
    FaultTree,
    Heat,
    LoweredSystem,
    Markov,
    Named,
    Propulsion,
    connected,
)
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem, Threshold
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from runtime_lib.tests.bound_models import loaded, text_of

NS = 1_000_000_000


class Part(NamedTuple):
    """One model, its name, and the path of its element in an EDDI."""

    name: str
    content: Any
    place: str = ""

    def but(self, **changed: Any) -> Part:
        return self._replace(content=self.content._replace(**changed))


class Model(NamedTuple):
    lowered: LoweredSystem
    system: ReliabilitySystem
    declaration: Declaration

    def compiled(
        self, states: int = STATES_WRITTEN_OUT, nodes: int = NODES_WRITTEN_OUT
    ) -> CompiledMonitor:
        return compile_system(
            self.system, self.declaration, self.lowered, states=states, nodes=nodes
        )

    def text(self) -> str:
        return text_of("reliability", self.compiled(), self.declaration)

    def monitor(self) -> Reliability:
        made: Reliability = loaded("reliability", self.compiled(), self.declaration).Monitor()
        return made


def monitor(parts: Sequence[Part], inputs: Iterable[str] = (), **options: Any) -> Reliability:
    return model(parts, inputs, **options).monitor()


def compiled(
    parts: Sequence[Part],
    inputs: Iterable[str] = (),
    states: int = 0,
    nodes: int = 0,
    **options: Any,
) -> ModuleType:
    """Compile a module with nothing, or less, written out."""
    made = model(parts, inputs, **options)
    return loaded("reliability", made.compiled(states, nodes), made.declaration)


def model(
    parts: Sequence[Part],
    inputs: Iterable[str] = (),
    factors: Optional[Dict[str, Tuple[int, int]]] = None,
    thresholds: Sequence[Dict[str, Any]] = (),
    on_unknown: str = "inactive",
    **options: Any,
) -> Model:
    system = ReliabilitySystem(
        {},
        parts[-1].name,
        thresholds=tuple(Threshold(**one) for one in thresholds),
        worst_case=on_unknown == "worst_case",
        **{"max_gap": 1.0, **options},
    )
    bound = (BoundInput(name, name, factor=(factors or {}).get(name)) for name in inputs)
    contents = {part.name: part.content for part in parts}
    places = {part.name: part.place for part in parts}
    lowered = connected(contents, places, mission_end=system.mission_end)
    return Model(lowered, system, Declaration("drone", "", tuple(bound)))


def chain(
    arcs: Iterable[Iterable[float]],
    states: int,
    fail: Sequence[int],
    observe: Iterable[Iterable[Any]] = (),
    age: float = 0.0,
    *,
    repair: bool = False,
) -> Part:
    """Return a Markov chain that begins in state 0; ``observe``: (state, input, negated)."""
    names = tuple(f"s{i}" for i in range(states))
    rates = tuple((a, b, float(rate)) for a, b, rate in arcs)
    of = Chain(names, 0, tuple(fail), rates, age)
    return Part("chain", Markov(of, tuple(map(tuple, observe)), repair))


def rotors(configuration: str, rate: float, *, repair: bool = False) -> Part:
    """Return rotors with inputs m0, m1 and so on."""
    count = len(configuration)
    sets = tuple(tuple(sorted(failed)) for failed in survived(configuration))
    inputs = tuple((f"m{i}", None) for i in range(count))
    of = rotors_chain(configuration, [rate] * count)
    return Part("rotors", Propulsion(of, sets, inputs, repair))


def quad(rate: float, *, repair: bool = False) -> Part:
    return rotors("PNPN", rate, repair=repair)


def battery(rate: float, heat: Optional[Heat] = None) -> Part:
    """Return a battery with the input `level`."""
    return Part("battery", Battery(battery_chain(rate, 8e-3, 7e-3, 6.4e-3), "level", heat, False))


def tree(events: Sequence[Event], gates: Sequence[Gate], names: Sequence[Named] = ()) -> Part:
    """Return a fault tree; the last gate is the top."""
    shown = tuple(names) or (Named("", ""),) * len(gates)
    top = len(events) + len(gates) - 1
    return Part("tree", FaultTree(tuple(events), tuple(gates), shown, top))


def event(law: str, *values: float, name: str = "", **more: Any) -> Event:
    return Event(name or law, law, values, **more)
