"""Conditions over messages and time: what compiled inputs and events call and inherit."""

from . import lists, stacks, windows
from .conditions import Conditions, literal, number, scaled, stamp, truth
from .expression import Expression

FORMATS = (1,)

__all__ = [
    "FORMATS",
    "Conditions",
    "Expression",
    "lists",
    "literal",
    "number",
    "scaled",
    "stacks",
    "stamp",
    "truth",
    "windows",
]
