"""What every monitor offers, and how one is made from a model file."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, Optional, Protocol, Tuple, Union

from .inputs import InputSpec
from .model_file import ModelError, ModelFile, read_model

Tree = Tuple[str, Mapping[str, Any]]
"""A message without ROS: (name, field -> str, bool, int, float, list or Tree)."""

KIND_MODULES = {"consert": ".consert"}
"""Kind -> module of this package that offers ``build(ModelFile) -> Monitor``."""


class Monitor(Protocol):
    """One compiled model. Not thread-safe: the thread that steps it also asks it.

    Attributes:
        model_id: id of the model.
        digest: SHA-256 of the model file's content.
        kind: name of the kind (``consert``).
        inputs: what ``execute_step`` reads, one attribute each.
    """

    model_id: str
    digest: str
    kind: str
    inputs: Tuple[InputSpec, ...]

    def execute_step(self, eddi_input: object) -> Any:
        """Evaluate once; never raises, whatever the attributes of ``eddi_input`` are."""

    def message(self, output: Any) -> Tree:
        """Return what ``execute_step`` gave as a message tree with checked values."""

    def status_message(self) -> Optional[Tree]:
        """Return the facts behind the last step, without a header; ``None`` if there are none."""

    def blocked(self, not_good: Iterable[str] = ()) -> Mapping[str, Tuple[str, ...]]:
        """Return input id -> outputs that are not given because this input is not known now.

        Args:
            not_good: inputs that count as not known whatever they hold, such as one that still
                has its default because no message has come.
        """

    def faults(self) -> Mapping[str, str]:
        """Return input id -> what was wrong with its value in the last step."""

    def reset(self) -> None:
        """Forget everything of former steps."""


def load(path: Union[str, Path]) -> Monitor:
    """Read a model file and compile its monitor.

    Raises:
        ModelError: the file cannot be used; the message has path and reason.
    """
    return build(read_model(path))


def build(model_file: ModelFile) -> Monitor:
    """Compile the monitor of a model that was read.

    Raises:
        ModelError: the kind is not known, or its part of the model is wrong.
    """
    module = KIND_MODULES.get(model_file.kind)
    if module is None:
        known = ", ".join(sorted(KIND_MODULES))
        reason = f"the kind {model_file.kind!r} is not known to this runtime, only {known}"
        raise ModelError(model_file.path, reason)
    make: Callable[[ModelFile], Monitor] = importlib.import_module(module, __package__).build
    try:
        return make(model_file)
    except ModelError as problem:
        raise ModelError(model_file.path, problem.reason) from None
