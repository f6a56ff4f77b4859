"""How much is kept of what others send: enough for any fleet, and no more, whoever sends."""

from __future__ import annotations

from eddi_scaffold.escaping import one_line

MAX_TEXT = 300
MAX_VERDICTS = 10_000
"""Of all robots together."""
MAX_MONITORS = 2_000
MAX_INPUTS = 500
"""Of one monitor."""
MAX_REASONS = 20
"""Of one verdict."""


def plain(text: object) -> str:
    """Return a text of others as one line of limited length."""
    line = one_line(str(text)[: MAX_TEXT + 1])
    return line if len(line) <= MAX_TEXT else f"{line[: MAX_TEXT - 1]}…"
