"""Message trees of a monitor -> messages, checked field by field before they are published.

A transport may turn ``None`` into ``False`` without a word, take ``2`` for ``True``, and raise for
a numpy scalar only once somebody listens (rospy does). So every value is checked and converted
here, and a message is always filled completely.
"""

import math
from types import ModuleType
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Tuple, Union

from ..monitor import Tree
from ..plain_values import plain

Trees = Union[Tree, List[Tree], None]
"""What one step of a monitor gives: one message tree, several, or none."""

_WHOLE: Mapping[str, Tuple[int, int]] = {
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
}
_FLOATS = {"float32": 3.4028235e38, "float64": math.inf}
_EXACT = {"bool": bool, "string": str}
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


class Converter:
    """Turns ``("Name", {field: value})`` into messages of one message package.

    Args:
        classes: those messages.
    """

    def __init__(self, classes: MessageClasses) -> None:
        self._classes = classes
        self._plans: Dict[str, Tuple[Any, Dict[str, str], Optional[str]]] = {}

    def message(self, tree: Tree) -> object:
        """Build one message.

        Raises:
            MessageError: unknown message, missing or surplus field, value of a wrong type.
        """
        name, fields = tree
        plan = self._plans.get(name)
        if plan is None:
            plan = self._plans[name] = self._plan(name)
        cls, kinds, header = plan
        if fields.keys() != kinds.keys():
            # D7.2 prints `oddViolation`, where the packages that it describes have `odd_violation`
            spelt = {_letters(field): field for field in kinds}
            fields = {spelt.get(_letters(field), field): fields[field] for field in fields}
        if fields.keys() != kinds.keys():
            raise MessageError(
                f"{name}: fields {', '.join(sorted(fields))} given,"
                f" the message has {', '.join(sorted(kinds))}; rebuild the message package"
            )
        built = cls()
        for field, kind in kinds.items():
            given = fields[field]
            exact = type(given) is _EXACT.get(kind)  # as nearly all are
            setattr(built, field, given if exact else self._value(name, field, kind, given))
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

    def _plan(self, name: str) -> Tuple[Any, Dict[str, str], Optional[str]]:
        """Return the class of a message, its fields without a header, and its header."""
        cls = getattr(self._classes.module, name, None)
        if cls is None:
            raise MessageError(f"message {name} is not in {self._classes.module.__name__}")
        kinds = dict(self._classes.fields(cls))
        header = "header" if kinds.get("header") in _HEADERS else None
        if header is not None:
            del kinds[header]
        return cls, kinds, header

    def _value(self, message: str, field: str, kind: str, value: object) -> object:
        if kind.endswith("]"):
            one, _, length = kind[:-1].partition("[")
            if isinstance(value, (list, tuple)) and (not length or len(value) == int(length)):
                return [self._value(message, field, one, item) for item in value]
        elif kind in _EXACT or kind in _WHOLE or kind in _FLOATS:
            found = _scalar(kind, value)
            if found is not None:
                return found
        elif isinstance(value, tuple) and len(value) == 2:
            built = self.message(value)
            if self.type_name(built) == kind:
                return built
        expected = "str" if kind == "string" else kind
        given = f"{type(value).__name__} {value!r}"
        shown = given if len(given) <= 80 else given[:77] + "..."
        raise MessageError(f"{message}.{field}: {expected} expected, got {shown}")


def _letters(field: str) -> str:
    return field.replace("_", "").lower()


def _scalar(kind: str, value: object) -> Union[bool, int, float, str, None]:
    """Return a value as a plain one of a type, None where it is none of that type."""
    found = plain(value)
    if kind in _EXACT:
        return found if type(found) is _EXACT[kind] else None
    if isinstance(found, (str, bool)) or found is None:
        return None
    if kind in _WHOLE:
        low, high = _WHOLE[kind]
        return found if isinstance(found, int) and low <= found <= high else None
    try:
        number = float(found)
    except OverflowError:
        return None
    # NaN passes: only the kind knows whether that is its "no value".
    return number if not math.isfinite(number) or abs(number) <= _FLOATS[kind] else None
