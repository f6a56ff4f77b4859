"""State machines: in which states a system may be, from what is known of its triggers."""

from .machine import Action, Evidence, State, Transition, Trigger

FORMAT = 1

__all__ = ["FORMAT", "Action", "Evidence", "State", "Transition", "Trigger"]
