"""Why a claim does not hold: causes as data, the sentence they make, the message ``Why``.

A *claim* is what others rely on: a guarantee, an event (of a HAZARD its absence), a threshold, the
scope of SafeML. ``Monitor.why()`` computes the causes of each from the last step; an input that
reads a claim of another monitor takes over its causes from the latest ``Why`` of that monitor. No
verdict ever looks at any of it.

* A monitor makes a ``ClaimWhy`` with ``claim_why``; ``why()`` returns claim id -> ``ClaimWhy``, of
  which ``sentence`` is the text, and ``causes[0]`` the first reason.
* A node publishes that of its monitor on ``<output topic>/why``, and hands the last ``Why`` of
  each monitor that it reads to ``processing``, as ``<SimulatorOutput id>/why``. What its transport
  knows it writes into causes of its own topics, of which ``monitors`` has but one.
"""

from __future__ import annotations

import math
from typing import Any, Iterable, Mapping, NamedTuple, Sequence, Tuple

from .plain_values import as_message, plain

FALSE, UNKNOWN, TRUE = 0, 1, 2
_VALUES = ("false", "unknown", "true")
NAN = math.nan

# fmt: off
STATES = (
    "gone", "silent", "waiting", "never", "type", "offer", "latched", "invalid", "window", "hold",
    "robot", "code", "untold", "false",
)
# fmt: on
"""States of a cause; in a message each is its place here."""

TEXTS = {
    "gone": "publisher gone {age}",
    "silent": "nothing for {age}, limit {limit}",
    "waiting": "no message yet, {since} of {limit} to wait",
    "never": "no message yet, {since} after the start",
    "latched": "latched, its age is not known",
    "window": "undecided for {since}, its windows fill",
    "hold": "good for {since} of {limit}",
    "code": "by hand, not run here",
    "untold": "unknown there, its monitor tells no reason",
    "false": "false for {since}",
}
"""Texts of states; those that are not here or have another one are written where they arise."""

MOST_CAUSES, MOST_LINKS, MOST_BYTES = 8, 16, 4096  # of a claim, of a path, of a message
MOST_AGE_S = 3.0  # after which a ``Why`` tells nothing any more
_SHOWN = 3  # chains in a sentence
_LENGTH = 400  # characters of a sentence
_LONGEST = 200  # characters of each text that another monitor sends


class Cause(NamedTuple):
    """One reason why a claim does not hold, seen from that claim."""

    path: Tuple[str, ...]  # links below the claim: inputs, claims of other monitors, a topic
    state: str  # one of ``STATES``
    text: str  # with ``{since}``, ``{age}`` and ``{limit}`` in place of these
    topic: str = ""  # from which nothing usable comes, empty inside a monitor
    monitors: Tuple[str, ...] = ()  # ids of those on the path, first that of the claim
    since: float = 0.0  # seconds for which it has been so
    age: float = NAN  # seconds since the last message
    limit: float = NAN  # seconds that are allowed, or a threshold
    detail: str = ""  # for the brackets

    @property
    def said(self) -> str:
        """Its text with the seconds, and the detail."""
        text = self.text.replace("{since}", seconds(self.since))
        text = text.replace("{age}", seconds(self.age)).replace("{limit}", length(self.limit))
        return f"{text} ({self.detail})" if self.detail else text

    @property
    def chain(self) -> str:
        """The links and the text: ``nearest <- /scan: nothing for 0.7 s, limit 0.3 s``."""
        links = " <- ".join(self.path)
        return f"{links}: {self.said}" if links else self.said

    def under(self, link: str) -> Cause:
        """Return it as what reads this input or claim sees it."""
        path = (link, *self.path)
        if len(path) > MOST_LINKS:  # the topic stays
            path = (*path[: MOST_LINKS - 1], path[-1])
        return self._replace(path=path)

    def later(self, passed: float) -> Cause:
        """Return it some seconds later, when nothing has changed."""
        grown = self._replace(since=self.since + passed, age=self.age + passed)
        if self.state != "waiting" or grown.since <= self.limit:
            return grown
        text = self.text.replace(TEXTS["waiting"], TEXTS["never"])  # a message has details in it
        return grown._replace(state="never", text=text)

    def because(self, state: str, text: str = "", detail: str = "") -> Cause:
        """Return it with another state, its text (empty: that of the state), and more detail."""
        detail = ", ".join(filter(None, (detail, self.detail)))
        return self._replace(state=state, text=text or TEXTS.get(state, state), detail=detail)

    def as_json(self) -> dict[str, Any]:
        numbers = {"since": self.since, "age": self.age, "limit": self.limit}
        return {
            "path": [*self.path],
            "monitors": [*self.monitors],
            "topic": self.topic,
            "state": self.state,
            **{name: x if math.isfinite(x) else None for name, x in numbers.items()},
            "text": clean(self.said),
        }


