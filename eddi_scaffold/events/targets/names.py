"""Names of a model as identifiers of a target: each is another one, whatever the model says."""

from __future__ import annotations

import re
from collections.abc import Iterable

_C_WORDS = frozenset(
    re.findall(
        r"\w+",
        """auto break case char const continue default do double else enum extern float for goto if
        inline int long main register restrict return short signed sizeof static struct switch
        typedef union unsigned void volatile while bool true false""",
    )
)


def unique_names(names: Iterable[str], prefix: str = "") -> list[str]:
    """Return an identifier for each name, in order; ``a.b`` and ``a_b`` get different ones."""
    taken: set[str] = set()
    found = []
    for name in names:
        base = prefix + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
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
    word = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    if not word or word[0].isdigit():
        word = f"event_{word}".rstrip("_")
    return f"{word}_" if word in _C_WORDS else word


def one_line(text: str) -> str:
    """Return a text that can stand in a comment or a docstring of any target."""
    plain = re.sub(r"[^ -~]+", " ", text).replace("\\", "/").replace('"', "'")
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").strip()
