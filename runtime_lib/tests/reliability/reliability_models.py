"""Reliability monitors for tests, made of plain data."""

from __future__ import annotations

from types import ModuleType
from typing import Any, Dict, Iterable, List, Optional, Sequence

from eddi_runtime.reliability import Reliability

from eddi_scaffold.compiling.compilation import module_text
from eddi_scaffold.compiling.document import ModelFile, check_document, digest_of
from eddi_scaffold.compiling.execution import build, module_of
from eddi_scaffold.compiling.reliability.emission import FORMAT, lines_of

NS = 1_000_000_000


def monitor(
    components: Sequence[Dict[str, Any]], inputs: Iterable[str] = (), **model: Any
) -> Reliability:
    """Compile a monitor; the last component is the top."""
    made: Reliability = build(model_file(components, inputs, **model))
    return made


def compiled(
    components: Sequence[Dict[str, Any]],
    inputs: Iterable[str] = (),
    states: int = 0,
    nodes: int = 0,
    **model: Any,
) -> ModuleType:
    """Compile a module with nothing, or less, written out."""
    made = model_file(components, inputs, **model)
    lines = lines_of(made, states=states, nodes=nodes)
    return module_of(module_text(made, {"reliability": FORMAT}, lines), made.id)


def model_file(
    components: Sequence[Dict[str, Any]],
    inputs: Iterable[str] = (),
    factors: Optional[Dict[str, List[int]]] = None,
    **model: Any,
) -> ModelFile:
    """Return the document of a monitor; the last component is the top."""
    content: Dict[str, Any] = {
        "format": 1,
        "kind": "reliability",
        "id": "drone",
        "source": {},
        "inputs": [
            {"id": name, "attribute": name, "requires": [], "factor": (factors or {}).get(name)}
            for name in inputs
        ],
        "model": {
            "components": list(components),
            "top": components[-1]["name"],
            "horizon": 1.0,
            "mission_end": False,
            "quantum": 0.1,
            "thresholds": [],
            "on_unknown": "inactive",
            "max_gap": 1.0,
            **model,
        },
        "settings": {},
    }
    content["sha256"] = digest_of(content)
    return check_document(content)


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
    """Return a fault tree whose last gate is the top."""
    top = len(events) + len(gates) - 1
    base = {"name": "tree", "type": "fault_tree", "repair": False, "top": top}
    return {**base, "events": events, "gates": gates, **more}


def event(law: str, *values: float, **more: Any) -> Dict[str, Any]:
    """Return a basic event."""
    return {"name": law, "law": law, "values": list(values), "model": "", "input": None, **more}