class ClaimWhy(NamedTuple):
    """Why one claim is as it is: without causes where it holds."""

    id: str  # of the claim
    verdict: int  # FALSE 0, UNKNOWN 1, TRUE 2; of a HAZARD that of its absence
    causes: Tuple[Cause, ...] = ()  # the first reason first
    more: int = 0  # further causes, which were left out

    @property
    def sentence(self) -> str:
        """``Sail <- Calm <- wind <- /mast/wind: nothing for 0.4 s``; empty where it holds."""
        if self.verdict == TRUE:
            return ""
        chains = [cause.chain for cause in self.causes[:_SHOWN]] or [TEXTS["untold"]]
        arrow = " <- " if self.causes and self.causes[0].path else ": "
        more = len(self.causes[_SHOWN:]) + self.more
        last = [f"and {more} more"] if more else []
        text = clean(f"{self.id}{arrow}{'; '.join([*chains, *last])}")
        return text if len(text) <= _LENGTH else f"{text[:_LENGTH]}.."

    def as_json(self) -> dict[str, Any]:
        """Return it as ``run --json`` writes it."""
        value, causes = _VALUES[self.verdict], [cause.as_json() for cause in self.causes]
        return {"value": value, "text": self.sentence, "causes": causes}


Why = Mapping[str, ClaimWhy]
"""Claim id -> why, of one monitor."""


def claim_why(monitor: str, claim: str, verdict: int, causes: Iterable[Cause]) -> ClaimWhy:
    """Return why a claim of a monitor is as it is; of equal causes the first one counts."""
    if verdict == TRUE:
        return ClaimWhy(claim, verdict)
    kept: dict[Any, Cause] = {}
    for cause in causes:
        seen = cause._replace(monitors=(monitor, *cause.monitors)[:MOST_LINKS])
        last = -2 if seen.topic else -1
        element = seen.path[last:][:1]
        kept.setdefault((seen.topic, seen.monitors[-1], element, seen.said), seen)
    if not kept:
        kept[None] = Cause((), "untold", "nothing can make it hold", monitors=(monitor,))
    first = tuple(kept.values())[:MOST_CAUSES]
    return ClaimWhy(claim, verdict, first, len(kept) - len(first))


def told(claims: object, claim: str, age: float, verdict: int) -> Tuple[Cause, ...]:
    """Return the causes of a claim as its monitor told them some seconds ago, seen from there.

    Empty where they do not count: too old, of another verdict, or there are none. A reader for
    which it is UNKNOWN takes those of a claim that is known not to hold there.
    """
    why = read_why(claims).get(claim)
    if why is None or not 0.0 <= age <= MOST_AGE_S or why.verdict not in (verdict, verdict - 1):
        return ()
    return tuple([cause.later(age) for cause in why.causes])


def named(message: object) -> str:
    """Return the id of the claim that a message is about, empty where it names none."""
    try:
        id_ = plain(getattr(message, "id", ""))
    except Exception:  # noqa: BLE001 - whatever a message does
        return ""
    return id_ if isinstance(id_, str) else ""


def holds(message: object, claim: str) -> bool:
    """Return whether a message of a monitor says that a claim holds; never raises."""
    given: Any = message
    try:
        for name in ("guarantees", "evidence", "in_state"):
            rows = [row for row in getattr(given, name, ()) if plain(row.id) == claim]
            if rows:
                given = rows[0]
        return getattr(given, "active", None) is True or plain(getattr(given, "verdict", 0)) == 2
    except Exception:  # noqa: BLE001 - whatever a message does
        return False


# The message.


def why_tree(monitor: str, claims: Why) -> Tuple[str, Any]:
    """Return the message ``Why`` as a tree, without a header; causes go where it is too long."""
    most = MOST_CAUSES
    while True:
        rows = [_claim_tree(claim, most) for claim in claims.values()]
        if most == 0 or _size(rows) + len(monitor) <= MOST_BYTES - 64:
            break
        most -= 1
    while rows and _size(rows) + len(monitor) > MOST_BYTES - 64:
        rows.pop()
    return "Why", {"monitor": monitor, "claims": rows}


def _claim_tree(claim: ClaimWhy, most: int) -> Tuple[str, Any]:
    causes = [_cause_tree(cause) for cause in claim.causes[:most]]
    more = min(claim.more + len(claim.causes) - len(causes), 65535)
    return "ClaimWhy", {"id": claim.id, "verdict": claim.verdict, "causes": causes, "more": more}


