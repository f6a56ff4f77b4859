"""Rotors: which sets of failed motors an airframe survives, and the chain that follows.

Source: Aslansefat et al., "SafeDrones: Real-Time Reliability Evaluation of UAVs" and the paper of
2019 on multirotor reliability by the same group; motors are numbered as in the name, from 0.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Dict, FrozenSet, List, Optional, Sequence, Tuple

import numpy as np

from .chain import ChainSpec

Failed = FrozenSet[int]
_RING = (frozenset({0, 2, 4}), frozenset({1, 3, 5}))
CONFIGURATIONS = {"PNPN": 4, "PNPNPN": 6, "PPNNPN": 6, "PPNNPPNN": 8}
"""Name by direction of rotation (P and N) -> number of motors."""


def motors_of(configuration: str) -> Optional[int]:
    """Return the number of motors of a configuration, None for an unknown one.

    The mirrored frame, where P and N are exchanged, is the same structure.
    """
    return CONFIGURATIONS.get(_usual(configuration))


def operational(configuration: str, failed: Failed) -> bool:
    """Return whether a frame flies with these motors failed."""
    name = _usual(configuration)
    if name == "PNPN":
        return not failed
    if name == "PNPNPN":
        if len(failed) < 2 or any(failed <= half for half in _RING):
            return True
        a, b = sorted(failed)[:2]
        return len(failed) == 2 and b - a not in (1, 5)
    pairs = ({0, 1}, {2, 3}) if name == "PPNNPN" else ({0, 1}, {2, 3}, {4, 5}, {6, 7})
    critical = {4, 5} if name == "PPNNPN" else set()
    return not failed & critical and not any(pair <= failed for pair in pairs)


def _usual(configuration: str) -> str:
    mirrored = configuration.translate(str.maketrans("PN", "NP"))
    return configuration if configuration in CONFIGURATIONS else mirrored


class Rotors:
    """The chain over sets of failed motors, the last state is the loss of the frame.

    Attributes:
        spec: the chain.
        motors: how many there are.
    """

    def __init__(self, configuration: str, rates: Sequence[float]) -> None:
        self.motors = len(rates)
        self._sets = _survived(configuration, self.motors)
        number = {failed: i for i, failed in enumerate(self._sets)}
        fail = len(self._sets)
        arcs: List[Tuple[int, int, float]] = []
        for failed, i in number.items():
            for motor in range(self.motors):
                if motor not in failed:
                    after = number.get(failed | {motor}, fail)
                    arcs.append((i, after, rates[motor]))
        self.spec = ChainSpec(fail + 1, 0, (fail,), tuple(arcs))
        self._masks: Dict[Tuple[Optional[bool], ...], np.ndarray] = {}

    def consistent(self, working: Tuple[Optional[bool], ...]) -> np.ndarray:
        """Return 1.0 for each state that these statuses allow (None: unknown)."""
        mask = self._masks.get(working)
        if mask is None:
            mask = self._masks[working] = self._mask(working)
        return mask

    def _mask(self, working: Tuple[Optional[bool], ...]) -> np.ndarray:
        down = {i for i, works in enumerate(working) if works is False}
        maybe = {i for i, works in enumerate(working) if works is None}
        mask = np.zeros(self.spec.states)
        count = 0
        for i, failed in enumerate(self._sets):
            if down <= failed <= down | maybe:
                mask[i] = 1.0
                count += 1
        mask[-1] = float(count < 2 ** len(maybe))  # some completion does not fly
        return mask


@lru_cache(maxsize=None)
def _survived(configuration: str, motors: int) -> Tuple[Failed, ...]:
    """Return the sets of failed motors that one failure after the other can lead to."""
    found: Dict[Failed, None] = {frozenset(): None}
    waiting = [frozenset()]  # type: List[Failed]
    while waiting:
        failed = waiting.pop(0)
        for motor in range(motors):
            after = failed | {motor}
            if after not in found and operational(configuration, after):
                found[after] = None
                waiting.append(after)
    return tuple(found)
