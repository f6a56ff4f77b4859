"""Values of JSON documents, and the error when they are not what they must be."""

from __future__ import annotations

from typing import Any, Tuple, Type, Union


class ModelError(ValueError):
    """A model file cannot be used.

    Attributes:
        path: the file, or another name for where the model came from.
        reason: what is wrong, one sentence without a full stop.
    """

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(f"{path}: {reason}" if path else reason)
        self.path = path
        self.reason = reason


def take(item: Any, key: str, kind: Union[Type[Any], Tuple[Type[Any], ...]], where: str) -> Any:
    """Return ``item[key]`` if it is of the given JSON type; ``bool`` is no number here.

    Raises:
        ModelError: ``item`` is no object, the key is absent, or the type is another one.
    """
    if not isinstance(item, dict):
        raise ModelError("", f"{where} is not an object")
    if key not in item:
        raise ModelError("", f"{where} has no {key!r}")
    value = item[key]
    wanted = kind if isinstance(kind, tuple) else (kind,)
    if not isinstance(value, wanted) or (isinstance(value, bool) and bool not in wanted):
        raise ModelError("", f"{key!r} of {where} has the wrong type {type(value).__name__}")
    return value
