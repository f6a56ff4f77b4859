"""Fault trees too large to write out: their diagram is a table, or all cut sets bound them."""

from __future__ import annotations

from itertools import groupby
from typing import Sequence

import numpy as np

from .tree import FaultTree


class LargeTree(FaultTree):
    """A fault tree whose diagram is a table: numpy takes all nodes of an event at once."""

    def __init__(self) -> None:
        super().__init__()
        self._layers = []  # each event with the place of its nodes, and what is above and below
        start = 2
        for event, nodes in groupby(self.nodes, key=lambda row: row[0]):
            _, high, low = np.array(list(nodes)).T
            self._layers.append((event, slice(start, start + len(high)), high, low))
            start += len(high)

    def failure(self, q: Sequence[float]) -> float:
        return self._evaluated(q, (0.0, 1.0))

    def survival(self, q: Sequence[float]) -> float:
        return self._evaluated(q, (1.0, 0.0))

    def _evaluated(self, q: Sequence[float], ends: tuple[float, float]) -> float:
        values = np.empty(len(self.nodes) + 2)
        values[:2] = ends
        for event, place, high, low in self._layers:
            values[place] = q[event] * values[high] + (1.0 - q[event]) * values[low]
        return float(values[-1])


class BoundedTree(FaultTree):
    """Bounds: max P(cut) <= p <= 1 - prod(1 - P(cut)) (Esary and Proschan 1963)."""

    sets: tuple[tuple[int, ...], ...]  # all minimal cut sets, numbers of events

    def __init__(self) -> None:
        by_size: dict[int, list[tuple[int, ...]]] = {}
        for set_ in self.sets:
            by_size.setdefault(len(set_), []).append(set_)
        self._groups = [np.array(group, dtype=int) for group in by_size.values()]
        super().__init__()

    def failure(self, q: Sequence[float]) -> float:
        return float(-np.expm1(self._log_survival(q)))

    def survival(self, q: Sequence[float]) -> float:
        return float(np.exp(self._log_survival(q)))

    def lower(self, q: Sequence[float]) -> float:
        return max((float(p.max()) for p in self._products(q)), default=0.0)

    def probability(self, low: list[float], high: list[float]) -> tuple[float, float, float]:
        return self.lower(low), min(self.failure(high), 1.0), self.survival(high)

    def _products(self, q: Sequence[float]) -> list[np.ndarray]:
        values = np.array(q)
        return [values[group].prod(axis=1) for group in self._groups]

    def _log_survival(self, q: Sequence[float]) -> float:
        with np.errstate(divide="ignore"):  # a cut set that is certain
            return float(sum(np.log1p(-p).sum() for p in self._products(q)))
