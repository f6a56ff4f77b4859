"""Conditional events: conditions over time, three-valued (SESAME D7.2 section 3.5)."""

from ..expressions.expression import InputExpression
from ..expressions.values import BoolVal, NumVal
from .monitor import EventMonitor, build

__all__ = ["BoolVal", "EventMonitor", "InputExpression", "NumVal", "build"]
