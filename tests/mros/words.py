"""The oracles name problems by words, as this project did before they had codes."""

from __future__ import annotations

from eddi_scaffold.common.catalogue import find


def as_word(code: str) -> str:
    """Return ``surplus-brace`` for M004: the title of a code, with hyphens."""
    found = find(code)
    assert found is not None
    return found.title.replace(" ", "-")
