"""State machines of the public metamodel, which are Markov chains where all they have is rates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.readers import vocabulary as word

if TYPE_CHECKING:
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.readers.xmi import Element


def is_chain(document: EddiDocument, machine: Element) -> bool:
    """Tell whether every transition has a rate, and none a trigger."""
    transitions = document.children(machine, word.TRANSITIONS)
    return bool(transitions) and all(
        has_rate(document, one) and not has_trigger(document, one) for one in transitions
    )


def has_rate(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition has a rate; EMF may write the zero that was not given."""
    if (document.attribute(transition, word.RATE) or "").strip("0. "):
        return True
    laws = document.children(transition, word.RATE_DISTRIBUTION)
    return any(not is_none(document, law) for law in laws)


def has_trigger(document: EddiDocument, transition: Element) -> bool:
    """Tell whether a transition waits for an event."""
    given = (document.attribute(transition, word.TRIGGERS) or "").strip()
    return bool(given or document.children(transition, word.TRIGGERS))


def is_none(document: EddiDocument, distribution: Element) -> bool:
    """Tell whether a distribution says that there is none."""
    stated = (document.attribute(distribution, word.DISTRIBUTION_TYPE) or "").strip().casefold()
    return stated in ("", "none") and not document.children(distribution, word.PARAMETERS)
