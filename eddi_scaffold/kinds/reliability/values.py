"""A map of plain values with places: every access reports what is wrong, all at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, error, has_errors, warning
from eddi_scaffold.common.units import Quantity, QuantityError, UnitError, number, temperature

KEY = -1
"""Last part of a path that refers to the place of a key, not of its value."""
_Read = Callable[[object], Quantity]


def code_of(problem: QuantityError) -> str:
    """Return the code of the diagnostic: R004 for a unit, R002 for everything else."""
    return "R004" if isinstance(problem, UnitError) else "R002"


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

    def error(self, code: str, message: str, *keys: str | int, hint: str | None = None) -> None:
        """Report an error at a key of this map, or at the map itself."""
        self.problems.append(error(code, message, self.place(*keys), hint))

    def unknown(
        self, key: str, given: str, what: str, known: Iterable[str], *, is_key: bool = False
    ) -> None:
        """Report that a value, or a key, is none of those that are known (R001)."""
        hint = SimilarNames(list(known), "there are").hint(given)
        path = (key, KEY) if is_key else (key,)
        self.error("R001", f"there is no {what} {given!r}", *path, hint=hint)

    def only(self, known: Sequence[str]) -> None:
        """Report the keys that are not known (R001)."""
        near = SimilarNames(known, "known keys")
        for key in self.names():
            if key not in known:
                self.error("R001", f"unknown key {key!r}", key, KEY, hint=near.hint(key))

    def map(self, key: str) -> Values | None:
        """Return the map below a key, None where there is none."""
        found = self._data.get(key)
        if found is None:
            return None
        if not isinstance(found, Mapping):
            self.error("R002", f"{key}: a map is expected", key)
            return None
        return Values(found, self._find, (*self._path, key), self.problems)

    def maps(self, key: str) -> list[Values]:
        """Return the maps of the list below a key."""
        found = self._data.get(key)
        if found is None:
            return []
        if not isinstance(found, list) or not all(isinstance(one, Mapping) for one in found):
            self.error("R002", f"{key}: a list of maps is expected", key)
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
                self.error("R001", f"the key {key!r} is missing")
            return None
        if isinstance(found, bool | list | dict):
            self.error("R002", f"{key}: a text is expected", key)
            return None
        return str(found)

    def texts(self, key: str, *, required: bool = False) -> tuple[str, ...]:
        """Return a list of texts; one text alone is a list of one."""
        found = self._data.get(key)
        items = [found] if isinstance(found, str | int) else found
        if items is None and required:
            self.error("R001", f"the key {key!r} is missing")
        if items is None:
            return ()
        if not isinstance(items, list) or any(
            isinstance(item, list | dict | bool) or item is None for item in items
        ):
            self.error("R002", f"{key}: a list of names is expected", key)
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
            self.error("R002", f"{key}: true or false is expected", key)
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

        A missing unit is a warning (R003), or, of durations of the clock, an error (R004).
        """
        found = self._data.get(key)
        if found is None:
            if required:
                self.error("R001", f"the key {key!r} is missing")
            return None
        value = self._quantity(found, read, key, needs_unit=needs_unit)
        if positive and value is not None and value <= 0.0:
            self.error("R002", f"{key}: it must be positive", key)
            return None
        return value

    def quantities(self, key: str, read: _Read) -> list[float] | None:
        """Return a list of them."""
        found = self._data.get(key)
        if found is None:
            return None
        if not isinstance(found, list):
            self.error("R002", f"{key}: a list is expected", key)
            return None
        values = [self._quantity(one, read, key, i) for i, one in enumerate(found)]
        return [value for value in values if value is not None]

    def _quantity(
        self, given: object, read: _Read, *keys: str | int, needs_unit: bool = False
    ) -> float | None:
        try:
            found = read(given)
        except QuantityError as problem:
            self.error(code_of(problem), f"{keys[0]}: {problem}", *keys, hint=problem.hint)
            return None
        if found.has_unit or (needs_unit and found.value == 0.0):
            return found.value
        if needs_unit:
            hint = f"write `{given} s`"
            self.error("R004", f"{keys[0]}: {given!r} has no unit of time", *keys, hint=hint)
            return None
        unit, also = ("h", "") if read.__name__ == "duration" else ("1/h", f" or `{given} FIT`")
        message = f"{keys[0]} has {found.value!r} without a unit; {unit} is assumed"
        hint = f"write `{given} {unit}`{also}"
        self.problems.append(warning("R003", message, self.place(*keys), hint))
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
            self.error("R002", f"{key}: a whole number is expected", key)
            return None
        return None if found is None else int(found)

    def _plain(self, key: str, read: Callable[[object], float]) -> float | None:
        given = self._data.get(key)
        if given is None:
            self.error("R001", f"the key {key!r} is missing")
            return None
        try:
            return read(given)
        except QuantityError as problem:
            self.error(code_of(problem), f"{key}: {problem}", key, hint=problem.hint)
            return None
