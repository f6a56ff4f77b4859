"""Conditional events: conditions over time, three-valued (SESAME D7.2 section 3.5)."""

from .expression import InputExpression
from .monitor import EventMonitor, build
from .values import BoolVal, NumVal

__all__ = ["BoolVal", "EventMonitor", "InputExpression", "NumVal", "build"]
