"""A state machine as ``compiled.py`` declares it."""

from __future__ import annotations

from typing import NamedTuple


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
