"""Collects the problems of one document while it is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Level, Place, Problem
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
        self._counted: dict[tuple[Level, str, str], tuple[Place, int]] = {}

    def add(self, *problems: Problem) -> None:
        """Take over problems."""
        self._problems += problems
        self.errors += sum(p.level == "error" for p in problems)

    def error(self, code: str, message: str, element: Element, hint: str | None = None) -> None:
        """Report an error at an element."""
        self.add(Problem("error", code, message, self.document.place(element), hint))

    def warning(self, code: str, message: str, element: Element, hint: str | None = None) -> None:
        """Report a warning at an element."""
        self.add(Problem("warning", code, message, self.document.place(element), hint))

    def count(
        self, level: Level, code: str, message: str, element: Element, times: int = 1
    ) -> None:
        """Report a remark once per file, at its first place, with how often it applies."""
        place, before = self._counted.get((level, code, message), (None, 0))
        if place is None:
            place = self.document.place(element)
        self._counted[level, code, message] = (place, before + times)

    def only(self, parent: Element, spelling: Spelling) -> Element | None:
        """Return the child in a feature that may hold one; report others (X011)."""
        children = self.document.children(parent, spelling)
        first, problems = only(children, "X011", self.document.place)
        self.add(*problems)
        return first

    def targets(self, element: Element, link: Spelling, wanted: Spelling) -> list[Element]:
        """Return what a feature refers to; report what is in another feature (X009)."""
        found, problems, _ = self.document.targets(element, link)
        self.add(*problems)
        for target in found:
            if not wanted.accepts(self.document.feature(target)):
                shown = self.document.describe(target)
                message = f"{link.name} points at {shown}, expected one of {wanted.name}"
                self.error("X009", message, element)
        return [one for one in found if wanted.accepts(self.document.feature(one))]

    def problems(self) -> list[Problem]:
        """Return everything that was found."""
        counted = [
            Problem(level, code, message + (f" ({times} times)" if times > 1 else ""), place)
            for (level, code, message), (place, times) in self._counted.items()
        ]
        return [*dict.fromkeys(self._problems), *counted]
