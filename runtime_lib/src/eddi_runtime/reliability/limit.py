"""An input whose largest value is declared."""

from __future__ import annotations

from typing import Optional, Tuple


class Limit:
    """The range of an input up to a declared limit, which a sensor may be seen to contradict.

    A value above the limit is not believed, so the input is unknown; but neither is the limit then:
    until the next value that is believed, the input may be as large as what was seen.

    Args:
        name: of the input.
        largest: the declared limit.
        shown: the limit for people, such as ``t_max (85 degC)``.

    Attributes:
        worst: the largest value that the input may have while it is unknown.
    """

    def __init__(self, name: str, largest: float, shown: str) -> None:
        self.name, self._largest, self._shown = name, largest, shown
        self.worst = largest

    def take(self, value: Optional[float]) -> Tuple[Optional[float], str]:
        """Return the value, None when it is unknown, and what is wrong with it."""
        if value is None:
            return None, ""
        if value > self._largest:
            self.worst = value
            return None, f"{value:g} is above {self._shown}; it counts as unknown"
        self.worst = self._largest
        return value, ""

    def reset(self) -> None:
        """Trust the limit again."""
        self.worst = self._largest
