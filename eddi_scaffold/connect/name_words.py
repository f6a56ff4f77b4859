"""Names as words, and how far two words mean the same."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from itertools import takewhile

Synonyms = frozenset[frozenset[str]]
"""Groups of words; those of a group mean the same."""
_SYNONYMS: Synonyms = frozenset(
    frozenset(group.split())
    for group in (
        "speed velocity vel",
        "distance range clearance proximity dist",
        "scan laser lidar",
        "battery bms charge power soc",
        "temperature temp",
        "humidity moisture",
        "position pose localization localisation amcl location",
        "odometry odom",
        "left port",
        "right starboard",
        "obstacle obstacles",
        "health healthy ok good diagnostics diagnostic status",
        "person human pedestrian people",
        "detected detection detections boxes",
        "yaw heading",
        "uncertainty covariance deviation std variance accuracy",
        "gps gnss navsat global",
        "ground rangefinder altitude height",
        "current amps",
        "voltage volts cell",
        "joint joints",
        "torque effort",
        "valid safe",
    )
)
_SAME = {"ahead": "front", "forward": "front", "fwd": "front", "back": "rear", "behind": "rear"}
_SAYING_NOTHING = frozenset([
    "the", "is", "a", "of", "in", "to", "and", "an", "are", "data", "eddi", "input", "value",
    "state", "rt", "msg", "nearest", "minimum", "min", "max", "vehicle", "robot", "system",
    "sensor", "monitor", "node", "topic", "measured", "actual", "ambient",
])  # fmt: skip
_BREAK = re.compile(r"[^A-Za-z0-9]+|(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_LONG = 4
_COMMON = 5
MEANS_THE_SAME = 0.7
"""From this match on, a word is taken for another one."""


@cache
def words(text: str) -> tuple[str, ...]:
    """Split a name or a sentence into words: lower case, one word for each direction."""
    return tuple(_SAME.get(word, word) for word in map(str.lower, _BREAK.split(text)) if word)


def telling(text: str) -> list[str]:
    """Return the words of an input that tell what it is; all of them where none does."""
    every = list(dict.fromkeys(words(text)))
    return [word for word in every if word not in _SAYING_NOTHING] or every


@cache
def match(first: str, second: str, more: Synonyms = frozenset()) -> float:
    """Return how far two words mean the same, from 0 to 1; ``more`` are synonyms of the robot."""
    if first == second:
        return 1.0
    if any(first in group and second in group for group in _SYNONYMS | more):
        return 0.8
    shorter = min(len(first), len(second))
    common = sum(
        1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False))
    )
    if shorter >= _LONG and common == shorter:
        return 0.7
    return 0.6 if common >= _COMMON and 2 * common >= max(len(first), len(second)) else 0.0


def best(word: str, others: Iterable[str], more: Synonyms = frozenset()) -> float:
    """Return the best match of a word among others."""
    return max((match(word, other, more) for other in others), default=0.0)
