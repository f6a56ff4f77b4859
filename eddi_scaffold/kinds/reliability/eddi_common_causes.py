"""Common causes of an EDDI: events of their own, which each failure that they cause includes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eddi_scaffold.kinds.reliability.model import Gate
from eddi_scaffold.problems import Place
from eddi_scaffold.readers import vocabulary as word
from eddi_scaffold.readers.document import EddiDocument
from eddi_scaffold.readers.findings import EddiFindings
from eddi_scaffold.readers.xmi import Element, select

_CLASS = "commoncausefailure"
_RELATED = "descendant-or-self::*[@ccfFailures or @causedBy or ccfFailures or causedBy]"


class CommonCauses:
    """Which failures are caused by which others: by ``causedBy``, or ``ccfFailures`` of these."""

    def __init__(self, document: EddiDocument, findings: EddiFindings) -> None:
        self._document, self._findings = document, findings
        self._causes: dict[Element, dict[Element, None]] = {}
        self._related: set[Element] = set()
        for failure in [one for root in document.roots for one in select(root, _RELATED)]:
            for cause in findings.targets(failure, word.CAUSED_BY, word.FAILURES):
                self._relate(failure, cause)
            for member in findings.targets(failure, word.CCF_FAILURES, word.FAILURES):
                self._relate(member, failure)

    def of(self, failure: Element) -> list[Element]:
        """Return the common causes of a failure, and theirs."""
        found = dict(self._causes.get(failure, {}))
        for cause in (waiting := list(found)):
            new = [one for one in self._causes.get(cause, ()) if one not in found]
            found.update(dict.fromkeys(new))
            waiting += new
        found.pop(failure, None)
        return list(found)

    def warn_alone(self, failure: Element, what: str) -> None:
        """Warn of a common cause of which the file does not say what it causes."""
        stated = (self._document.attribute(failure, word.IS_CCF) or "").strip().lower() == "true"
        is_ccf = stated or self._document.class_of(failure).name == _CLASS
        if is_ccf and failure not in self._related:
            message = f"{what} has common causes, which are not analysed"
            self._findings.warning("R013", message, failure)

    def _relate(self, member: Element, cause: Element) -> None:
        self._causes.setdefault(member, {})[cause] = None
        self._related |= {member, cause}


def joined(
    gates: Mapping[str, Gate], shared: Mapping[str, list[str]], places: Mapping[str, Place]
) -> tuple[dict[str, Gate], Mapping[str, str]]:
    """Return gates in which each event that has common causes occurs with any of these, too.

    Args:
        gates: of the tree, by id.
        shared: event -> its common causes, all of them events.
        places: of these events.

    Returns:
        All gates, and event -> the gate that stands for it.
    """
    instead: dict[str, str] = {}
    for event, causes in shared.items():
        name = " or ".join([event, *causes])
        while name in gates or name in instead.values():
            name += "'"
        instead[event] = name
    found = {
        key: replace(gate, of=tuple(instead.get(one, one) for one in gate.of))
        for key, gate in gates.items()
    }
    for event, name in instead.items():
        found[name] = Gate(name, "OR", (event, *shared[event]), place=places[event])
    return found, instead
