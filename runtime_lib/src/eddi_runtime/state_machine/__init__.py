"""State machines: in which states a system may be, from what is known of its triggers."""

from .machine import Action, Evidence, State, StateMachine, StateMachineOutput, Transition, Trigger
from .monitor import StateMachineMonitor

FORMAT = 1

__all__ = [
    "FORMAT", "Action", "Evidence", "State", "StateMachine", "StateMachineMonitor",
    "StateMachineOutput", "Transition", "Trigger",
]  # fmt: skip
