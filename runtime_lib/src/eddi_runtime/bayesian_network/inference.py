"""Posteriors by name, for outputs and evidence that may grow over time."""

from __future__ import annotations

from typing import Dict, Iterable, List, Mapping, Sequence, Tuple, Union

from .engine import Engine
from .evidence import EvidenceError, InconsistentEvidenceError, finding
from .model import Network

Evidence = Union[None, str, Sequence[float]]
"""Of one node: nothing, the name of a state, or one likelihood per state."""


class Inference:
    """A network, compiled for what has been asked of it so far.

    Attributes:
        network: the network.
        engine: compiled for the present outputs and observable nodes.
    """

    def __init__(self, network: Network, outputs: Iterable[int], observable: Iterable[int]) -> None:
        """Compile; raises as ``Engine`` does."""
        self.network = network
        self.engine = Engine(network, tuple(outputs), tuple(observable))
        self._numbers = {name: node for node, name in enumerate(network.shape.names)}

    def covers(self, outputs: Iterable[int], observable: Iterable[int]) -> bool:
        """Return whether these outputs and observable nodes were foreseen."""
        engine = self.engine
        return set(outputs) <= set(engine.outputs) and set(observable) <= set(engine.observable)

    def grow(self, outputs: Iterable[int], observable: Iterable[int]) -> None:
        """Compile again, for more outputs and observable nodes.

        Raises:
            TooWideError: that is too much; what was compiled before stays.
        """
        if not self.covers(outputs, observable):
            known = self.engine
            self.engine = Engine(
                self.network, {*known.outputs, *outputs}, {*known.observable, *observable}
            )

    def posteriors(self, evidence: Mapping[str, Evidence]) -> Dict[str, Tuple[float, ...]]:
        """Return the posterior of each output, in the order of its states.

        Args:
            evidence: node -> what is known; nodes may be left out.

        Raises:
            EvidenceError: an unknown node or state, or numbers that are no likelihoods.
            InconsistentEvidenceError: the evidence has probability zero.
            TooWideError: a node was not foreseen as observable, and with it the network is too
                wide.
        """
        found: Dict[int, Union[int, List[float]]] = {}
        for name, value in evidence.items():
            judged = self._judged(name, value)
            if judged is not None:
                found[self._numbers[name]] = judged
        self.grow((), found)
        engine = self.engine
        states, weights = list(engine.missing), {}
        for position, node in enumerate(engine.observable):
            one = found.get(node)
            if isinstance(one, int):
                states[position] = one
            elif one is not None:
                weights[position] = one
        rows = engine.infer(states, weights)
        if rows is None:
            shown = ", ".join(f"{name}={value}" for name, value in evidence.items())
            raise InconsistentEvidenceError(f"the evidence has probability zero: {shown}")
        names = self.network.shape.names
        return {names[node]: tuple(row) for node, row in zip(engine.outputs, rows)}

    def _judged(self, name: str, value: Evidence) -> Union[int, List[float], None]:
        if name not in self._numbers:
            raise EvidenceError(f"there is no node {name!r}")
        states = self.network.states[self._numbers[name]]
        if isinstance(value, str):
            if value not in states:
                raise EvidenceError(f"{name}: there is no state {value!r}")
            return states.index(value)
        try:
            return None if value is None else finding(value, states)
        except EvidenceError as problem:
            raise EvidenceError(f"{name}: {problem}") from None
