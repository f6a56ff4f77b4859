"""Inputs of a monitor: the description of each and the base class of ``EDDIInput``."""

from __future__ import annotations

import time
from typing import (
    Any,
    Callable,
    Dict,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Protocol,
    Sequence,
    Tuple,
    Union,
)

from .plain_values import one_line

UNKNOWN_AGE = float("inf")
"""Age of a message that was latched on subscription: above every limit until the next one comes."""

_NO_AGES: Dict[str, float] = {}


class Computed(Protocol):
    """What computes one input from messages (``eddi_runtime.expressions.Expression``)."""

    names: Mapping[str, Tuple[str, str]]

    def value(
        self, t: int, messages: Mapping[str, object], ages: Mapping[str, float]
    ) -> Union[bool, float, str, None]:
        """Evaluate once and return the input's value, None for UNKNOWN."""


class InputSpec(NamedTuple):
    """One input of a model.

    Attributes:
        id: as in the model.
        attribute: name of the attribute of ``EDDIInput`` that holds the value.
        requires: ids of the SimulatorOutputs that the value is made of.
        max_age: seconds from receipt after which a message is stale; ``"none"``: never, on
            purpose; ``None``: never, because nothing was configured.
        factor: numerator and denominator: a given number times this is in the model's unit.
        default: value before the first message.
        every_message: the attribute holds the list of all values since the last step.
        expression: class of ``compiled.py`` that computes what ``expression`` gives
            (``eddi_runtime.expressions.Expression``).
        accepts: keys by which the configuration accepts a value of it that is not confirmed;
            ``max_age: none`` is not repeated here.
    """

    id: str
    attribute: str
    requires: Tuple[str, ...] = ()
    max_age: Union[float, str, None] = None
    factor: Optional[Tuple[int, int]] = None
    default: object = None
    every_message: bool = False
    expression: Optional[Callable[[], Computed]] = None
    accepts: Tuple[str, ...] = ()


UNSAFE_DEFAULT = "allow_unsafe_default: true"
"""The one key of ``accepts`` that counts before the first message, and only then."""


class InputState(NamedTuple):
    """How the last ``processing`` went for one input.

    Attributes:
        state: ``ok``, ``missing`` (no message yet), ``stale`` (older than ``max_age``) or
            ``invalid`` (the method raised or left the value at None).
        reason: one line for people, empty when ok.
        age: seconds since the oldest required message, ``None`` when one is missing.
        errors: how often this input was invalid so far.
        detail: traceback of the present reason, empty when there is none.
    """

    state: str
    reason: str = ""
    age: Optional[float] = None
    errors: int = 0
    detail: str = ""


class Messages(List[Any]):
    """The values of all messages since the last step, oldest first: empty when none has come.

    The class distinguishes it from one message that is a list itself.
    """


_NEW = InputState("missing", "no message yet")


def accepted(specs: Sequence[InputSpec], eddi_input: object) -> Tuple[str, ...]:
    """Return ``input: key`` for each key of the inputs that is in use in this step; never raises.

    Where the messages are not watched (``states``), no input is known to rest on such a key.

    Args:
        specs: of a monitor.
        eddi_input: what its step was given.
    """
    found: List[str] = []
    for spec in specs:
        if spec.max_age == "none" or spec.accepts:
            found += [f"{spec.id}: {key}" for key in _keys_in_use(spec, eddi_input)]
    return tuple(found)


def _keys_in_use(spec: InputSpec, eddi_input: Any) -> List[str]:
    try:
        state = eddi_input.states[spec.id].state
        if getattr(eddi_input, spec.attribute) is None:
            return []
    except Exception:  # noqa: BLE001 - any object may be given as input
        return []
    if state == "missing":  # what it holds is the default
        return [key for key in spec.accepts if key == UNSAFE_DEFAULT]
    limitless = ["max_age: none"] if spec.max_age == "none" else []
    return [*limitless, *(key for key in spec.accepts if key != UNSAFE_DEFAULT)]


