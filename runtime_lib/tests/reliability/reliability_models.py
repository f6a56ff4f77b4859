"""Reliability monitors for tests; the last model is the top."""

from __future__ import annotations

from dataclasses import replace
from types import ModuleType
from typing import Any, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple

from eddi_runtime.reliability import Reliability

from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds.reliability.chains import STATES_WRITTEN_OUT
from eddi_scaffold.kinds.reliability.compile import NODES_WRITTEN_OUT, compile_system
from eddi_scaffold.kinds.reliability.fault_tree import Gate
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    Arc,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Law,
    Observation,
    ReliabilitySystem,
    Threshold,
)
from eddi_scaffold.kinds.reliability.system import Gate as GateOfTree
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from runtime_lib.tests.bound_models import loaded, text_of

NS = 1_000_000_000


class Model(NamedTuple):
    system: ReliabilitySystem
    declaration: Declaration

    def compiled(
        self, states: int = STATES_WRITTEN_OUT, nodes: int = NODES_WRITTEN_OUT
    ) -> CompiledMonitor:
        return compile_system(self.system, self.declaration, states=states, nodes=nodes)

    def text(self) -> str:
        return text_of("reliability", self.compiled(), self.declaration)

    def monitor(self) -> Reliability:
        made: Reliability = loaded("reliability", self.compiled(), self.declaration).Monitor()
        return made


def monitor(
    parts: Sequence[ComponentModel], inputs: Iterable[str] = (), **options: Any
) -> Reliability:
    return model(parts, inputs, **options).monitor()


def compiled(
    parts: Sequence[ComponentModel],
    inputs: Iterable[str] = (),
    states: int = 0,
    nodes: int = 0,
    **options: Any,
) -> ModuleType:
    """Compile a module with nothing, or less, written out."""
    made = model(parts, inputs, **options)
    return loaded("reliability", made.compiled(states, nodes), made.declaration)


def model(
    parts: Sequence[ComponentModel],
    inputs: Iterable[str] = (),
    factors: Optional[Dict[str, Tuple[int, int]]] = None,
    thresholds: Sequence[Dict[str, Any]] = (),
    on_unknown: str = "inactive",
    **options: Any,
) -> Model:
    system = ReliabilitySystem(
        {part.name: part for part in parts},
        parts[-1].name,
        thresholds=tuple(Threshold(**one) for one in thresholds),
        worst_case=on_unknown == "worst_case",
        **{"max_gap": 1.0, **options},
    )
    bound = (BoundInput(name, name, factor=(factors or {}).get(name)) for name in inputs)
    return Model(system, Declaration("drone", "", tuple(bound)))


def but(part: ComponentModel, **values: Any) -> ComponentModel:
    """Return a ready-made model with other numbers."""
    return replace(part, values={**part.values, **values})


def chain(
    arcs: Iterable[Iterable[float]],
    states: int,
    fail: Sequence[int],
    observe: Iterable[Iterable[Any]] = (),
    age: float = 0.0,
    *,
    repair: bool = False,
) -> ComponentModel:
    """Return a Markov chain that begins in state 0; ``observe``: (state, input, negated)."""
    names = tuple(f"s{i}" for i in range(states))
    rates = tuple(Arc(names[int(a)], names[int(b)], float(rate)) for a, b, rate in arcs)
    seen = tuple(Observation(names[state], *more) for state, *more in observe)
    content = Chain(names, names[:1], tuple(names[i] for i in fail), rates, seen, age, repair)
    return ComponentModel("chain", "markov", content)


def rotors(configuration: str, rate: float, *, repair: bool = False) -> ComponentModel:
    """Return rotors with inputs rotors_motor_0, rotors_motor_1 and so on."""
    count = len(configuration)
    values = {"configuration": configuration, "rates": [rate] * count, "repair": repair}
    values |= {"positions": [*range(count)], "status": "single"}
    return ComponentModel("rotors", "propulsion", values=values)


def quad(rate: float, *, repair: bool = False) -> ComponentModel:
    return rotors("PNPN", rate, repair=repair)


def heat(energy: float, reference: float, hottest: float) -> Dict[str, float]:
    return {"activation_energy": energy, "t_ref": reference, "t_max": hottest}


def battery(rate: float, **more: float) -> ComponentModel:
    """Return a battery with the input battery_level, and with heat battery_temperature."""
    values = {"failure_rate": rate, "alpha": 8e-3, "beta": 7e-3, "degradation": 6.4e-3}
    return ComponentModel("battery", "battery", values={"repair": False, **values, **more})


def processor(life: float, shape: float, u_max: float, **more: float) -> ComponentModel:
    """Return a processor with the inputs cpu_temperature and cpu_utilisation."""
    values = {"mttf_ref": life, "shape": shape, "u_max": u_max, **more}
    return ComponentModel("cpu", "processor", values=values)


def units(k: int, rate: float, most: int) -> ComponentModel:
    """Return equal units with the input units_available."""
    return ComponentModel("units", "k_out_of_n", values={"k": k, "rate": rate, "max": most})


def series(*parts: str) -> ComponentModel:
    return ComponentModel("all", "series", uses=parts)


class Event(NamedTuple):
    """An event, or a dynamic gate over events with these rates."""

    name: str
    law: str
    values: Tuple[float, ...]
    model: str = ""
    input: Optional[str] = None  # of tree_INPUT, which reports it
    age: float = 0.0
    place: str = ""


def event(law: str, *values: float, name: str = "", **more: Any) -> Event:
    return Event(name or law, law, values, **more)


def tree(
    events: Sequence[Event], gates: Sequence[Gate], names: Sequence[Tuple[str, str]] = ()
) -> ComponentModel:
    """Return a fault tree; the last gate is the top. ``names``: (name, path) of gates."""
    keys = [one.input or f"e{i}" for i, one in enumerate(events)]
    keys += [f"g{i}" for i in range(len(gates))]
    of: Dict[str, BasicEvent] = {}
    inner: Dict[str, GateOfTree] = {}
    for key, one in zip(keys, events):
        if one.law in DYNAMIC:
            below = tuple(f"{key}_{i}" for i in range(len(one.values)))
            inner[key] = GateOfTree(one.name, one.law, below)
            of.update(
                {k: BasicEvent(k, Law("exponential", (v,))) for k, v in zip(below, one.values)}
            )
        else:
            law, place = Law(one.law, one.values, one.model), Place("", path=one.place or None)
            of[key] = BasicEvent(one.name, law, one.input is not None, one.age, place)
    shown = tuple(names) or (("", ""),) * len(gates)
    for key, (kind, below, k), (name, path) in zip(keys[len(events) :], gates, shown):
        parts = tuple(keys[i] for i in below)
        inner[key] = GateOfTree(name, kind, parts, k, Place("", path=path or None))
    return ComponentModel("tree", "fault_tree", FaultTree(keys[-1], of, inner))
