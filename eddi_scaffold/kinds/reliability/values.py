"""A map of plain values with places: every access reports what is wrong, all at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from eddi_scaffold.common import units
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem

KEY = -1  # Last part of a path that refers to the place of a key, not of its value
_NO_TEXT = (bool, list, dict, type(None))
_Read = Callable[[object], units.Quantity]
D = TypeVar("D")
V = TypeVar("V")


def case_of(fault: units.QuantityError) -> str:
    """Return what is wrong: the unit, or everything else."""
    return "R004.quantity" if isinstance(fault, units.UnitError) else "R002.quantity"


class Values:
    """One map; all maps of a file share their list of problems.

    What is absent, or wrong, is the default, which has to be there for quantities and numbers.

    Args:
        data: the plain values.
        find: path of keys and positions -> its place; with ``KEY`` at the end: that of its key.
        path: of this map.
        problems: where findings go.
    """

    def __init__(
        self,
        data: Mapping[str, Any],
        find: Callable[..., Place],
        path: tuple[str | int, ...] = (),
        problems: list[Problem] | None = None,
    ) -> None:
        self.data, self._find, self._path = data, find, path
        self.problems: list[Problem] = [] if problems is None else problems

    @property
    def errors(self) -> int:
        """Number of errors found so far, so that a caller knows whether its part has one."""
        return sum(problem.level == "error" for problem in self.problems)

    def place(self, *keys: str | int) -> Place:
        """Return the place of something in this map."""
        return self._find(*self._path, *keys)

    def has(self, key: str) -> bool:
        """Return whether a key is there with a value."""
        return self.data.get(key) is not None

    def report(
        self, case: str, /, *keys: str | int, hint: str | None = None, **fields: object
    ) -> None:
        """Report a problem at a key of this map, or at the map itself."""
        self.problems.append(problem(case, self.place(*keys), hint=hint, **fields))

    def unknown(self, kind: str, name: str, known: Iterable[str], *keys: str | int) -> None:
        """Report at a key that a name is none of those that are known (R001)."""
        hint = SimilarNames(list(known), "there are").hint(name)
        self.report("R001.reference", *keys, hint=hint, kind=kind, name=name)

    def only(self, *known: str) -> None:
        """Report the keys that are not known (R001)."""
        similar = SimilarNames(known, "known keys")
        for key in map(str, self.data):
            if key not in known:
                self.report("R001.unknown_key", key, KEY, hint=similar.hint(key), key=key)

    def _get(
        self,
        key: str,
        expected: str,
        fits: Callable[[Any], bool] = lambda _: True,
        *,
        required: bool = False,
    ) -> Any:
        value = self.data.get(key)
        if value is None and required:
            self.report("R001.missing_key", key=key)
        elif value is not None and not fits(value):
            self.report("R002.type", key, key=key, expected=expected)
            return None
        return value

    def _below(self, data: Mapping[str, Any], *keys: str | int) -> Values:
        return Values(data, self._find, (*self._path, *keys), self.problems)

    def map(self, key: str) -> Values | None:
        """Return the map below a key, None where there is none."""
        value = self._get(key, "a map", lambda value: isinstance(value, Mapping))
        return None if value is None else self._below(value, key)

    def entries(self, key: str) -> Iterator[tuple[str, Values]]:
        """Yield the maps in the map below a key, by name."""
        parent = self.map(key)
        for name in map(str, parent.data if parent else ()):
            if parent and (entry := parent.map(name)):
                yield name, entry

    def maps(self, key: str) -> list[Values]:
        """Return the maps of the list below a key."""

        def fits(value: object) -> bool:
            return isinstance(value, list) and all(isinstance(item, Mapping) for item in value)

        maps = self._get(key, "a list of maps", fits) or ()
        return [self._below(map_, key, i) for i, map_ in enumerate(maps)]

    def text(self, key: str, *, required: bool = False) -> str | None:
        """Return a text; numbers are taken as they would be written."""
        value = self._get(key, "a text", lambda v: not isinstance(v, _NO_TEXT), required=required)
        return None if value is None else str(value)

    def texts(self, key: str, *, required: bool = False) -> tuple[str, ...]:
        """Return a list of texts; one text alone is a list of one."""

        def fits(value: object) -> bool:
            items = value if isinstance(value, list) else [value]
            return not any(isinstance(item, _NO_TEXT) for item in items)

        value = self._get(key, "a list of names", fits, required=required)
        items = value if isinstance(value, list) else [] if value is None else [value]
        return tuple(map(str, items))

    def choice(self, key: str, known: Sequence[str]) -> str | None:
        """Return one of several words."""
        text = self.text(key)
        if text is not None and text not in known:
            self.unknown("value", text, known, key)
            return None
        return text

    def boolean(self, key: str, default: bool = False) -> bool:
        """Return true or false."""
        value = self._get(key, "true or false", lambda value: isinstance(value, bool))
        return default if value is None else value is True

    def quantity(
        self, key: str, read: _Read, default: D, *, required: bool = False, positive: bool = False
    ) -> float | D:
        """Return a rate or a duration in 1/h or h; a missing unit is a warning (R004)."""
        value = self._get(key, "", required=required)
        number = None if value is None else self._quantity(value, read, key)
        if positive and number is not None and number <= 0.0:
            self.report("R002.positive", key, key=key)
            return default
        return default if number is None else number

    def quantities(self, key: str, read: _Read) -> list[float] | None:
        """Return a list of them."""
        items = self._get(key, "a list", lambda value: isinstance(value, list))
        if items is None:
            return None
        numbers = [self._quantity(item, read, key, i) for i, item in enumerate(items)]
        return [number for number in numbers if number is not None]

    def _quantity(self, value: object, read: _Read, *keys: str | int) -> float | None:
        quantity = self._converted(value, read, *keys)
        if quantity is not None and not quantity.has_unit:
            unit, also = ("h", "") if read is units.duration else ("1/h", f" or `{value} FIT`")
            fields: dict[str, Any] = {"unit": unit, "also": also, "key": keys[0]}
            self.report("R004.no_unit", *keys, value=quantity.value, number=value, **fields)
        return quantity and quantity.value

    def _converted(self, value: object, read: Callable[[object], V], *keys: str | int) -> V | None:
        try:
            return read(value)
        except units.QuantityError as fault:
            self.report(case_of(fault), *keys, hint=fault.hint, subject=keys[0], reason=fault)
            return None

    def converted(
        self, key: str, read: Callable[[object], V], default: D, *, required: bool = False
    ) -> V | D:
        """Return what a value is read as."""
        value = self._get(key, "", required=required)
        read_value = None if value is None else self._converted(value, read, key)
        return default if read_value is None else read_value

    def number(
        self, key: str, low: float, high: float, default: D, *, required: bool = False
    ) -> float | D:
        """Return a number between two limits."""
        read = partial(units.number, low=low, high=high)
        return self.converted(key, read, default, required=required)

    def whole_number(
        self, key: str, low: int, high: int, default: D, *, required: bool = False
    ) -> int | D:
        """Return a whole number between two limits."""
        number = self.number(key, low, high, None, required=required)
        if number is not None and number != int(number):
            self.report("R002.type", key, key=key, expected="a whole number")
        return default if number is None else int(number)
