"""What a monitor is told: the description of each input and the base class of ``EDDIInput``."""

from __future__ import annotations

import traceback
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

RESERVED_ATTRIBUTES = frozenset({"begin_step", "bind", "processing", "states", "update"})
"""Members of ``EDDIInputBase``: no input can be held in an attribute of these names."""

_NO_AGES: Dict[str, float] = {}


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
    """

    id: str
    attribute: str
    requires: Tuple[str, ...] = ()
    max_age: Union[float, str, None] = None
    factor: Optional[Tuple[int, int]] = None
    default: Any = None


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


_NEW = InputState("missing", "no message yet")


class EDDIInputBase:
    """Base of the generated ``EDDIInput``: an input that cannot be trusted becomes None.

    Attributes:
        states: input id -> how the last ``processing`` went. For reports only: monitors decide
            by the values of the attributes.
    """

    def __init__(self) -> None:
        self.states: Dict[str, InputState] = {}
        self._specs: Dict[str, InputSpec] = {}
        self._ages: Mapping[str, float] = _NO_AGES

    def bind(self, specs: Sequence[InputSpec]) -> None:
        """Take over attribute names and age limits of the model; called once by the node."""
        self._specs = {spec.id: spec for spec in specs}

    def begin_step(self, ages: Optional[Mapping[str, float]] = None) -> None:
        """Say how old each message is (SimulatorOutput id -> seconds); absent means fresh."""
        self._ages = _NO_AGES if ages is None else ages

    def update(
        self,
        input_id: str,
        process: Callable[..., object],
        simulator_outputs: Mapping[str, Any],
        requires: Sequence[str],
    ) -> None:
        """Call ``process`` with the messages it requires; never raises.

        While a message is missing, the input keeps its default if it never had a value, else it
        becomes None: a value whose source has gone is not evidence. It also becomes None when a
        message is older than the limit or ``process`` raises.
        """
        before = self.states.get(input_id, _NEW)
        try:
            self.states[input_id] = self._updated(
                input_id, process, simulator_outputs, requires, before
            )
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            self._forget(input_id)
            reason = _one_line(problem)
            repeated = before.state == "invalid" and before.reason == reason
            detail = before.detail if repeated else _traceback()
            self.states[input_id] = InputState(
                "invalid", reason, before.age, before.errors + 1, detail
            )

    def _updated(
        self,
        input_id: str,
        process: Callable[..., object],
        simulator_outputs: Mapping[str, Any],
        requires: Sequence[str],
        before: InputState,
    ) -> InputState:
        messages = [simulator_outputs.get(name) for name in requires]
        missing = [name for name, message in zip(requires, messages) if message is None]
        if missing:
            if before is not _NEW and before.state != "missing":
                self._forget(input_id)
            return InputState("missing", f"no message of {', '.join(missing)}", None, before.errors)
        age = max((self._ages.get(name, 0.0) for name in requires), default=0.0)
        spec = self._specs.get(input_id)
        limit = spec.max_age if spec is not None else None
        # "not <=" and not ">": an age of NaN is no proof of freshness.
        if (
            limit is not None
            and not isinstance(limit, str)
            and not self._all_fresh(requires, limit)
        ):
            self._forget(input_id)
            reason = f"the last message is {age:.3g} s old, the limit is {limit:g} s"
            return InputState("stale", reason, age, before.errors)
        process(*messages)
        if getattr(self, spec.attribute if spec is not None else input_id, None) is None:
            return InputState("invalid", "left at None", age, before.errors + 1)
        return InputState("ok", "", age, before.errors)

    def _all_fresh(self, requires: Sequence[str], limit: float) -> bool:
        return all(self._ages.get(name, 0.0) <= limit for name in requires)

    def _forget(self, input_id: str) -> None:
        spec = self._specs.get(input_id)
        setattr(self, spec.attribute if spec is not None else input_id, None)


def _one_line(problem: BaseException) -> str:
    try:
        text = " ".join(str(problem).split())[:300]
    except Exception:  # noqa: BLE001 - an exception may fail to print itself
        text = "it cannot be printed"
    return f"{type(problem).__name__}: {text}" if text else type(problem).__name__


def _traceback() -> str:
    try:
        return traceback.format_exc()
    except Exception:  # noqa: BLE001 - an exception may fail to print itself
        return ""
