"""Rates and distributions of EDDI XML with their units (``failureRate``, ``ProbDist``)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.problems import Place
from eddi_scaffold.common.units import (
    Quantity,
    QuantityError,
    duration,
    is_time_unit,
    number,
    rate,
    rate_factor,
)
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.findings import EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, only, select
from eddi_scaffold.eddi_xml.survey import is_none
from eddi_scaffold.eddi_xml.vocabulary import Spelling
from eddi_scaffold.kinds.reliability.system import Gate, Law
from eddi_scaffold.kinds.reliability.values import case_of


class Laws:
    """Reads laws of one document."""

    def __init__(self, document: EddiDocument, findings: EddiFindings) -> None:
        self._document, self._findings = document, findings

    def key_value(self, element: Element, key: str) -> str | None:
        """Return the value of a key of an element, None where it has none."""
        values = [
            value
            for child in self._document.children(element, word.KEY_VALUE_MAPS)
            if (self._document.attribute(child, word.KEY) or "").casefold() == key.casefold()
            for value in self._document.children(child, word.VALUES)
        ]
        value = self._only(values)
        return (
            (self._document.attribute(value, word.VALUE) or "").strip()
            if value is not None
            else None
        )

    def _only(self, elements: Sequence[Element]) -> Element | None:
        first, problems = only(elements, "X011.twice", self._document.place)
        self._findings.add(*problems)
        return first

    def law(self, failure: Element, event: str, chain: str | None) -> Law | None:
        """Return the law of a failure; ``chain`` is the model whose fail state it is."""
        what = f"event {event!r}"
        result = (self._document.attribute(failure, word.UNAVAILABILITY) or "").strip()
        if result.strip("0. "):
            message = f"{what}: unavailability={result} is a result at a time that is not stated"
            self._findings.report("X014.unused", failure, subject=message)
        if chain is not None:
            return Law("model", model=chain)
        given = self._document.attribute(failure, word.FAILURE_RATE)
        distribution = self._distribution_of(
            failure, word.FAILURE_DISTRIBUTION, word.FAILURE_RATE, what
        )
        try:
            if distribution is not None:
                return self._distribution(distribution, what)
            plain = self._rate(failure, given, what) if given else None
        except QuantityError as wrong:
            self._findings.report(
                case_of(wrong), failure, hint=wrong.hint, subject=what, reason=wrong
            )
            return None
        # the metamodel writes no 0.0: a rate of zero was not given
        return Law("exponential", (plain,)) if plain else None

    def transition(self, element: Element) -> float | None:
        """Return the rate of a transition in 1/h, None after an error."""
        what = self._document.describe(element)
        given = self._document.attribute(element, word.RATE)
        distribution = self._distribution_of(element, word.RATE_DISTRIBUTION, word.RATE, what)
        try:
            if distribution is not None:
                law = self._distribution(distribution, what)
                if law is not None and law.kind == "exponential":
                    return law.values[0]
                kind = self._document.attribute(distribution, word.DISTRIBUTION_TYPE)
                self._findings.report("X020.distribution", element, arc=what, kind=kind)
                return None
            if given is not None:
                return self._rate(element, given, what)
        except QuantityError as wrong:
            self._findings.report(
                case_of(wrong), element, hint=wrong.hint, subject=what, reason=wrong
            )
            return None
        self._findings.report("X020.no_rate", element, subject=what)
        return None

    def _distribution_of(
        self, element: Element, feature: Spelling, rate_: Spelling, what: str
    ) -> Element | None:
        """Return the distribution, which counts where a rate is given, too."""
        found = self._only(self._document.children(element, feature))
        if found is not None and is_none(self._document, found):
            return None
        given = self._document.attribute(element, rate_)
        if found is not None and given and given.strip("0. "):  # EMF may write what is not given
            self._findings.report("X014.rate", found, subject=what, rate=rate_.name)
        return found

    def _distribution(self, element: Element, what: str) -> Law | None:
        given = (self._document.attribute(element, word.DISTRIBUTION_TYPE) or "").strip()
        parameters: dict[str, list[Element]] = {}
        for child in self._document.children(element, word.PARAMETERS):
            name = (self._document.attribute(child, word.NAME) or "").casefold()
            parameters.setdefault(_ALSO.get(name, name), []).append(child)
        for same in parameters.values():
            self._only(same)
        texts = {
            name: self._document.attribute(same[0], word.VALUE) or ""
            for name, same in parameters.items()
        }
        kind = given.casefold()
        if kind in ("fit", "constant") and "value" in texts:
            return Law("exponential", (rate(texts["value"], "FIT").value,))
        if kind in ("fixed", "constant") and "p" in texts:
            return Law("fixed", (number(texts["p"], 0.0, 1.0),))
        if kind == "exponential":
            text = texts.get("lambda")
            if text:
                return Law("exponential", (self._rate(element, text, what),))
        if kind == "weibull":
            scale, shape = texts.get("scale"), texts.get("shape")
            if scale and shape:
                hours = duration(scale, self._unit(element, of_rate=False))
                self._assumed(hours, element, what, "h")
                if hours.value <= 0.0:
                    raise QuantityError(f"the scale {scale!r} is not above 0")
                return Law("weibull", (hours.value, number(shape, 1e-6, 1e6)))
        shown = ", ".join(f"{name}={text}" for name, text in texts.items())
        self._findings.report(
            "X014.distribution", element, subject=what, distribution=given, laws=shown
        )
        return None

    def _rate(self, element: Element, text: str, what: str) -> float:
        found = rate(text, self._unit(element, of_rate=True))
        self._assumed(found, element, what, "1/h")
        return found.value

    def _assumed(self, found: Quantity, element: Element, what: str, unit: str) -> None:
        if not found.has_unit:
            self._findings.report(
                "R004.no_unit_in_eddi", element, subject=what, value=found.value, unit=unit
            )

    def _unit(self, element: Element, *, of_rate: bool) -> str | None:
        """Return the unit of the element, or of the nearest element that contains it."""
        node: Element | None = element
        while node is not None:
            unit = self.key_value(node, "unit")
            fits = unit and (of_rate == (rate_factor(unit) is not None))
            if unit and (fits or (rate_factor(unit) is None and not is_time_unit(unit))):
                return unit  # an unknown unit is reported
            time = self.key_value(node, "timeUnit")
            if time:
                return f"1/{time}" if of_rate else time
            node = node.getparent()
        return None


_ALSO = {"fit": "value", "rate": "lambda", "eta": "scale", "beta": "shape"}
"""Other names of parameters."""


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
            self._findings.report("R013.common_causes", failure, subject=what)

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
