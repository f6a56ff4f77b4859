"""Fault trees whose diagram is a table: numpy takes all nodes of an event at once."""

from __future__ import annotations

from itertools import groupby
from typing import Sequence

import numpy as np

from .tree import FaultTree, Module


class LargeTree(FaultTree):
    """A fault tree whose sums are not written out."""

    def __init__(self) -> None:
        super().__init__()
        self._layers = [_layers(module) for module in self.modules]

    def failure(self, q: Sequence[float]) -> float:
        return self._evaluated(q, (0.0, 1.0))

    def survival(self, q: Sequence[float]) -> float:
        return self._evaluated(q, (1.0, 0.0))

    def _evaluated(self, q: Sequence[float], ends: tuple[float, float]) -> float:
        p = list(q)
        last = len(self.modules) - 1
        for number, (nodes, root) in enumerate(self.modules):
            values = np.empty(len(nodes) + 2)
            values[:2] = ends if number == last else (0.0, 1.0)
            for variable, place, high, low in self._layers[number]:
                chance = p[variable]
                values[place] = chance * values[high] + (1.0 - chance) * values[low]
            p.append(float(values[root]))
        return p[-1]


def _layers(module: Module) -> list[tuple[int, slice, np.ndarray, np.ndarray]]:
    """Return each variable with the place of its nodes, and what is above and below each."""
    layers, start = [], 2
    for variable, nodes in groupby(module[0], key=lambda one: one[0]):
        _, high, low = np.array(list(nodes)).T
        layers.append((variable, slice(start, start + len(high)), high, low))
        start += len(high)
    return layers
