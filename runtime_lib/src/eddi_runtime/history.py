"""Inputs that are made of more than the latest messages: of each one, or of windows over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Mapping, Sequence

from . import inputs
from .inputs import UNDECIDED, InputSpec, InputState, Latest, Method, aged, invalid
from .plain_values import UNTOLD

if TYPE_CHECKING:  # travels where a monitor has one
    from .expressions.expression import Expression


__all__ = ["EDDIInputBase", "Messages"]


class Messages(List[Any]):
    """The values of all messages since the last step, oldest first; no message is a list so."""


class EDDIInputBase(inputs.EDDIInputBase):
    """Base of an ``EDDIInput`` with such inputs.

    It has the name of its own base: what begins with two underscores belongs to both.
    """

    def __init__(self, specs: Sequence[InputSpec] = ()) -> None:
        self.__messages: Mapping[str, tuple[object, float]] = {}
        self.__each: dict[str, bool] = {}  # attributes of ``Messages``: has a step read them
        super().__init__(specs)

    def bind(self, specs: Sequence[InputSpec]) -> None:
        super().bind(specs)
        self.__expressions: dict[str, Expression] = {
            spec.id: spec.expression() for spec in specs if spec.expression is not None
        }

    def received(self, source: str) -> None:
        super().received(source)
        for expression in self.__expressions.values():
            expression.forget_messages()

    def look_again(self, t_ns: int | None) -> float:
        waited = super().look_again(t_ns)
        for attribute, read in self.__each.items():
            if read and getattr(self, attribute, None) is not None:
                setattr(self, attribute, Messages())
            self.__each[attribute] = True
        return waited

    def update_each(
        self, input_id: str, process: Method, simulator_outputs: Latest, requires: Sequence[str]
    ) -> None:
        """Call ``process`` once for each new message of the first id; never raises.

        The attribute becomes ``Messages``: None for a message that ``process`` could not use. Of
        other ids the latest is passed. It is None while one is missing, or the latest is too old.
        """
        attribute, _ = self.__spec(input_id)
        before = self.states.get(input_id)
        values: Messages | None = None
        try:
            messages, _, after = self.__received(input_id, simulator_outputs, requires)
            if after.state == "ok":
                values = Messages()
                first: Sequence[object] = messages[:1]
                if self.__new is not None:
                    first = self.__new.get(requires[0], ())
                elif self.__ages is None and requires[0] not in self.__arrived:
                    first = ()
                for message in first:
                    setattr(self, attribute, None)
                    try:
                        process(message, *messages[1:])
                    except Exception as problem:  # noqa: BLE001 - a person's method
                        after = invalid(problem, before)
                        setattr(self, attribute, None)
                    values.append(getattr(self, attribute, None))
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            after = invalid(problem, before)
        self.__each[attribute] = False
        self.__leave(input_id, after, values)

    def update_expression(
        self, input_id: str, process: Method, simulator_outputs: Latest, requires: Sequence[str]
    ) -> None:
        """Call ``process`` in every step, whatever has come; never raises.

        A message that is missing or too old is None and UNKNOWN; windows go on.
        """
        attribute, limit = self.__spec(input_id)
        try:
            messages, ages, after = self.__received(input_id, simulator_outputs, requires)
            known = [
                message if aged([age], limit).state == "ok" else None
                for message, age in zip(messages, ages)
            ]
            self.__messages = dict(zip(requires, zip(known, ages)))
            setattr(self, attribute, None)
            process(*known)
            if getattr(self, attribute, None) is not None:
                robots = self.__robots(
                    [name for name, of in zip(requires, known) if of is not None]
                )
                fresh = [age for age, of in zip(ages, known) if of is not None]
                after = InputState("ok", "", max(fresh, default=0.0), robots=robots)
            elif after.state == "ok":
                reason = getattr(self.__expressions.get(input_id), "reason", "")
                state = "untold" if reason == UNTOLD else "invalid"
                after = InputState(state, reason or UNDECIDED, after.age)
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            after = invalid(problem, self.states.get(input_id))
        value = getattr(self, attribute, None) if after.state == "ok" else None
        self.__leave(input_id, after, value)

    def expression(self, input_id: str) -> bool | float | str | None:
        """Return what the expression of an input gives, None for UNKNOWN.

        Once in a step and only below ``update_expression``: it moves the expression's windows.
        """
        compiled = self.__expressions.get(input_id)
        if compiled is None:
            return None
        values: dict[str, object] = {}
        ages: dict[str, float] = {}
        for word, (kind, name) in compiled.names.items():
            if kind == "message":
                values[word], ages[word] = self.__messages.get(name, (None, 0.0))
            else:
                values[word] = getattr(self, name, None)
        now = self.__now
        if now is None:  # what was given is no time
            return None
        # Where the clock of a simulation stands, no step is taken; silence must show all the same.
        hidden = now == compiled.last and any(item is None for item in values.values())
        value = compiled.value(now, values, ages)
        return None if hidden else value
