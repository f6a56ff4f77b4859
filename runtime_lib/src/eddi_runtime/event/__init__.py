"""Conditional events: conditions over time, three-valued (SESAME D7.2 section 3.5)."""

from .monitor import Event, EventMonitor

FORMATS = (1,)

__all__ = ["FORMATS", "Event", "EventMonitor"]
