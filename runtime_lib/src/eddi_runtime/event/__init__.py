"""Conditional events: conditions over time, three-valued (SESAME D7.2 section 3.5)."""

from .monitor import Event, EventMonitor

FORMAT = 1

__all__ = ["FORMAT", "Event", "EventMonitor"]
