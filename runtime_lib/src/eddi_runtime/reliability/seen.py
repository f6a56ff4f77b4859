"""Observations of a chain in a step."""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

KEPT = 64
"""How many different observations of a chain are kept."""


class Observation(NamedTuple):
    """Observations of a chain by known inputs.

    Attributes:
        mask: one 1.0 or 0.0 per state, whether it is consistent with the inputs.
        worst: the state that is taken when the belief gives all consistent ones no weight.
        fatal: nothing but failure is consistent.
        alive: failure is not consistent, something else is.
    """

    mask: np.ndarray
    worst: int
    fatal: bool
    alive: bool


class Seen(NamedTuple):
    """Observations of a chain, and what follows from them in every step.

    Attributes:
        mask: one 1.0 or 0.0 per state, whether it is consistent with the inputs; None: all are.
        unknown: inputs that are not known.
        bounds: for each horizon failed at least and at most, alive and mean life at least.
        worst: the state that is taken when the belief gives all consistent ones no weight.
        powers: one quantum with the mask behind it, and its powers by 2, 4, 8, ...
        block: from a belief to its looks ahead now and in the steps of one quantum that follow,
            and to the belief at the end; None: each step by itself.
        fatal: nothing but failure is consistent.
        alive: failure is not consistent, something else is.
        completions: possible observations with what is not known; the others are made
            of these. Empty where it is not needed.
    """

    mask: Optional[np.ndarray]
    unknown: Tuple[str, ...]
    bounds: Sequence[Tuple[float, float, float, float]]
    worst: int
    powers: List[np.ndarray]
    block: Optional[np.ndarray]
    fatal: bool = False
    alive: bool = False
    completions: Tuple[Observation, ...] = ()
