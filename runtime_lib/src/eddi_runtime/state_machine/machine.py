"""A state machine as ``compiled.py`` declares it, and what a step of its monitor gives."""

from __future__ import annotations

from typing import Mapping, NamedTuple


class Action(NamedTuple):
    """What is due on entry into a state or on exit."""

    kind: str  # ``function``, ``message`` or ``warning``
    text: str  # as in the model
    target: str = ""  # of a function ``TARGET=CALL``, or the ``sourceID`` of a message
    priority: int = 0  # of a warning
    raises: int = -1  # number of the raised trigger that a warning of this text fires
    method: str = ""  # of a function: name of the method of the ``actions`` object


class State(NamedTuple):
    """One state; the first one in the file is number 0."""

    id: str  # as in the model
    initial: bool = False
    fail: bool = False
    entry: tuple[int, ...] = ()  # numbers of actions, in order
    exit: tuple[int, ...] = ()


class Trigger(NamedTuple):
    """What has a truth value in each step: of transitions, of an observation, the reset."""

    text: str  # as in the model
    needs: tuple[int, ...] = ()  # numbers of the inputs that it depends on
    # counts in one step, and there for the first hop only: an ExternalEvent, or what is raised
    momentary: bool = False
    raised: bool = False  # by the actions of the machine; it needs no input
    # the only input holds the messages since the last step (``every_message``), TRUE where one is;
    # ``step`` does not compute it
    messages: bool = False
    persistent: bool = False  # TRUE until the reset
    absent: bool = False  # UNKNOWN counts as FALSE, which is reported as accepted


class Transition(NamedTuple):
    """One transition."""

    name: str  # as in the model, may be empty
    source: int  # number of the state
    target: int
    triggers: tuple[int, ...] = ()  # numbers; any of them is enough
    after: int | None = None  # nanoseconds in the state
    place: str = ""  # ``shuttle.xml:12``


class Evidence(NamedTuple):
    """A claim: every possible state is one of these, and has been for some time."""

    id: str
    states: tuple[int, ...]  # numbers; of ``not_in`` all others
    hold: int = 0  # nanoseconds


class StateMachine:
    """What the class ``Monitor`` of a compiled state machine declares."""

    states: tuple[State, ...]  # in the order of the model
    actions: tuple[Action, ...] = ()
    triggers: tuple[Trigger, ...] = ()
    transitions: tuple[Transition, ...] = ()  # of each state in the order in which they are tried
    evidence: tuple[Evidence, ...] = ()
    observe: tuple[tuple[int, Trigger], ...] = ()  # state, and what excludes it when FALSE
    reset_by: Trigger | None = None
    start = "initial"  # in these states, or ``unknown``: in any
    max_gap: int  # nanoseconds between two steps in which nothing can be missed


class RaisedAction(NamedTuple):
    """An action of one step, as a method of the ``actions`` object gets it."""

    state: str
    moment: str  # ``entry`` or ``exit``
    kind: str  # ``function``, ``message`` or ``warning``
    text: str
    target: str
    priority: int
    certain: bool  # it is performed, once; else it may have been due

    @property
    def function(self) -> str:
        """What to call: ``CALL`` of ``TARGET=CALL``."""
        return self.text.split("=")[1] if self.target and "=" in self.text else self.text


class StateMachineOutput(NamedTuple):
    """The result of one step; the fields are those of the message."""

    id: str
    state: str  # empty while several are possible
    possible: tuple[str, ...]  # in the order of the model
    failed: int  # FALSE 0, UNKNOWN 1, TRUE 2
    # for which it has at least been in the state; of several, since their set changed
    since_seconds: float
    in_state: Mapping[str, int]  # state -> verdict
    evidence: Mapping[str, bool]
    raised: tuple[RaisedAction, ...]
    unknown_inputs: tuple[str, ...]
    reasons: tuple[str, ...]

    def without_claims(self, *reasons: str) -> StateMachineOutput:
        """Return it for a step in which nothing may be claimed."""
        unknown, off = dict.fromkeys(self.in_state, 1), dict.fromkeys(self.evidence, False)
        made = self._replace(failed=max(self.failed, 1), in_state=unknown, evidence=off)
        return made._replace(reasons=(*self.reasons, *reasons))
