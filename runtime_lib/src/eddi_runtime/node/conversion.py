"""Message trees of a monitor -> messages, checked field by field before they are published.

A transport may turn ``None`` into ``False`` without a word, take ``2`` for ``True``, and raise for
a numpy scalar only once somebody listens (rospy does). So every value is checked and converted
here, and a message is always filled completely.
"""

import contextlib
import math
import numbers
from types import ModuleType
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple, Union

from ..monitor import Tree

Convert = Callable[[object], object]
Trees = Union[Tree, List[Tree], None]
"""What one step of a monitor gives: one message tree, several, or none."""

_INTEGERS = {f"{sign}int{bits}": (sign, bits) for sign in ("", "u") for bits in (8, 16, 32, 64)}
_FLOATS = {"float32": 3.4028235e38, "float64": math.inf}
_HEADERS = ("Header", "std_msgs/Header")


class MessageClasses(NamedTuple):
    """The message classes of one package, as a transport knows them.

    Attributes:
        module: holds the classes by name (``eddi_messages.msg``).
        fields: class -> its fields, each with its type as a ``.msg`` file spells it.
        type_name: message or class -> ``package/Name``.
        stamp: returns the present time for a header.
    """

    module: ModuleType
    fields: Callable[[object], Iterable[Tuple[str, str]]]
    type_name: Callable[[object], str]
    stamp: Callable[[], object]


class MessageError(TypeError):
    """A value does not fit the message; the text names field, expected type and value."""


def _wrong(field: str, expected: str, value: object) -> MessageError:
    shown = repr(value)
    if len(shown) > 80:
        shown = shown[:77] + "..."
    return MessageError(f"{field}: {expected} expected, got {type(value).__name__} {shown}")


def _boolean(field: str) -> Convert:
    def convert(value: object) -> bool:
        kind = type(value)
        if kind is bool or (kind.__module__ == "numpy" and kind.__name__ in ("bool", "bool_")):
            return bool(value)
        raise _wrong(field, "bool", value)

    return convert


def _integer(field: str, name: str) -> Convert:
    sign, bits = _INTEGERS[name]
    low, high = (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)

    def convert(value: object) -> int:
        if isinstance(value, numbers.Integral) and not isinstance(value, bool):
            number = int(value)
            if low <= number <= high:
                return number
        raise _wrong(field, name, value)

    return convert


def _floating(field: str, name: str) -> Convert:
    largest = _FLOATS[name]

    def convert(value: object) -> float:
        if isinstance(value, numbers.Real) and not isinstance(value, bool):
            with contextlib.suppress(OverflowError):
                number = float(value)
                # NaN passes: only the kind knows whether that is its "no value".
                if not math.isfinite(number) or abs(number) <= largest:
                    return number
        raise _wrong(field, name, value)

    return convert


def _text(field: str) -> Convert:
    def convert(value: object) -> str:
        if isinstance(value, str):
            return str(value)
        raise _wrong(field, "str", value)

    return convert


class Converter:
    """Turns ``("Name", {field: value})`` into messages of one message package.

    Args:
        classes: those messages.
    """

    def __init__(self, classes: MessageClasses) -> None:
        self._classes = classes
        self._plans: Dict[str, Tuple[Any, Dict[str, Convert], Optional[str]]] = {}

    def message(self, tree: Tree) -> object:
        """Build one message.

        Raises:
            MessageError: unknown message, missing or surplus field, value of a wrong type.
        """
        name, fields = tree
        plan = self._plans.get(name)
        if plan is None:
            plan = self._plans[name] = self._plan(name)
        cls, converts, header = plan
        if fields.keys() != converts.keys():
            raise MessageError(
                f"{name}: fields {', '.join(sorted(fields))} given,"
                f" the message has {', '.join(sorted(converts))}; rebuild the message package"
            )
        values = {field: convert(fields[field]) for field, convert in converts.items()}
        built = cls(**values)
        if header is not None:
            getattr(built, header).stamp = self._classes.stamp()
        return built

    def messages(self, trees: Trees) -> object:
        """Build what one step gives: a message, a list of them, or None.

        Raises:
            MessageError: as ``message`` does.
        """
        if trees is None:
            return None
        if isinstance(trees, list):
            return [self.message(tree) for tree in trees]
        return self.message(trees)

    def type_name(self, message: object) -> str:
        """Return ``package/Name`` of a message or of its class."""
        return self._classes.type_name(message)

    def _plan(self, name: str) -> Tuple[Any, Dict[str, Convert], Optional[str]]:
        module = self._classes.module
        cls = getattr(module, name, None)
        if cls is None:
            raise MessageError(f"message {name} is not in {module.__name__}")
        converts: Dict[str, Convert] = {}
        header = None
        for field, kind in self._classes.fields(cls):
            if kind in _HEADERS and field == "header":
                header = field
            else:
                converts[field] = self._convert(f"{name}.{field}", kind)
        return cls, converts, header

    def _convert(self, field: str, kind: str) -> Convert:
        if kind.endswith("]"):
            return self._array(field, kind)
        if kind == "bool":
            return _boolean(field)
        if kind in _INTEGERS:
            return _integer(field, kind)
        if kind in _FLOATS:
            return _floating(field, kind)
        if kind == "string":
            return _text(field)
        return self._nested(field, kind)

    def _array(self, field: str, kind: str) -> Convert:
        element, _, length = kind[:-1].partition("[")
        convert_one = self._convert(field, element)
        size = int(length) if length else None

        def convert(value: object) -> List[object]:
            if not isinstance(value, (list, tuple)) or (size is not None and len(value) != size):
                raise _wrong(field, kind, value)
            return [convert_one(item) for item in value]

        return convert

    def _nested(self, field: str, kind: str) -> Convert:
        def convert(value: object) -> object:
            if not isinstance(value, tuple) or len(value) != 2:
                raise _wrong(field, kind, value)
            built = self.message(value)
            if self.type_name(built) != kind:
                raise _wrong(field, kind, value)
            return built

        return convert
