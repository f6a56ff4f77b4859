"""Reading ``config/model.json``: what is damaged or not understood is refused with a reason.

The digest in the file is that of its own content, so a changed number or a cut line is found
before it is compiled (SESAME D7.2 leaves this open).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

FORMAT = 1
RESERVED_ATTRIBUTES = frozenset(
    {
        "begin_processing",
        "begin_step",
        "bind",
        "end_step",
        "expression",
        "look_again",
        "processed",
        "processing",
        "received",
        "setup",
        "states",
        "update",
        "update_each",
    }
    | {"update_expression"}
)
"""Members of the runtime's ``EDDIInputBase``: no input is held in an attribute of these names."""


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


def take(item: Any, key: str, kind: type[Any] | tuple[type[Any], ...], where: str) -> Any:
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


@dataclass(frozen=True)
class InputData:
    """One input of a model, as ``eddi_runtime.InputSpec`` describes it."""

    id: str
    attribute: str
    requires: tuple[str, ...] = ()
    max_age: float | str | None = None
    factor: tuple[int, int] | None = None
    default: Any = None
    every_message: bool = False
    expression: Mapping[str, Any] | None = None
    accepts: tuple[str, ...] = ()


Data = Mapping[str, bytes] | Callable[[str], bytes]


@dataclass(frozen=True)
class ModelFile:
    """The content of a model file whose frame (not yet the kind's own part) was checked.

    Attributes:
        path: where it was read.
        kind: name of the kind (``consert``).
        id: the model's id.
        digest: SHA-256 of the content, as the file states it.
        source: where the model was generated from.
        inputs: the inputs of the monitor, in the order of the file.
        model: the kind's own part.
        settings: the kind's settings.
        data: name -> bytes of a bulk file beside the model; raises ModelError when there is none.
    """

    path: str
    kind: str
    id: str
    digest: str
    source: Mapping[str, Any]
    inputs: tuple[InputData, ...]
    model: Mapping[str, Any]
    settings: Mapping[str, Any]
    data: Callable[[str], bytes]


def parse_model(text: str, name: str = "<text>", data: Data | None = None) -> ModelFile:
    """Check the text of a model file; ``name`` is used in errors.

    Args:
        text: the JSON text.
        name: used in errors.
        data: bulk files that belong to the model, by name.

    Raises:
        ModelError: the text is damaged.
    """
    try:
        document = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError) as problem:
        raise ModelError(name, f"the file is damaged: {problem}") from None
    return check_document(document, name, data)


def check_document(document: Any, name: str = "<document>", data: Data | None = None) -> ModelFile:
    """Check a model that is already in memory, as ``json.loads`` gives it.

    Raises:
        ModelError: the document is damaged.
    """
    try:
        return _model_file(document, name, data if callable(data) else _in_memory(data or {}))
    except ModelError as problem:
        raise ModelError(name, problem.reason) from None


def canonical(document: Mapping[str, Any]) -> str:
    """Return the one text of a JSON document that digests are made of.

    Raises:
        ValueError: a number is not finite.
    """
    return json.dumps(document, sort_keys=True, indent=1, ensure_ascii=True, allow_nan=False) + "\n"


def digest_of(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a model document without its own ``sha256``."""
    content = {key: value for key, value in document.items() if key != "sha256"}
    return hashlib.sha256(canonical(content).encode("ascii")).hexdigest()


def _no_constant(text: str) -> NoReturn:
    raise ValueError(f"{text} is not JSON")


def _in_memory(files: Mapping[str, bytes]) -> Callable[[str], bytes]:
    def read(name: str) -> bytes:
        if name not in files:
            raise ModelError("", f"the file {name!r} that belongs to the model is not there")
        return files[name]

    return read


def _model_file(document: Any, path: str, data: Callable[[str], bytes]) -> ModelFile:
    where = "the model file"
    found = take(document, "format", int, where)
    if found != FORMAT:
        raise ModelError("", f"format {found} is not known, only {FORMAT}")
    digest = take(document, "sha256", str, where)
    try:
        actual = digest_of(document)
    except (ValueError, RecursionError) as problem:
        raise ModelError("", f"the file is damaged: {problem}") from None
    if digest != actual:
        raise ModelError(
            "", f"the content was changed: it states sha256 {digest}, but has {actual}"
        )
    return ModelFile(
        path=path,
        kind=take(document, "kind", str, where),
        id=take(document, "id", str, where),
        digest=digest,
        source=take(document, "source", dict, where),
        inputs=_inputs(take(document, "inputs", list, where)),
        model=take(document, "model", dict, where),
        settings=take(document, "settings", dict, where),
        data=data,
    )


def _inputs(items: Any) -> tuple[InputData, ...]:
    specs = tuple(_input(item, f"input {index}") for index, item in enumerate(items))
    for name in ("id", "attribute"):
        seen: set[str] = set()
        for spec in specs:
            value = getattr(spec, name)
            if value in seen:
                raise ModelError("", f"two inputs have the {name} {value!r}")
            seen.add(value)
    return specs


def _input(item: Any, where: str) -> InputData:
    name = take(item, "id", str, where)
    where = f"input {name!r}"
    attribute = take(item, "attribute", str, where)
    if not attribute or attribute in RESERVED_ATTRIBUTES:
        raise ModelError("", f"{where} cannot be held in an attribute {attribute!r}")
    requires = texts(take(item, "requires", list, where), f"'requires' of {where}")
    return InputData(
        id=name,
        attribute=attribute,
        requires=requires,
        max_age=_max_age(item.get("max_age"), where),
        factor=_factor(item.get("factor"), where),
        default=item.get("default"),
        every_message=item.get("every_message") is True,
        expression=_expression(item.get("expression"), where),
        accepts=texts(item.get("accepts", []), f"'accepts' of {where}"),
    )


def texts(value: Any, what: str) -> tuple[str, ...]:
    """Return a list of texts.

    Raises:
        ModelError: it is none.
    """
    if isinstance(value, list) and all(isinstance(one, str) for one in value):
        return tuple(value)
    raise ModelError("", f"{what} is not a list of texts")


def _expression(value: Any, where: str) -> Mapping[str, Any] | None:
    if value is None:
        return None
    names = value.get("names") if isinstance(value, dict) else None
    if not isinstance(names, dict) or not all(
        isinstance(name, list) and len(name) == 2 and name[0] in ("message", "input")
        for name in names.values()
    ):
        raise ModelError("", f"'expression' of {where} has no 'names'")
    return dict(value)


def _max_age(value: Any, where: str) -> float | str | None:
    if value is None or value == "none":
        return None if value is None else "none"
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0 < value < 1e18:
        return float(value)
    raise ModelError("", f"'max_age' of {where} is neither a number of seconds above 0 nor 'none'")


def _factor(value: Any, where: str) -> tuple[int, int] | None:
    if value is None:
        return None
    if isinstance(value, list) and len(value) == 2:
        num, den = value
        if type(num) is int and type(den) is int and num > 0 and den > 0:
            return num, den
    raise ModelError("", f"'factor' of {where} is not a pair of positive whole numbers")
