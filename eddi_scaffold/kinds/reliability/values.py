"""A map of plain values with places: every access reports what is wrong, all at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.common.units import Quantity, QuantityError, UnitError, number, temperature

KEY = -1
"""Last part of a path that refers to the place of a key, not of its value."""
_Read = Callable[[object], Quantity]


def case_of(wrong: QuantityError) -> str:
    """Return what is wrong: the unit, or everything else."""
    return "R004.quantity" if isinstance(wrong, UnitError) else "R002.quantity"


class Values:
    """One map; all maps of a file share their list of problems.

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
        self._data, self._find, self._path = data, find, path
        self.problems: list[Problem] = [] if problems is None else problems

    @property
    def failed(self) -> bool:
        """Whether an error was found, in this map or another one."""
        return has_errors(self.problems)

    @property
    def errors(self) -> int:
        """Number of errors found so far, so that a caller knows whether its part has one."""
        return sum(problem.level == "error" for problem in self.problems)

    def place(self, *keys: str | int) -> Place:
        """Return the place of something in this map."""
        return self._find(*self._path, *keys)

    def names(self) -> list[str]:
        """Return the keys in the order of the file."""
        return [str(key) for key in self._data]

    def has(self, key: str) -> bool:
        """Return whether a key is there with a value."""
        return self._data.get(key) is not None

    def value(self, key: str, default: Any = None) -> Any:
        """Return the plain value of a key."""
        found = self._data.get(key)
        return default if found is None else found

    def report(
        self, case: str, /, *keys: str | int, hint: str | None = None, **fields: object
    ) -> None:
        """Report an error at a key of this map, or at the map itself."""
        self.problems.append(problem(case, self.place(*keys), hint=hint, **fields))

    def unknown(
        self, key: str, given: str, what: str, known: Iterable[str], *, is_key: bool = False
    ) -> None:
        """Report that a value, or a key, is none of those that are known (R001)."""
        hint = SimilarNames(list(known), "there are").hint(given)
        path = (key, KEY) if is_key else (key,)
        self.report("R001.reference", *path, hint=hint, kind=what, name=given)

    def only(self, known: Sequence[str]) -> None:
        """Report the keys that are not known (R001)."""
        near = SimilarNames(known, "known keys")
        for key in self.names():
            if key not in known:
                self.report("R001.unknown_key", key, KEY, hint=near.hint(key), key=key)

    def map(self, key: str) -> Values | None:
        """Return the map below a key, None where there is none."""
        found = self._data.get(key)
        if found is None:
            return None
        if not isinstance(found, Mapping):
            self.report("R002.map", key, key=key)
            return None
        return Values(found, self._find, (*self._path, key), self.problems)

    def maps(self, key: str) -> list[Values]:
        """Return the maps of the list below a key."""
        found = self._data.get(key)
        if found is None:
            return []
        if not isinstance(found, list) or not all(isinstance(one, Mapping) for one in found):
            self.report("R002.maps", key, key=key)
            return []
        return [
            Values(one, self._find, (*self._path, key, i), self.problems)
            for i, one in enumerate(found)
        ]

    def text(self, key: str, *, required: bool = False) -> str | None:
        """Return a text; numbers are taken as they would be written."""
        found = self._data.get(key)
        if found is None:
            if required:
                self.report("R001.missing_key", key=key)
            return None
        if isinstance(found, bool | list | dict):
            self.report("R002.text", key, key=key)
            return None
        return str(found)

    def texts(self, key: str, *, required: bool = False) -> tuple[str, ...]:
        """Return a list of texts; one text alone is a list of one."""
        found = self._data.get(key)
        items = [found] if isinstance(found, str | int) else found
        if items is None and required:
            self.report("R001.missing_key", key=key)
        if items is None:
            return ()
        if not isinstance(items, list) or any(
            isinstance(item, list | dict | bool) or item is None for item in items
        ):
            self.report("R002.names", key, key=key)
            return ()
        return tuple(str(item) for item in items)

    def choice(self, key: str, known: Sequence[str]) -> str | None:
        """Return one of several words."""
        found = self.text(key)
        if found is not None and found not in known:
            self.unknown(key, found, "value", known)
            return None
        return found

    def boolean(self, key: str) -> bool:
        """Return true or false, false where the key is absent."""
        found = self._data.get(key, False)
        if not isinstance(found, bool):
            self.report("R002.boolean", key, key=key)
        return found is True

    def quantity(
        self,
        key: str,
        read: _Read,
        *,
        required: bool = False,
        needs_unit: bool = False,
        positive: bool = False,
    ) -> float | None:
        """Return a rate or a duration in 1/h or h.

        A missing unit is a warning, or, of durations of the clock, an error (R004).
        """
        found = self._data.get(key)
        if found is None:
            if required:
                self.report("R001.missing_key", key=key)
            return None
        value = self._quantity(found, read, key, needs_unit=needs_unit)
        if positive and value is not None and value <= 0.0:
            self.report("R002.positive", key, key=key)
            return None
        return value

    def quantities(self, key: str, read: _Read) -> list[float] | None:
        """Return a list of them."""
        found = self._data.get(key)
        if found is None:
            return None
        if not isinstance(found, list):
            self.report("R002.list", key, key=key)
            return None
        values = [self._quantity(one, read, key, i) for i, one in enumerate(found)]
        return [value for value in values if value is not None]

    def _quantity(
        self, given: object, read: _Read, *keys: str | int, needs_unit: bool = False
    ) -> float | None:
        try:
            found = read(given)
        except QuantityError as failure:
            self.report(case_of(failure), *keys, hint=failure.hint, subject=keys[0], reason=failure)
            return None
        if found.has_unit or (needs_unit and found.value == 0.0):
            return found.value
        if needs_unit:
            self.report("R004.unit_of_time", *keys, key=keys[0], value=given)
            return None
        unit, also = ("h", "") if read.__name__ == "duration" else ("1/h", f" or `{given} FIT`")
        self.problems.append(
            problem(
                "R004.no_unit",
                self.place(*keys),
                key=keys[0],
                value=found.value,
                unit=unit,
                number=given,
                also=also,
            )
        )
        return found.value

    def temperature(self, key: str) -> float | None:
        """Return a temperature in degC."""
        return self._plain(key, temperature)

    def number(
        self,
        key: str,
        low: float,
        high: float,
        *,
        required: bool = False,
        default: float | None = None,
    ) -> float | None:
        """Return a number between two limits."""
        if self._data.get(key) is None and not required:
            return default
        return self._plain(key, lambda given: number(given, low, high))

    def whole(self, key: str, low: int, high: int, *, required: bool = False) -> int | None:
        """Return a whole number between two limits."""
        found = self.number(key, low, high, required=required)
        if found is not None and found != int(found):
            self.report("R002.whole_number", key, key=key)
            return None
        return None if found is None else int(found)

    def _plain(self, key: str, read: Callable[[object], float]) -> float | None:
        given = self._data.get(key)
        if given is None:
            self.report("R001.missing_key", key=key)
            return None
        try:
            return read(given)
        except QuantityError as failure:
            self.report(case_of(failure), key, hint=failure.hint, subject=key, reason=failure)
            return None
