"""What `run` prints, as rows."""

from __future__ import annotations


def changes(out: str) -> list[tuple[str, str]]:
    """Return the time of each line, and 1 for what is active and 0 for what is inactive there."""
    digits = {"active": "1", "inactive": "0"}
    return [
        (line[:10].strip(), "".join(digits.get(word, "") for word in line.split()))
        for line in out.splitlines()
    ]
