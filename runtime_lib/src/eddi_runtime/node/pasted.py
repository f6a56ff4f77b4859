"""An ``EDDIInput`` as the tools of SESAME D7.2 wrote it, in the place of the generated file."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from .. import inputs
from ..inputs import InputSpec, InputState, invalid

PASTED = (
    "EDDIInput.py is a class of the D7.2 tools: an input that its `processing` does not assign in"
    " a step, or whose messages are missing or old, is unknown; run `eddi-scaffold adopt`"
)


def understood(eddi_input: Any, specs: Sequence[InputSpec]) -> Any:
    """Return an ``EDDIInput`` as it is, one of D7.2 with what it lacks: ages and states."""
    return eddi_input if hasattr(eddi_input, "begin_step") else EDDIInputBase(eddi_input, specs)


class EDDIInputBase(inputs.EDDIInputBase):
    """An ``EDDIInput`` around one of D7.2; the name of its base, for two underscores."""

    def __init__(self, eddi_input: Any, specs: Sequence[InputSpec]) -> None:
        super().__init__(specs)
        self.__pasted = eddi_input

    def processing(self, simulator_outputs: Mapping[str, object], t_ns: int | None = None) -> None:
        self.begin_processing(t_ns)
        received = {
            name: self.__received(name, simulator_outputs, spec.requires)[2]
            for name, spec in self.__specs.items()
        }
        required = {name for spec in self.__specs.values() for name in spec.requires}
        good = [spec for name, spec in self.__specs.items() if received[name].state == "ok"]
        fresh = {name for spec in good for name in spec.requires}
        messages = {k: v for k, v in simulator_outputs.items() if k in fresh or k not in required}
        problem = None
        for spec in self.__specs.values():
            setattr(self.__pasted, spec.attribute, None)
        try:
            self.__pasted.processing(messages)
        except Exception as error:  # noqa: BLE001 - whatever a person's method raises
            problem = invalid(error, None)
        new = self.__arrived if self.__new is None else [k for k, v in self.__new.items() if v]
        for name, spec in self.__specs.items():
            state, value = problem or received[name], None
            if state.state == "ok":
                value = getattr(self.__pasted, spec.attribute, None)
                if value is None:
                    state = InputState("invalid", "`processing` did not assign it", state.age)
                elif spec.every_message and not any(name in new for name in spec.requires):
                    from ..history import Messages  # noqa: PLC0415 - travels where it is needed

                    value = Messages()
            self.__leave(name, state, value)
