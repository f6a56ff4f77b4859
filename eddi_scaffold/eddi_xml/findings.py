"""Collects the problems of one document while it is read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import only

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.parsing import Element
    from eddi_scaffold.eddi_xml.vocabulary import Spelling


class EddiFindings:
    """Problems in the order in which they were found; equal remarks are counted, not repeated."""

    def __init__(self, document: EddiDocument) -> None:
        self.document = document
        self.errors = 0
        """Number of errors found so far, so that a caller knows whether its part has one."""
        self._problems: list[Problem] = []
        self._counted: dict[Problem, tuple[Place, int]] = {}

    def add(self, *problems: Problem) -> None:
        """Take over problems."""
        self._problems += problems
        self.errors += sum(p.level == "error" for p in problems)

    def report(
        self, case: str, element: Element, /, *, hint: str | None = None, **fields: object
    ) -> None:
        """Report a problem at an element."""
        self.add(problem(case, self.document.place(element), hint=hint, **fields))

    def count(self, case: str, element: Element, times: int = 1, /, **fields: Any) -> None:
        """Report a remark once per file, at its first place, with how often it applies."""
        remark = problem(case, **fields)
        place, before = self._counted.get(remark) or (self.document.place(element), 0)
        self._counted[remark] = (place, before + times)

    def only(self, parent: Element, spelling: Spelling) -> Element | None:
        """Return the child in a feature that may hold one; report others (X011)."""
        children = self.document.children(parent, spelling)
        first, problems = only(children, "X011.twice", self.document.place)
        self.add(*problems)
        return first

    def targets(self, element: Element, link: Spelling, wanted: Spelling) -> list[Element]:
        """Return what a feature refers to; report what is in another feature (X009)."""
        found, problems, _ = self.document.targets(element, link)
        self.add(*problems)
        for target in found:
            if not wanted.accepts(self.document.feature(target)):
                shown = self.document.describe(target)
                self.report(
                    "X009.expected", element, link=link.name, actual=shown, expected=wanted.name
                )
        return [one for one in found if wanted.accepts(self.document.feature(one))]

    def problems(self) -> list[Problem]:
        """Return everything that was found."""
        counted = [
            replace(
                remark,
                message=remark.message + (f" ({times} times)" if times > 1 else ""),
                place=place,
            )
            for remark, (place, times) in self._counted.items()
        ]
        return [*dict.fromkeys(self._problems), *counted]
