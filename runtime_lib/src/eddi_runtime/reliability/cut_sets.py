"""Fault trees whose diagram would be too large: bounded by all minimal cut sets."""

from __future__ import annotations

from typing import Sequence

import numpy as np

from .tree import FaultTree


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
