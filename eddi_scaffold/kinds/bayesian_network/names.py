"""Names of nodes and states in Python and in XDSL; everything else keeps them as they are."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from eddi_scaffold.identifiers import free_name
from eddi_scaffold.kinds.bayesian_network.model import Network

_ASCII_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def identifiers(names: Iterable[str]) -> list[str]:
    """Return the part behind ``node_`` or ``outcome_`` for each name, unique, in order.

    Letters of any script stay, as in SESAME D7.2; what is not allowed in an identifier becomes an
    underscore, and who comes later to a taken name gets a number.
    """
    taken: set[str] = set()
    found = []
    for name in names:
        text = unicodedata.normalize("NFKC", name)
        word = "".join(char if f"_{char}".isidentifier() else "_" for char in text) or "_"
        found.append(free_name(word, taken))
        taken.add(found[-1])
    return found


def node_attributes(network: Network) -> dict[str, str]:
    """Return node -> the part of its method's name behind ``node_``."""
    names = network.names()
    return dict(zip(names, identifiers(names), strict=True))


def xdsl_ids(names: Iterable[str]) -> dict[str, str]:
    """Return name -> id of XDSL: ASCII letters, digits and underscores, no digit in front."""
    taken: set[str] = set()
    found: dict[str, str] = {}
    for name in names:
        if _ASCII_ID.fullmatch(name) and name not in taken:
            found[name] = name
            taken.add(name)
    for name in names:
        if name not in found:
            word = re.sub(r"[^A-Za-z0-9_]", "_", unicodedata.normalize("NFKC", name)) or "_"
            found[name] = free_name(f"n_{word}" if word[0].isdigit() else word, taken)
            taken.add(found[name])
    return found
