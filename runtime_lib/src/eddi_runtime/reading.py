"""The one place that reads an input of a step: a value, or why there is none; it never raises."""

from __future__ import annotations

from .plain_values import type_name


class Absent:
    """Represents an attribute that could not be read.

    Attributes:
        problem: why, empty when the object simply has no such attribute.
    """

    __slots__ = ("problem",)

    def __init__(self, problem: str = "") -> None:
        self.problem = problem


ABSENT = Absent()


def read(source: object, attribute: str, input_id: str) -> object:
    """Return the value of an attribute, an ``Absent`` where it cannot be read; never raises.

    An object that was not generated may hold an id that is no identifier as it is.
    """
    for name in (attribute, input_id):
        try:
            return getattr(source, name)
        except AttributeError:  # noqa: PERF203 - the second is rare
            continue
        except Exception as problem:  # noqa: BLE001 - a property may raise anything
            return Absent(f"reading it raised {type_name(problem)}")
    return ABSENT
