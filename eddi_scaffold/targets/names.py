"""Names of a model as identifiers of a target: all are different, whatever the model contains."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from eddi_scaffold.common.identifiers import RESERVED
from eddi_scaffold.common.problems import EddiError, problem

_C_WORDS = frozenset(
    re.findall(
        r"\w+",
        """auto break case char const continue default do double else enum extern float for goto if
        inline int long main register restrict return short signed sizeof static struct switch
        typedef union unsigned void volatile while bool true false""",
    )
)
_C_TYPES = frozenset(
    re.findall(
        r"\w+",
        """clock fpos intmax intptr off ptrdiff size ssize time uintmax uintptr wchar wint""",
    )
)
"""Names that are a type of the C library with ``_t`` behind them, as a monitor's struct has."""
_TAKEN = _C_WORDS | _C_TYPES | {word.lower() for word in RESERVED}
_C_INTEGER = re.compile(r"u?int(_least|_fast)?[0-9]+")


def unique_names(names: Iterable[str]) -> list[str]:
    """Return an identifier for each name, in order; ``a.b`` and ``a_b`` get different ones."""
    taken: set[str] = set()
    found = []
    for name in names:
        base = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        if not base or base[0].isdigit():
            base = f"v_{base}"
        word, number = base, 2
        while word in taken:
            word, number = f"{base}_{number}", number + 1
        taken.add(word)
        found.append(word)
    return found


def module_name(name: str) -> str:
    """Return a name in lower case that files and functions of both targets can begin with."""
    word = _plain_word(name)
    return f"{word}_monitor" if _is_taken(word) else word


def check_module_name(name: str) -> None:
    """Refuse a name that files and functions cannot begin with as it is.

    Raises:
        EddiError: with one that they can begin with (G002).
    """
    usable = module_name(name)
    if usable == name:
        return
    why = (
        "it means something else in C or Python"
        if name == _plain_word(name)
        else "lower-case ASCII letters, digits and single underscores are expected"
    )
    raise EddiError(problem("G002.unusable_name", name=name, reason=why, usable=usable))


def _plain_word(name: str) -> str:
    decomposed = unicodedata.normalize("NFKD", name.casefold())
    base = "".join(char for char in decomposed if not unicodedata.combining(char))
    word = re.sub(r"[^a-z0-9]+", "_", base).strip("_")
    return f"event_{word}".rstrip("_") if not word or word[0].isdigit() else word


def _is_taken(word: str) -> bool:
    return word in _TAKEN or _C_INTEGER.fullmatch(word) is not None