class EDDIInputBase:
    """Base of the generated ``EDDIInput``: an input that cannot be trusted becomes None.

    Attributes:
        processing: takes the latest messages by SimulatorOutput id; generated classes have it.
        states: input id -> how the last ``processing`` went. For reports only: monitors decide
            by the values of the attributes.
    """

    processing: Callable[[Mapping[str, object]], object]

    # Two underscores: an input may be called anything else, `_ages` as well.

    def __init__(self) -> None:
        self.states: Dict[str, InputState] = {}
        self.__specs: Dict[str, InputSpec] = {}
        self.__ages: Mapping[str, float] = _NO_AGES
        self.__new: Optional[Mapping[str, Sequence[object]]] = None
        self.__expressions: Dict[str, Computed] = {}
        self.__messages: Mapping[str, object] = _NO_AGES
        self.__now: Optional[int] = None

    def bind(self, specs: Sequence[InputSpec]) -> None:
        """Take over attribute names, age limits and expressions; called once by the node."""
        self.__specs = {spec.id: spec for spec in specs}
        self.__expressions = {
            spec.id: spec.expression() for spec in specs if spec.expression is not None
        }

    def begin_step(
        self,
        ages: Optional[Mapping[str, float]] = None,
        new: Optional[Mapping[str, Sequence[object]]] = None,
        t_ns: Optional[int] = None,
    ) -> None:
        """Begin a step.

        Args:
            ages: SimulatorOutput id -> age of its latest message in seconds, ``UNKNOWN_AGE`` when
                it can be of any; absent means fresh.
            new: SimulatorOutput id -> the messages since the last step, oldest first, for inputs
                that take every message; None: the latest message is the only new one.
            t_ns: time of the step in nanoseconds, for expressions; None: the monotonic clock.
        """
        self.__now = t_ns
        self.__ages = _NO_AGES if ages is None else ages
        self.__new = new

    def update(
        self,
        input_id: str,
        process: Callable[..., object],
        simulator_outputs: Mapping[str, object],
        requires: Sequence[str],
    ) -> None:
        """Call ``process`` with the messages it requires; never raises.

        While a message is missing, the input keeps its default if it never had a value, else it
        becomes None: a value whose source has gone is not evidence. It also becomes None when a
        message is older than the limit or ``process`` raises.
        """
        spec = self.__specs.get(input_id)
        attribute = input_id if spec is None else spec.attribute
        before = self.states.get(input_id, _NEW)
        after: InputState
        try:
            messages, after = self.__received(spec, simulator_outputs, requires, before)
            if after.state == "ok":
                process(*messages)
                if getattr(self, attribute, None) is None:
                    errors = before.errors + 1
                    after = InputState("invalid", "left at None", after.age, errors)
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            after = _invalid(problem, before)
        # Missing from the start: the default is kept.
        if after.state != "ok" and not (after.state == before.state == "missing"):
            setattr(self, attribute, None)
        self.states[input_id] = after

    def update_each(
        self,
        input_id: str,
        process: Callable[..., object],
        simulator_outputs: Mapping[str, object],
        requires: Sequence[str],
    ) -> None:
        """Call ``process`` once for each new message of the first id; never raises.

        The attribute becomes ``Messages``, the values oldest first; None represents a
        message that ``process`` could not use. Of the other ids the latest message is passed.
        It is None as a whole while a message is missing, or when the latest is too old.
        """
        spec = self.__specs.get(input_id)
        attribute = input_id if spec is None else spec.attribute
        before = self.states.get(input_id, _NEW)
        values: Optional[Messages] = None
        after: InputState
        try:
            messages, after = self.__received(spec, simulator_outputs, requires, before)
            if after.state == "ok":
                values, problem = self._each(attribute, process, messages, requires)
                after = after if problem is None else _invalid(problem, before)
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            after = _invalid(problem, before)
        setattr(self, attribute, values)
        self.states[input_id] = after

    def update_expression(
        self,
        input_id: str,
        process: Callable[..., object],
        simulator_outputs: Mapping[str, object],
        requires: Sequence[str],
    ) -> None:
        """Call ``process`` in every step, whatever has come; never raises.

        A message that is missing, or older than the limit, is None for ``process`` and UNKNOWN for
        ``expression``, whose windows go on.
        """
        spec = self.__specs.get(input_id)
        attribute = input_id if spec is None else spec.attribute
        before = self.states.get(input_id, _NEW)
        limit = None if spec is None else spec.max_age
        after: InputState
        try:
            messages, received = self.__received(spec, simulator_outputs, requires, before)
            ages = [self.__ages.get(name, 0.0) for name in requires]
            known = [
                message if _aged([age], limit, before).state == "ok" else None
                for message, age in zip(messages, ages)
            ]
            self.__messages = dict(zip(requires, known))
            setattr(self, attribute, None)
            process(*known)
            if getattr(self, attribute, None) is not None:
                after = InputState("ok", "", max(ages, default=0.0), before.errors)
            elif received.state == "ok":
                reason = self.__reason(input_id)
                after = InputState("invalid", reason, received.age, before.errors)
            else:
                after = received
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            setattr(self, attribute, None)
            after = _invalid(problem, before)
        self.states[input_id] = after

    def __reason(self, input_id: str) -> str:
        """Return why an expression gives nothing."""
        compiled = self.__expressions.get(input_id)
        return getattr(compiled, "reason", "") or "not known yet"

    def __received(
        self,
        spec: Optional[InputSpec],
        simulator_outputs: Mapping[str, object],
        requires: Sequence[str],
        before: InputState,
    ) -> Tuple[List[object], InputState]:
        """Return the latest messages, and whether they are there and fresh."""
        messages = [simulator_outputs.get(name) for name in requires]
        if any(message is None for message in messages):
            return messages, _missing(messages, requires, before)
        ages = [self.__ages.get(name, 0.0) for name in requires]
        return messages, _aged(ages, None if spec is None else spec.max_age, before)

    def expression(self, input_id: str) -> Union[bool, float, str, None]:
        """Return what the expression of an input gives in this step, None for UNKNOWN.

        Once in a step and only below ``update_expression``: it moves the expression's windows.
        """
        compiled = self.__expressions.get(input_id)
        if compiled is None:
            return None
        values: Dict[str, object] = {}
        ages: Dict[str, float] = {}
        for word, (kind, name) in compiled.names.items():
            if kind == "message":
                values[word] = self.__messages.get(name)
                ages[word] = self.__ages.get(name, 0.0)
            else:
                values[word] = getattr(self, name, None)
        now = time.monotonic_ns() if self.__now is None else self.__now
        return compiled.value(now, values, ages)

    def _each(
        self,
        attribute: str,
        process: Callable[..., object],
        messages: Sequence[object],
        requires: Sequence[str],
    ) -> Tuple[Messages, Optional[Exception]]:
        """Return the value of each new message, and what was raised last."""
        first = messages[:1] if self.__new is None else self.__new.get(requires[0], ())
        values = Messages()
        problem: Optional[Exception] = None
        for message in first:
            setattr(self, attribute, None)
            try:
                process(message, *messages[1:])
            except Exception as raised:  # noqa: BLE001 - whatever a person's method raises
                problem = raised
                setattr(self, attribute, None)
            values.append(getattr(self, attribute, None))
        return values, problem


