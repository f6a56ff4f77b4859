"""How often two vehicles were too close: for recorded tracks, not for the step of a monitor.

Source: the collision risk of SafeDrones (Aslansefat et al. 2022).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def proximity(
    one: Sequence[Sequence[float]], other: Sequence[Sequence[float]], distance: float
) -> tuple[float, float]:
    """Return the fraction of samples with less than a distance, as lower and upper bound.

    Args:
        one: track (samples, coordinates) in m; both tracks at the same times.
        other: track of the same shape.
        distance: m; a sample exactly as far away is not counted.

    Returns:
        Both bounds, equal unless a coordinate is not finite: such a sample counts for the upper
        one only. NaN, NaN without samples.

    Raises:
        ValueError: the tracks do not have the same shape.
    """
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    if a.shape != b.shape or a.ndim > 2:
        raise ValueError(f"the tracks have the shapes {a.shape} and {b.shape}")
    if not a.size:
        return float("nan"), float("nan")
    known = (np.isfinite(a) & np.isfinite(b)).all(axis=1)
    near = int((np.linalg.norm(a[known] - b[known], axis=1) < distance).sum())
    return near / len(a), (near + int((~known).sum())) / len(a)
