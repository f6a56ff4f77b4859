"""The part of a node between its subscribers and the monitor, without ROS.

What reaches it is ROS messages, or objects with their fields.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node.pasted import understood
from eddi_runtime.plain_values import by_id, by_key, by_name, given, joined

from eddi_scaffold.monitors.input_binding import InputBinding

SECOND = 1_000_000_000  # nanoseconds

_HELPERS: Mapping[str, Callable[..., Any]] = {
    called.__name__: called for called in (by_id, by_key, by_name, given, joined)
}


@dataclass(frozen=True)
class Received:
    """One message that a node was given."""

    t: int  # nanoseconds
    source: str  # id of the simulator output
    message: Any
    latched: bool = False  # it came on subscription and can be of any age


@dataclass(frozen=True)
class Step:
    """One step of a node."""

    t: float  # time in seconds
    inputs: Mapping[str, Any]  # input id -> what the monitor read, None when unknown
    output: Any  # what it gave


class GivenInput(EDDIInputBase):
    """``EDDIInput`` of a package without hand-written lines."""

    # Two underscores: an input may be called anything else.

    def __init__(self, bindings: Sequence[InputBinding]) -> None:
        super().__init__()
        self.__bound = []
        for binding in bindings:
            update: Callable[..., None] = self.update
            if binding.model.every_message:
                update = self.update_each
            elif binding.computed is not None:
                update = self.update_expression
            requires = [requirement.id for requirement in binding.requires]
            self.__bound.append((binding.model.id, update, _process(self, binding), requires))

    def processing(self, simulator_outputs: Mapping[str, Any]) -> None:
        """Update every input with the messages that are there."""
        for id_, update, process, requires in self.__bound:
            update(id_, process, simulator_outputs, requires)


class ReplayedNode:
    """One process of a monitor, which has received nothing yet.

    Args:
        eddi_input: an ``EDDIInput`` as a package has it: with a method ``processing``.
        running: the monitor; it should have been reset.
        step: what takes the place of ``running.execute_step``, where a package wraps it.
    """

    def __init__(
        self, eddi_input: Any, running: RuntimeMonitor[Any], step: Callable[..., Any] | None = None
    ) -> None:
        self._running = running
        self._execute = step or running.execute_step
        self._eddi_input = understood(eddi_input, running.inputs)
        for spec in running.inputs:
            setattr(self._eddi_input, spec.attribute, spec.default)
        self._eddi_input.bind(running.inputs)
        self._latest: dict[str, Received] = {}
        # input id -> the first exception of its hand-written lines and its traceback
        self.raised: dict[str, tuple[str, str]] = {}

    def step(self, t: int, messages: Sequence[Received], clock: int | None = None) -> Step:
        """Take messages over, update every input, and evaluate.

        Args:
            t: nanoseconds, of the clock of the messages.
            messages: those that came since the last step.
            clock: nanoseconds of the step itself, where another clock counts for it.
        """
        new: dict[str, list[Any]] = defaultdict(list)
        for message in messages:
            self._latest[message.source] = message
            new[message.source].append(message.message)
        now = t if clock is None else clock
        ages = {
            name: UNKNOWN_AGE if message.latched else (t - message.t) / SECOND
            for name, message in self._latest.items()
        }
        self._eddi_input.begin_step(ages, new, now)
        self._eddi_input.processing({name: last.message for name, last in self._latest.items()})
        self._eddi_input.end_step()
        for name, state in self._eddi_input.states.items():
            if state.state == "invalid" and getattr(state, "detail", ""):
                self.raised.setdefault(name, (state.reason, state.detail))
        output = self._execute(self._eddi_input, now)
        values = {
            input_.id: getattr(self._eddi_input, input_.attribute, None)
            for input_ in self._running.inputs
        }
        return Step(t / SECOND, values, output)


def _process(target: EDDIInputBase, binding: InputBinding) -> Callable[..., None]:
    """Return what ``process_<input>`` does in a package without hand-written lines."""
    if binding.computed is not None:
        name = binding.model.id
        return lambda *_: setattr(target, binding.attribute, target.expression(name))
    tree = ast.parse(binding.expression, mode="eval").body if binding.expression else None

    def process(*messages: Any) -> None:
        names = dict(zip(binding.arguments, messages, strict=True))
        value = None if tree is None else _value(tree, names)
        setattr(target, binding.attribute, value)

    return process


def _value(tree: ast.expr, names: Mapping[str, Any]) -> Any:
    """Evaluate the few forms of which our own expressions are made."""
    if isinstance(tree, ast.Name):
        return names[tree.id]
    if isinstance(tree, ast.Constant):
        return tree.value
    if isinstance(tree, ast.Attribute):
        return getattr(_value(tree.value, names), tree.attr)
    if isinstance(tree, ast.Tuple):
        return tuple(_value(elt, names) for elt in tree.elts)
    if isinstance(tree, ast.Subscript):
        return _value(tree.value, names)[_value(tree.slice, names)]
    if isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name):
        return _HELPERS[tree.func.id](*(_value(argument, names) for argument in tree.args))
    raise TypeError(f"no expression of ours: {ast.dump(tree)}")
