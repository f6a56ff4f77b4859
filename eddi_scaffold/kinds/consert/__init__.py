"""The kind ``consert``: conditional safety certificates, evaluated while the system runs.

``Guarantee`` and ``ConSertOutput`` are frozen: packages made by the tools of SESAME D7.2 and
their consumers use them, and any change of a field changes the MD5 and cuts all of them off.
Facts that D7.2 does not publish are in separate messages.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.common.identifiers import RESERVED
from eddi_scaffold.kinds import ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

OPTION_KEYS = ("guarantee_ids", "debounce", "filter")  # Keys of `Model:` in a configuration

BETWEEN_ROBOTS = messages_in(__path__[0], "between_robots")
"""Messages that a workspace has where its robot is one of a fleet, as ``MESSAGES``."""
MESSAGES = messages_in(__path__[0])  # ROS message name -> text of its `.msg` file
_UNKNOWN, _TRUE = 1, 2


def _status(status: Any) -> StatusReading:
    verdicts = tuple(
        Verdict(
            guarantee.id,
            state_of(active=guarantee.verdict == _TRUE, known=guarantee.verdict != _UNKNOWN),
            tuple(guarantee.missing),
        )
        for guarantee in status.guarantees
    )
    return StatusReading(verdicts, status.model_id, status.model_digest, tuple(status.accepted))


_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:guarantees|tree_propagations|(?:provided|required)_services)"""
    rb"""["']?\s*:"""
)


def _recognises(source: Source) -> bool:
    is_yaml = source.name.lower().endswith((".yml", ".yaml", ".json"))
    return is_yaml and _OWN_KEY.search(source.data) is not None


def class_name(id_: str) -> str:
    """Return the class name that SESAME D7.2 derives from an id: ``System_A_c2`` -> ``SystemAC2``.

    By the rules of the ``Inflector`` library (0.11) that its generator used (Fig 9).
    """
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


KIND = Kind(
    name="consert",
    title="ConSert",
    config_types=("ConSert", "ConSerts"),
    recognises=_recognises,
    messages=MESSAGES,
    between_robots=BETWEEN_ROBOTS,
    output_message="ConSertOutput",
    verdicts={"ConSertStatus": _status},
    model="consert_model.ConSertModel",
    topic="guarantees",
    claim=ClaimField("ConSertOutput", "guarantees[{}].active", d72=published_class),
    in_eddi=".",  # its reader says what is misspelt, too
    options=OPTION_KEYS,
    wire_of_d72={"guarantee_ids": "class"},
    without_input="no guarantee that needs it becomes active",
)
"""What the generator knows of ConSerts."""