def _missing(messages: Sequence[object], requires: Sequence[str], before: InputState) -> InputState:
    absent = [name for name, message in zip(requires, messages) if message is None]
    return InputState("missing", f"no message of {', '.join(absent)}", None, before.errors)


def _aged(ages: Sequence[float], limit: Union[float, str, None], before: InputState) -> InputState:
    age = max(ages, default=0.0)
    # "<=" for each and not ">" for the oldest: an age of NaN is no proof of freshness.
    if limit is None or isinstance(limit, str) or all(one <= limit for one in ages):
        return InputState("ok", "", age, before.errors)
    reason = f"the last message is {age:.3g} s old, the limit is {limit:g} s"
    if age == UNKNOWN_AGE:
        reason = "the last message was latched, its age is not known"
    return InputState("stale", reason, age, before.errors)


def _invalid(problem: Exception, before: InputState) -> InputState:
    reason = one_line(problem)
    repeated = before.state == "invalid" and before.reason == reason
    detail = before.detail if repeated else _traceback(problem)
    return InputState("invalid", reason, None, before.errors + 1, detail)


def _traceback(problem: BaseException) -> str:
    import traceback  # noqa: PLC0415 - 3 ms of every start, for what rarely happens

    try:
        return "".join(traceback.format_exception(type(problem), problem, problem.__traceback__))
    except Exception:  # noqa: BLE001 - an exception may fail to print itself
        return ""
