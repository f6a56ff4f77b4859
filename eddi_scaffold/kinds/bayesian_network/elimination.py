"""Tables of a network, multiplied and summed by definition, for vectors and `verify`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eddi_scaffold.evidence.emitted import UnprovedError
from eddi_scaffold.kinds.bayesian_network.network import Network, numbered

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Factor = tuple[Sequence[int], Array]  # numbers of its axes, which are nodes
_MOST_NUMBERS = 2**24  # of a table


def factors_of(network: Network) -> list[Factor]:
    """Return P(node | parents) of each node, with an axis for each parent, then its own."""
    shape, _, tables = numbered(network)
    families = [*map(shape.family, range(len(tables)))]
    sizes = ([shape.cards[axis] for axis in axes] for axes in families)
    arrays = (np.array(of).reshape(size) for of, size in zip(tables, sizes, strict=True))
    return [*zip(families, arrays, strict=True)]


def summed(factors: Sequence[Factor], kept: Sequence[int]) -> Array:
    """Return the product of tables, summed over all axes but some, which it has in this order.

    Raises:
        UnprovedError: a table would be too large.
    """
    factors = [*factors]
    while left := {axis for axes, _ in factors for axis in axes}.difference(kept):
        unions = {of: {k for axes, _ in factors if of in axes for k in axes} for of in left}
        least = min(left, key=lambda of: (len(unions[of]), of))
        joined = [factor for factor in factors if least in factor[0]]
        axes = sorted(unions[least] - {least})
        factors = [*(of for of in factors if least not in of[0]), (axes, _product(joined, axes))]
    return _product(factors, kept)


def _product(factors: Sequence[Factor], kept: Sequence[int]) -> Array:
    """Return the product, summed over all other axes: numpy names 52 axes at most."""
    sizes = {axis: size for axes, of in factors for axis, size in zip(axes, of.shape, strict=True)}
    if len(sizes) > 52 or math.prod(sizes.values()) > _MOST_NUMBERS:
        raise UnprovedError(None, "the network is too large")
    names = {axis: k for k, axis in enumerate(sizes)}
    operands: list[Any] = []
    for axes, of in factors:
        operands += [of, [names[axis] for axis in axes]]
    operands.append([names[axis] for axis in kept])
    return np.asarray(np.einsum(*operands, optimize="greedy"))
