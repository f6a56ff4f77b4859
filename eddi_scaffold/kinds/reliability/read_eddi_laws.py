"""Rates and distributions of EDDI XML with their units (``failureRate``, ``ProbDist``)."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.common import units
from eddi_scaffold.eddi_xml import vocabulary as word
from eddi_scaffold.eddi_xml.document import EddiFindings
from eddi_scaffold.eddi_xml.parsing import Element, select
from eddi_scaffold.eddi_xml.vocabulary import Spelling
from eddi_scaffold.kinds.reliability.system import Law
from eddi_scaffold.kinds.reliability.values import case_of

_OTHER_NAMES = {"fit": "value", "rate": "lambda", "eta": "scale", "beta": "shape"}
"""Of parameters of distributions."""


class Laws:
    """Reads laws of one document."""

    def __init__(self, findings: EddiFindings) -> None:
        self.document, self.findings = findings.document, findings

    def of_failure(self, failure: Element, event: str, chain: str | None) -> Law | None:
        """Return the law of a failure; ``chain`` is the model whose fail state it is."""
        subject = f"event {event!r}"
        result = (self.document.attribute(failure, word.UNAVAILABILITY) or "").strip()
        if result.strip("0. "):
            reason = f"unavailability={result} is a result at a time that is not stated"
            self.findings.report("X014.unused", failure, subject=f"{subject}: {reason}")
        if chain is not None:
            return Law("model", model=chain)
        law = self._law(failure, word.FAILURE_DISTRIBUTION, word.FAILURE_RATE, subject)
        # the metamodel writes no 0.0: a rate of zero was not given
        return None if law == Law("exponential", (0.0,)) else law

    def of_transition(self, transition: Element) -> float | None:
        """Return the rate of a transition in 1/h, None after an error."""
        subject, errors = self.document.describe(transition), self.findings.errors
        law = self._law(transition, word.RATE_DISTRIBUTION, word.RATE, subject)
        if law is not None and law.kind == "exponential":
            return law.values[0]
        if self.findings.errors == errors:
            for distribution in self.document.children(transition, word.RATE_DISTRIBUTION)[:1]:
                if not self.document.is_no_law(distribution):
                    kind = self.document.attribute(distribution, word.DISTRIBUTION_TYPE)
                    self.findings.report("X020.distribution", transition, arc=subject, kind=kind)
                    return None
            self.findings.report("X020.no_rate", transition, subject=subject)
        return None

    def _law(
        self, element: Element, feature: Spelling, rate_feature: Spelling, subject: str
    ) -> Law | None:
        """Return the law by the distribution, which counts where a rate is given, too."""
        distribution = self.findings.only(element, feature)
        text, name = self.document.attribute(element, rate_feature), rate_feature.name
        try:
            if distribution is not None and not self.document.is_no_law(distribution):
                if text and text.strip("0. "):  # EMF may write what is not given
                    self.findings.report("X014.rate", distribution, subject=subject, rate=name)
                return self._distribution(distribution, subject)
            return Law("exponential", (self._number(element, text, subject),)) if text else None
        except units.QuantityError as fault:
            case = case_of(fault)
            self.findings.report(case, element, hint=fault.hint, subject=subject, reason=fault)
            return None

    def _distribution(self, element: Element, subject: str) -> Law | None:
        kind = (self.document.attribute(element, word.DISTRIBUTION_TYPE) or "").strip()
        parameters: dict[str, list[Element]] = {}
        for child in self.document.children(element, word.PARAMETERS):
            name = (self.document.attribute(child, word.NAME) or "").casefold()
            parameters.setdefault(_OTHER_NAMES.get(name, name), []).append(child)
        texts = {
            name: self.document.attribute(first, word.VALUE) or ""
            for name, elements in parameters.items()
            if (first := self.findings.first(elements)) is not None
        }
        repair = {name: texts.get(name, "") for name in ("repair rate", "mttr")}
        if any(text.strip("0. ") for text in repair.values()):
            self.findings.report("X014.repair", element, subject=subject)
        match kind.casefold():
            case "fit" | "constant" if "value" in texts:
                return Law("exponential", (units.rate(texts["value"], "FIT").value,))
            case "fixed" | "constant" if "p" in texts:
                return Law("fixed", (units.number(texts["p"], 0.0, 1.0),))
            case "constant" | "mttr" if texts.get("failure rate"):
                return Law("exponential", (self._number(element, texts["failure rate"], subject),))
            case "mttf" | "mttfmttr" if texts.get("mttf"):
                hours = self._number(element, texts["mttf"], subject, of_rate=False)
                if hours <= 0.0:
                    raise units.QuantityError(f"the MTTF {texts['mttf']!r} is not above 0")
                return Law("exponential", (1.0 / hours,))
            case "fixed" if texts.get("unavailability"):
                return Law("fixed", (units.number(texts["unavailability"], 0.0, 1.0),))
            case "exponential" if texts.get("lambda"):
                return Law("exponential", (self._number(element, texts["lambda"], subject),))
            case "weibull" if (scale := texts.get("scale")) and (shape := texts.get("shape")):
                hours = self._number(element, scale, subject, of_rate=False)
                if hours <= 0.0:
                    raise units.QuantityError(f"the scale {scale!r} is not above 0")
                return Law("weibull", (hours, units.number(shape, 1e-6, 1e6)))
        laws = ", ".join(f"{name}={text}" for name, text in texts.items())
        fields = {"distribution": kind, "laws": laws}
        self.findings.report("X014.distribution", element, subject=subject, **fields)
        return None

    def _number(self, element: Element, text: str, subject: str, *, of_rate: bool = True) -> float:
        read = units.rate if of_rate else units.duration
        value, has_unit = read(text, self._unit(element, of_rate=of_rate))
        if not has_unit:
            fields: dict[str, Any] = {"subject": subject, "unit": "1/h" if of_rate else "h"}
            self.findings.report("R004.no_unit_in_eddi", element, value=value, **fields)
        return value

    def _unit(self, element: Element, *, of_rate: bool) -> str | None:
        """Return the unit of the element, or of the innermost element around it that has one."""
        node: Element | None = element
        while node is not None:
            unit = self.findings.key_value(node, "unit")
            if unit:
                is_of_rate = units.rate_factor(unit) is not None
                if is_of_rate == of_rate or not (is_of_rate or units.hours_factor(unit)):
                    return unit  # an unknown unit is reported
            time = self.findings.key_value(node, "timeUnit")
            if time:
                return f"1/{time}" if of_rate else time
            node = node.getparent()
        return None


_RELATED = "descendant-or-self::*[@ccfFailures or @causedBy or ccfFailures or causedBy]"


class CommonCauses:
    """Which failures are caused by which others: by ``causedBy``, or ``ccfFailures`` of these."""

    def __init__(self, findings: EddiFindings) -> None:
        self._findings = findings
        self._causes: dict[Element, list[Element]] = {}
        self._related: set[Element] = set()
        roots = findings.document.roots
        for failure in [element for root in roots for element in select(root, _RELATED)]:
            pairs = [(failure, c) for c in findings.targets(failure, word.CAUSED_BY, word.FAILURES)]
            members = findings.targets(failure, word.CCF_FAILURES, word.FAILURES)
            for member, cause in [*pairs, *((member, failure) for member in members)]:
                self._causes.setdefault(member, []).append(cause)
                self._related |= {member, cause}

    def warn_alone(self, failure: Element, subject: str) -> None:
        """Warn of a common cause of which the file does not say what it causes."""
        document = self._findings.document
        is_stated = (document.attribute(failure, word.IS_CCF) or "").strip().lower() == "true"
        is_ccf = is_stated or document.class_of(failure).name == "commoncausefailure"
        if is_ccf and failure not in self._related:
            self._findings.report("R013.common_causes", failure, subject=subject)

    def of(self, failure: Element) -> list[Element]:
        """Return the common causes of a failure, and theirs."""
        causes = dict.fromkeys(self._causes.get(failure, ()))
        for cause in (waiting := list(causes)):
            new = [other for other in self._causes.get(cause, ()) if other not in causes]
            causes.update(dict.fromkeys(new))
            waiting += new
        causes.pop(failure, None)
        return list(causes)