def _cause_tree(cause: Cause) -> Tuple[str, Any]:
    detail = f" ({cause.detail})" if cause.detail else ""
    return "Cause", {
        "path": [clean(link)[:_LONGEST] for link in cause.path],
        "monitors": [clean(name)[:_LONGEST] for name in cause.monitors],
        "topic": clean(cause.topic)[:_LONGEST],
        "state": STATES.index(cause.state),
        "since": cause.since,
        "age": cause.age,
        "limit": cause.limit,
        "text": clean(cause.text + detail)[:_LONGEST],
    }


def _size(value: Any) -> int:
    """Return about how many bytes a part of a message has, rather too many than too few."""
    if isinstance(value, str):
        return 8 + len(value.encode("utf-8", "replace"))
    if isinstance(value, tuple):
        return sum([_size(part) for part in value[1].values()])
    return 8 + sum([_size(part) for part in value]) if isinstance(value, list) else 8


def read_why(message: object) -> Why:
    """Return a message ``Why``, or what ``why()`` returned, as claims by id; never raises.

    Another monitor is not to be trusted, and may have a runtime of its own, whose classes are not
    these: lengths are limited, and what is malformed tells nothing.
    """
    try:
        given: Any = as_message(message)
        claims = [*given.values()] if type(given) is dict else given.claims
        rows = [_read_claim(row) for row in _first(claims, 1024)]
    except Exception:  # noqa: BLE001 - whatever a message does
        return {}
    return {row.id: row for row in rows}


def _read_claim(row: Any) -> ClaimWhy:
    causes = tuple([_read_cause(cause) for cause in _first(row.causes, MOST_CAUSES)])
    verdict, more = plain(row.verdict), plain(row.more)
    if verdict not in (FALSE, UNKNOWN, TRUE) or not isinstance(more, int):
        raise ValueError(verdict)
    return ClaimWhy(_text(row.id), int(verdict), causes, more)


def _read_cause(row: Any) -> Cause:
    state: Any = plain(row.state)
    path, monitors = _first(row.path, MOST_LINKS), _first(row.monitors, MOST_LINKS)
    numbers: Any = [plain(number) for number in (row.since, row.age, row.limit)]
    since, age, limit = map(float, numbers)
    links, names = tuple(map(_text, path)), tuple(map(_text, monitors))
    topic, text, detail = map(_text, (row.topic, row.text, getattr(row, "detail", "")))
    state = STATES[state] if isinstance(state, int) else STATES[STATES.index(state)]
    return Cause(links, state, text, topic, names, since, age, limit, detail)


def _first(items: Any, most: int) -> Sequence[Any]:
    return [items[k] for k in range(min(len(items), most))]


def _text(raw: object) -> str:
    value = plain(raw)
    if not isinstance(value, str):
        raise TypeError(type(raw))
    return clean(value[:_LONGEST])


# How numbers and times are written.


def clean(text: str) -> str:
    """Return a text with a blank for each character that cannot be printed."""
    if text.isprintable():
        return text
    return "".join([letter if letter.isprintable() else " " for letter in text])


def seconds(value: float) -> str:
    """Return for how long something has been: ``5.9 s``, ``120 s``, ``1.5 h``."""
    if not math.isfinite(value):
        return "an unknown time"
    if round(value, 1) < 100:
        return f"{max(value, 0.0):.1f} s"
    return f"{value:.0f} s" if round(value) < 3600 else f"{value / 3600:.1f} h"


def length(value: float) -> str:
    """Return a limit in its shortest form: ``0.35 s``."""
    return f"{value:.12g} s" if math.isfinite(value) else "no limit"


def shown(value: object, unit: str = "", factor: Tuple[int, int] = (1, 1)) -> str:
    """Return a value as a sentence shows it: ``1.2 m``, ``true``, ``fog``; empty for no value.

    A number is in the unit once it has been multiplied by the factor.
    """
    given = plain(value)
    if isinstance(given, bool):
        return str(given).lower()
    if isinstance(given, str) or given is None:
        return (given or "")[:60]
    try:
        return f"{figure(given * factor[0] / factor[1])} {unit}".rstrip()
    except OverflowError:
        return "a number that is too large"


def figure(value: float) -> str:
    """Return a number with three digits: ``0.00399``, ``55``, ``4.0e-6``."""
    size = abs(value)
    if size == 0 or not math.isfinite(value):
        return "0" if size == 0 else "NaN" if size != size else f"{value}"  # noqa: PLR0124 - NaN
    if size < 0.001 or round(size) >= 1e6:
        digits, _, exponent = f"{value:.1e}".partition("e")
        return f"{digits}e{int(exponent)}"
    return f"{value:.3g}" if size < 999.5 else f"{value:.0f}"
