"""Topics of a robot, and the values that their messages hold."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

from eddi_scaffold.config.message_types import Fields, element, is_primitive, python_type
from eddi_scaffold.config.message_types.documented import Documented, documented
from eddi_scaffold.connect.words import words
from eddi_scaffold.identifiers import is_identifier

FieldsOf = Callable[[str], Fields | None]
_DEPTH = 6
_MOST = 1000
"""Fields of a message that are looked at, with those inside of its fields."""
_MATRIX = re.compile(r"float(?:32|64)\[(9|36)\]")


@dataclass(frozen=True)
class RobotTopic:
    """A topic of the robot.

    Attributes:
        id: of its entry in ``SimulatorOutputs``.
        type: ``package/Type``.
        topic: its name.
    """

    id: str
    type: str
    topic: str

    @property
    def is_of_monitor(self) -> bool:
        """Whether one of our own monitors publishes it."""
        return self.type.startswith("eddi_messages/")

    @cached_property
    def message(self) -> str:
        """The name of the type without its package."""
        return self.type.rpartition("/")[2]

    @cached_property
    def words(self) -> Sequence[str]:
        """What topic and id tell."""
        return (*words(self.topic), *words(self.id))


@dataclass(frozen=True)
class Leaf:
    """One value of a message, or one element of a list of values.

    Attributes:
        path: names of fields, with ``[]`` behind a list and ``[7]`` behind one element of a matrix;
            empty where the fields of the message are not known.
        type: ``bool``, ``int``, ``float`` or ``str``; empty where it is not known.
        units: in which it may be; none when it has none, ``None`` when that is not known.
        is_only: the message holds nothing else.
    """

    path: tuple[str, ...]
    type: str
    units: tuple[str, ...] | None
    is_only: bool = False

    @cached_property
    def text(self) -> str:
        """The path as text."""
        return ".".join(self.path)

    @cached_property
    def lists(self) -> int:
        """How many lists are on the way."""
        return sum(1 for name in self.path if name.endswith("[]"))

    @property
    def is_variance(self) -> bool:
        """Whether it says how uncertain another value is."""
        return "variance" in self.path[-1] if self.path else False  # of covariance as well


def leaves(message: str, fields_of: FieldsOf) -> list[Leaf]:
    """Return the values of a message; of a monstrous one the first, models are any text."""
    if fields_of(message) is None:
        return [Leaf((), "", None)]
    visited = islice(_fields(message, (), fields_of, (message,)), _MOST)
    ends = [one for one in visited if one is not None]
    return [
        Leaf(path, python_type(of), _units(documented(message, path, fields_of)), len(ends) == 1)
        for path, of in ends
    ]


def _units(known: Documented | None) -> tuple[str, ...] | None:
    return None if known is None else known.units


def _fields(
    of: str, path: tuple[str, ...], fields_of: FieldsOf, above: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str] | None]:
    """Yield path and type of each value below a message, and nothing for any other field.

    A message inside of itself ends there.
    """
    for name, inner in (fields_of(of) or {}).items():
        yield None
        if not is_identifier(name):
            continue
        matrix = _MATRIX.fullmatch(inner)
        if matrix and "covariance" in name:
            size = {"9": 3, "36": 6}[matrix[1]]
            for k in range(size):
                yield (*path, f"{name}[{k * (size + 1)}]"), "float64"
            continue
        single = element(inner)
        step = (*path, name if single is None else f"{name}[]")
        end = single or inner
        if is_primitive(end):
            yield step, end
        elif end not in above and len(above) < _DEPTH and name != "header":
            yield from _fields(end, step, fields_of, (*above, end))
