"""Reliability monitors for tests, made of plain data."""

from __future__ import annotations

from types import ModuleType
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

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
    Component,
    Event,
    FaultTree,
    Heat,
    KOutOfN,
    LoweredSystem,
    Markov,
    Named,
    Processor,
    Propulsion,
    Series,
    connected,
)
from eddi_scaffold.kinds.reliability.system import ReliabilitySystem, Threshold
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from runtime_lib.tests.bound_models import loaded, text_of

NS = 1_000_000_000


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


def monitor(
    components: Sequence[Dict[str, Any]], inputs: Iterable[str] = (), **options: Any
) -> Reliability:
    return model(components, inputs, **options).monitor()


def compiled(
    components: Sequence[Dict[str, Any]],
    inputs: Iterable[str] = (),
    states: int = 0,
    nodes: int = 0,
    **options: Any,
) -> ModuleType:
    """Compile a module with nothing, or less, written out."""
    made = model(components, inputs, **options)
    return loaded("reliability", made.compiled(states, nodes), made.declaration)


def model(
    components: Sequence[Dict[str, Any]],
    inputs: Iterable[str] = (),
    factors: Optional[Dict[str, Tuple[int, int]]] = None,
    thresholds: Sequence[Dict[str, Any]] = (),
    on_unknown: str = "inactive",
    **options: Any,
) -> Model:
    """Return a model; the last component is the top."""
    system = ReliabilitySystem(
        {},
        components[-1]["name"],
        thresholds=tuple(Threshold(**one) for one in thresholds),
        worst_case=on_unknown == "worst_case",
        **{"max_gap": 1.0, **options},
    )
    bound = (BoundInput(name, name, factor=(factors or {}).get(name)) for name in inputs)
    lowered = connected(
        {item["name"]: _component(item) for item in components},
        {item["name"]: item.get("place", "") for item in components},
        mission_end=system.mission_end,
    )
    return Model(lowered, system, Declaration("drone", "", tuple(bound)))


def _component(item: Dict[str, Any]) -> Component:
    kind, repair, age = item["type"], item.get("repair", False), item.get("age", 0.0)
    if kind == "markov":
        arcs = tuple((a, b, float(rate)) for a, b, rate in item["arcs"])
        chain_ = Chain(tuple(item["states"]), item["initial"], tuple(item["fail"]), arcs, age)
        return Markov(chain_, tuple(tuple(one) for one in item["observe"]), repair)
    if kind == "propulsion":
        sets = tuple(tuple(sorted(failed)) for failed in survived(item["configuration"]))
        inputs = tuple(tuple(one) for one in item["inputs"])
        return Propulsion(rotors_chain(item["configuration"], item["rates"]), sets, inputs, repair)
    heat = None
    if item.get("temperature"):
        keys = ("temperature", "activation_energy", "t_ref", "t_max")
        heat = Heat(*(item[key] for key in keys))
    if kind == "battery":
        keys = ("failure_rate", "alpha", "beta", "degradation")
        return Battery(battery_chain(*(item[key] for key in keys)), item["level"], heat, repair)
    if kind == "processor":
        assert heat is not None
        load = (item["utilisation"], item["u_max"]) if item["utilisation"] else None
        return Processor(item["mttf_ref"], item["shape"], heat, load, age)
    if kind == "k_out_of_n":
        return KOutOfN(item["k"], item["rate"], item.get("max"), item["available"])
    if kind == "series":
        return Series(tuple(item["of"]))
    gates, events = item["gates"], tuple(Event(**one) for one in item["events"])
    return FaultTree(
        events,
        tuple(Gate(one["type"], tuple(one["of"]), one.get("k", 0)) for one in gates),
        tuple(Named(one.get("name", ""), one.get("place", "")) for one in gates),
        item["top"],
        repair,
    )


def chain(arcs: List[List[float]], states: int, fail: List[int], **more: Any) -> Dict[str, Any]:
    """Return a Markov chain that begins in state 0."""
    names = [f"s{i}" for i in range(states)]
    base: Dict[str, Any] = {"name": "chain", "type": "markov", "states": names, "initial": 0}
    return {**base, "fail": fail, "arcs": arcs, "observe": [], **more}


def quad(rate: float, **more: Any) -> Dict[str, Any]:
    """Return four rotors with inputs m0 to m3."""
    inputs = [[f"m{i}", None] for i in range(4)]
    base = {"name": "rotors", "type": "propulsion", "configuration": "PNPN", "repair": False}
    return {**base, "rates": [rate] * 4, "inputs": inputs, **more}


def tree(events: List[Dict[str, Any]], gates: List[Dict[str, Any]], **more: Any) -> Dict[str, Any]:
    top = len(events) + len(gates) - 1
    base = {"name": "tree", "type": "fault_tree", "repair": False, "top": top}
    return {**base, "events": events, "gates": gates, **more}


def event(law: str, *values: float, **more: Any) -> Dict[str, Any]:
    return {"name": law, "law": law, "values": values, **more}
