"""What `run` prints, as rows."""

from __future__ import annotations


def changes(out: str) -> list[tuple[str, str]]:
    """Return the time of each line, and 1 for what is active, 0 for inactive, ? for unknown."""
    digits = {"active": "1", "inactive": "0", "unknown": "?"}
    values = [line.partition("<-")[0].split() for line in out.splitlines()]
    return [(time, "".join(digits.get(word, "") for word in words)) for time, *words in values]
