"""Conditions over messages and time: what compiled inputs and events call and inherit.

Windows, lists and inputs are modules of their own, which a compiled monitor imports where it has
them.
"""

from .conditions import Conditions, literal, number, reduced, scaled, stamp, truth

FORMAT = 3

__all__ = ["FORMAT", "Conditions", "literal", "number", "reduced", "scaled", "stamp", "truth"]
