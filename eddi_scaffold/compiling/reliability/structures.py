"""Rotors: which sets of failed motors an airframe survives, and the chain that follows.

Source: Aslansefat et al., "SafeDrones: Real-Time Reliability Evaluation of UAVs" and the paper of
2019 on multirotor reliability by the same group; motors are numbered as in the name, from 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from eddi_scaffold.compiling.reliability.markov import Arc, Chain

Failed = frozenset[int]
_RING = (frozenset({0, 2, 4}), frozenset({1, 3, 5}))
CONFIGURATIONS = {"PNPN": 4, "PNPNPN": 6, "PPNNPN": 6, "PPNNPPNN": 8}
"""Name by direction of rotation (P and N) -> number of motors."""


def motors_of(configuration: str) -> int | None:
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


def rotors_chain(configuration: str, rates: Sequence[float]) -> Chain:
    """Return the chain over sets of failed motors; the last state is the loss of the frame."""
    sets = survived(configuration)
    number = {failed: i for i, failed in enumerate(sets)}
    loss = len(sets)
    arcs: list[Arc] = []
    for failed, i in number.items():
        for motor, rate in enumerate(rates):
            if motor not in failed:
                arcs.append((i, number.get(failed | {motor}, loss), rate))
    names = [", ".join(map(str, sorted(failed))) or "none" for failed in sets]
    return Chain((*names, "loss"), 0, (loss,), tuple(arcs))


@cache
def survived(configuration: str) -> tuple[Failed, ...]:
    """Return the sets of failed motors that one failure after the other can lead to."""
    found: dict[Failed, None] = {frozenset(): None}
    waiting: list[Failed] = [frozenset()]
    while waiting:
        failed = waiting.pop(0)
        for motor in range(motors_of(configuration) or 0):
            after = failed | {motor}
            if after not in found and operational(configuration, after):
                found[after] = None
                waiting.append(after)
    return tuple(found)
