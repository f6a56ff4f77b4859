"""State machines as data: states, transitions, what triggers them and what they do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from eddi_scaffold.common.problems import Place
from eddi_scaffold.program.gates import Gate


@dataclass(frozen=True)
class Action:
    """What is done when a state is entered or left."""

    kind: str  # `function`, `warning` or `message`
    text: str
    type: str = ""  # of a warning or a message
    source: str = ""  # of a message
    priority: int = 0  # of a warning
    place: Place = field(default=Place(), compare=False)

    @property
    def is_event(self) -> bool:
        """Whether it is an event that may trigger a transition."""
        return self.kind == "warning" and self.type in ("", "event")


@dataclass(frozen=True)
class State:
    """One state."""

    name: str
    is_initial: bool = False
    is_fail: bool = False
    entry: tuple[Action, ...] = ()
    exit: tuple[Action, ...] = ()
    place: Place = field(default=Place(), compare=False)

    def actions(self) -> list[tuple[str, Action]]:
        """Return its actions, each with `entry` or `exit`."""
        return [*(("entry", a) for a in self.entry), *(("exit", a) for a in self.exit)]


@dataclass(frozen=True)
class Trigger:
    """What may take a transition; transitions with equal ones share it."""

    text: str
    is_external: bool = False  # an order or message, which counts in one step
    is_persistent: bool = False  # once true, it stays true until the reset
    # of a class that does not say whether true is good, so that a configuration has to
    is_opaque: bool = False
    place: Place = field(default=Place(), compare=False)


@dataclass(frozen=True)
class Transition:
    """One transition; any of its triggers takes it, after a time in the state if there is one."""

    name: str
    source: str
    target: str
    triggers: tuple[Trigger, ...] = ()
    priority: int = 0  # smaller first
    after: float | None = None  # seconds
    place: Place = field(default=Place(), compare=False)

    @property
    def ends(self) -> str:
        """Where it leads from and to: its name where that is not unique."""
        return f"{self.source} -> {self.target}"


@dataclass(frozen=True)
class StateMachine:
    """One state machine, with the causes of fault trees that trigger it."""

    name: str = field(compare=False)
    states: tuple[State, ...]  # in document order
    transitions: tuple[Transition, ...]
    causes: Mapping[str, str] = field(default_factory=dict)  # text of a trigger -> cause
    gates: Mapping[str, Gate] = field(default_factory=dict)  # of these causes and those below
    # text of a trigger -> how it was resolved
    resolved: Mapping[str, str] = field(default_factory=dict, compare=False)
    place: Place = field(default=Place(), compare=False)

    @cached_property
    def triggers(self) -> tuple[Trigger, ...]:
        """All triggers, once each, in the order of the transitions."""
        return tuple(dict.fromkeys(t for each in self.transitions for t in each.triggers))

    @cached_property
    def state(self) -> Mapping[str, State]:
        """Name -> state."""
        return {state.name: state for state in self.states}

    @cached_property
    def fail(self) -> tuple[str, ...]:
        """Names of the fail states."""
        return tuple(state.name for state in self.states if state.is_fail)

    @cached_property
    def raised(self) -> frozenset[str]:
        """Texts of the events that states give."""
        return frozenset(action.text for action in self.actions() if action.is_event)

    def actions(self) -> Iterator[Action]:
        """Yield the actions of all states."""
        for state in self.states:
            yield from (action for _, action in state.actions())

    @cached_property
    def leaving(self) -> Mapping[str, list[Transition]]:
        """State -> its transitions, in the order in which they count."""
        leaving: dict[str, list[Transition]] = {name: [] for name in self.state}
        ranks = sorted(self.transitions, key=lambda of: (of.priority, of.target not in self.fail))
        for each in ranks:
            leaving[each.source].append(each)
        return leaving

    @cached_property
    def called(self) -> Mapping[Transition, str]:
        """Transition -> its name, or its ends where that is not unique."""
        numbers = Counter(each.name for each in self.transitions)
        unique = {name for name, number in numbers.items() if name and number == 1}
        return {each: each.name if each.name in unique else each.ends for each in self.transitions}
