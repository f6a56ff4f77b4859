"""Names that generated code derives from the ids of a ConSert.

Class and field names follow the rules of the ``Inflector`` library (0.11) that the generator of
SESAME D7.2 used, so that ``guarantee_ids: class`` publishes the ids of D7.2 Fig 9. The reserved
words are a frozen list: the same model gives the same names under every Python version.
"""

from __future__ import annotations

import re

from eddi_scaffold.common.identifiers import attribute

__all__ = [
    "IDENTIFIER",
    "RESERVED",
    "attribute",
    "class_name",
    "escaped",
    "field_name",
    "identifier",
    "is_identifier",
    "is_reserved",
    "is_usable",
    "published_class",
    "setter",
]

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

_HARD_KEYWORDS = (
    "False None True and as assert async await break class continue def del elif else except "
    "finally for from global if import in is lambda nonlocal not or pass raise return try while "
    "with yield"
)
_SOFT_KEYWORDS = "_ case match type"
RESERVED = frozenset(f"{_HARD_KEYWORDS} {_SOFT_KEYWORDS} self Unknown".split())
"""Words that no generated name may be: Python up to 3.13, ``self``, and D7.2's ``Unknown``."""


def class_name(id_: str) -> str:
    """Return the D7.2 class name of an id: ``System_A_G0_c2`` -> ``SystemAG0C2``."""
    written: list[str] = []
    starts_word = True
    remembered = ""
    for char in _trimmed(id_):
        if not char.isalnum() or char.isdigit():
            starts_word = True
            written.append(char if char.isdigit() else "")
        elif starts_word:
            starts_word = False
            written.append(_upper(char))
        elif _is_upper(char) and _is_lower(remembered):
            written.append(char)
        else:
            remembered = char
            written.append(_lower(char))
    return "".join(written)


def field_name(id_: str) -> str:
    """Return the D7.2 field name of an id: ``RtE_A_E0`` -> ``rt_e_a_e0``."""
    text = _trimmed(id_)
    written: list[str] = []
    for index, char in enumerate(text):
        previous = text[index - 1] if index else ""
        if not char.isalnum():
            written.append("_" if previous.isalnum() else "")
            continue
        following = text[index + 1 : index + 2]
        breaks = _is_upper(char) or char.isdigit()
        if breaks and previous.isalnum() and (_is_lower(previous) or _is_lower(following)):
            written.append("_")
        written.append(_lower(char))
    return "".join(written)


def setter(id_: str) -> str:
    """Return the name of the D7.2 setter of an evidence or demand: ``set_rt_e_a_e0``."""
    return f"set_{field_name(id_)}"


def is_identifier(id_: str) -> bool:
    """Return whether an id consists of ASCII letters, digits and ``_``, no digit first."""
    return IDENTIFIER.fullmatch(id_) is not None


def is_usable(id_: str) -> bool:
    """Return whether an identifier can be derived: there is an ASCII letter or digit."""
    return re.search(r"[A-Za-z0-9]", id_) is not None


def is_reserved(name: str) -> bool:
    """Return whether generated code cannot use a name as it is."""
    return name in RESERVED or name.startswith("__")


def escaped(name: str) -> str:
    """Return a name that is not reserved: with one trailing ``_`` where it would be."""
    return f"{name}_" if is_reserved(name) else name


def identifier(id_: str) -> str:
    """Return an identifier for an id that becomes no attribute: the id itself wherever possible.

    Characters outside ``[A-Za-z0-9_]`` become ``_``, a leading digit gets a ``_`` before it, and
    a reserved word one behind. The docstring of :func:`attribute` describes its result.
    """
    name = re.sub(r"[^A-Za-z0-9_]", "_", id_)
    return escaped(f"_{name}" if not name or name[0].isdigit() else name)


def published_class(id_: str) -> str:
    """Return the class name of a guarantee as it is published, escaped where it is reserved."""
    return escaped(class_name(id_))


def _trimmed(id_: str) -> str:
    kept = [index for index, char in enumerate(id_) if char.isalnum()]
    return id_[kept[0] : kept[-1] + 1] if kept else ""


def _is_upper(char: str) -> bool:
    return "A" <= char <= "Z"


def _is_lower(char: str) -> bool:
    return "a" <= char <= "z"


def _upper(char: str) -> str:
    return char.upper() if _is_lower(char) else char


def _lower(char: str) -> str:
    return char.lower() if _is_upper(char) else char
