"""Class names that SESAME D7.2 derives from the ids of a ConSert.

They follow the rules of the ``Inflector`` library (0.11) that its generator used, so that
``guarantee_ids: class`` publishes the ids of D7.2 Fig 9.
"""

from __future__ import annotations

from eddi_scaffold.common.identifiers import RESERVED


def class_name(id_: str) -> str:
    """Return the D7.2 class name of an id: ``System_A_G0_c2`` -> ``SystemAG0C2``."""
    name, starts_word, last = "", True, ""
    for char in id_:
        if not char.isalnum() or char.isdigit():
            starts_word = True
            name += char if char.isdigit() else ""
        elif starts_word:
            starts_word = False
            name += char.upper() if char.isascii() else char
        elif "A" <= char <= "Z" and "a" <= last <= "z":
            name += char
        else:
            last = char
            name += char.lower() if char.isascii() else char
    return name


def published_class(id_: str) -> str:
    """Return the class name of a guarantee as it is published, with ``_`` where it is reserved."""
    name = class_name(id_)
    # D7.2 has a class of that name
    return f"{name}_" if name in RESERVED or name == "Unknown" else name
