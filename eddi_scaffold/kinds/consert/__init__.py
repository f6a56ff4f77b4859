"""The kind ``consert``: conditional safety certificates, evaluated while the system runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eddi_scaffold.kinds import Functions, Kind
from eddi_scaffold.kinds.consert.messages import BETWEEN_ROBOTS, MESSAGES, VERDICTS
from eddi_scaffold.kinds.consert.options import KEYS

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source
    from eddi_scaffold.kinds.consert.model import ConSertModel

_SUFFIXES = (".yml", ".yaml", ".json")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:guarantees|tree_propagations|(?:provided|required)_services)"""
    rb"""["']?\s*:"""
)


def _sniff(source: Source) -> bool:
    return source.name.lower().endswith(_SUFFIXES) and _OWN_KEY.search(source.data) is not None


def _functions() -> Functions[ConSertModel]:
    from eddi_scaffold.kinds.consert.functions import FUNCTIONS  # noqa: PLC0415 - lxml

    return FUNCTIONS


KIND = Kind(
    name="consert",
    title="ConSert",
    config_types=("ConSert", "ConSerts"),
    sniff=_sniff,
    messages=MESSAGES,
    between_robots=BETWEEN_ROBOTS,
    output_message="ConSertOutput",
    verdicts=VERDICTS,
    load=_functions,
    topic="guarantees",
    in_eddi=".",  # its reader says what is misspelt, too
    options=KEYS,
    without_input="no guarantee that needs it becomes active",
)
"""What the generator knows of ConSerts."""
