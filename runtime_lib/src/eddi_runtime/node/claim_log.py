"""What the log says of claims: lost and why, still missing, there again."""

from __future__ import annotations

import math
from typing import Iterator

from ..why import TRUE, Cause, ClaimWhy, Why, clean, seconds
from .start import LOG

WAIT_S = 0.3  # for the reason that another monitor tells
STILL_S = 10.0  # between two lines that only the reason has changed
GAP_S = 1.0  # between two lines of a claim


class _Claim:
    """One claim: what was said of it, and the line that waits."""

    def __init__(self, now: float) -> None:
        self.holds = False
        self.known = False  # it held before, or was reported as missing
        self.lost_at = now
        self.reason: Cause | None = None  # the first one, while it does not hold
        self.said: object = None  # of which reason the last line was
        self.word, self.rest = "", ""  # of the line that waits
        self.due = 0.0
        self.more = 0  # lines that were left out
        self.last = self.last_still = -math.inf

    def note(self, row: ClaimWhy, now: float, waiting: bool) -> None:
        """Take over how it is now; ``waiting``: the grace of the start is not over."""
        if row.verdict == TRUE:
            if self.known and not self.holds:
                chain = f" ({self.reason.chain})" if self.reason else ""
                self._plan("again", now, f"{row.id} after {seconds(now - self.lost_at)}{chain}")
            self.holds = self.known = True
            return
        self.reason = row.causes[0] if row.causes else None
        if self.holds:
            self.holds, self.lost_at = False, now
            self._plan("lost", now + WAIT_S)
        elif not (self.known or waiting):
            self.known = True
            self._plan("missing", now + WAIT_S)
        elif self._is_news(now):
            self._plan("still", now)

    def _is_news(self, now: float) -> bool:
        """Return whether the first reason is another one than was said, and may be said."""
        told = self.reason is not None and self.reason.state != "untold"
        other = self.known and not self.word and _key(self.reason) != self.said
        return told and other and now - self.last_still >= STILL_S

    def _plan(self, word: str, due: float, rest: str = "") -> None:
        self.more += bool(self.word)
        self.word, self.due, self.rest = word, due, rest

    def line(self, row: ClaimWhy, now: float) -> tuple[str, str] | None:
        """Return level and text of the line that waits, None while it still has to."""
        untold = row.verdict != TRUE and self.reason and self.reason.state == "untold"
        if not self.word or (untold and now < self.due):
            return None
        if now - self.last < GAP_S:
            return None
        more = f" ({self.more} more)" if self.more else ""
        text = clean(f"{self.word} {self.rest or row.sentence}{more}")
        level = "info" if self.rest else level_of(row)
        self.said, self.last = _key(self.reason), now
        if self.word == "still":
            self.last_still = now
        self.word, self.rest, self.more = "", "", 0
        return level, text


def _key(cause: Cause | None) -> object:
    state = cause and cause.state.replace("waiting", "never")  # when the grace ends: no news
    return cause and (cause.path, state)


def level_of(row: ClaimWhy) -> str:
    """Return how much attention it needs that a claim does not hold."""
    if any(" raised " in cause.text and len(cause.monitors) < 2 for cause in row.causes):
        return "error"  # a person's method, of this monitor
    known = row.causes and all(cause.state == "false" for cause in row.causes)
    return "info" if known else "warn"


class ClaimLog:
    """The lines about the claims of one monitor."""

    def __init__(self) -> None:
        self._claims: dict[str, _Claim] = {}

    def note(self, why: Why, now: float, waiting: bool) -> None:
        """Take over how the claims were at a time; ``waiting``: the start's grace is not over."""
        for row in why.values():
            if row.id not in self._claims:
                self._claims[row.id] = _Claim(now)
            self._claims[row.id].note(row, now, waiting)

    def lines(self, why: Why, now: float) -> Iterator[tuple[str, str]]:
        """Yield level and text of each line that is due now."""
        for id_, claim in self._claims.items():
            line = claim.line(why[id_], now) if id_ in why else None
            if line is not None:
                yield line

    def write(self, why: Why, now: float) -> None:
        """Log what is due now."""
        for level, text in self.lines(why, now):
            getattr(LOG, level)("%s", text)

    @property
    def waits(self) -> bool:
        """Is there a line that is not due yet."""
        return any(claim.word for claim in self._claims.values())
