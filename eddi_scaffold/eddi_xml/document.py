"""A parsed EDDI: its objects, their classes, features, references and places."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import (
    XSI_TYPE,
    Element,
    Limits,
    XmlDocument,
    feature_of,
    line_of,
)
from eddi_scaffold.eddi_xml.references import References, parse_fragment, parse_token
from eddi_scaffold.eddi_xml.vocabulary import ClassName, Spelling, fold, package_key

_BLANK = re.compile(r"[ \t\r\n]+")


class EddiDocument:
    """A parsed EDDI.

    Attributes:
        name: path as the user gave it.
        document: the document element.
        roots: the root objects; several only below ``xmi:XMI``.
        references: resolver of this document.
        limits: limits that reading obeys.
    """

    def __init__(self, tree: XmlDocument, name: str, limits: Limits) -> None:
        self.name = name
        self.document = tree.document
        self.roots = tree.roots
        self.limits = limits
        self.references = References(tree.roots)
        self._documents = frozenset((tree.document, *tree.roots))

    def place(self, element: Element) -> Place:
        """Return the place of an element: file, line and canonical fragment path."""
        return Place(self.name, line_of(element), None, self.references.path(element))

    def class_of(self, element: Element) -> ClassName:
        """Return the class that an element states: by ``xsi:type``, or by its tag at a root."""
        printed = element.get(XSI_TYPE)
        if printed is None:
            if not self.is_root(element):
                return ClassName()
            name, uri = feature_of(element), _namespace(str(element.tag))
            printed = f"{element.prefix}:{name}" if element.prefix else name
        else:
            prefix, _, name = printed.strip().rpartition(":")
            uri = element.nsmap.get(prefix or None) or prefix
        return ClassName(package_key(uri), fold(name), printed)

    def is_root(self, element: Element) -> bool:
        """Return whether an element is a root object, or the ``xmi:XMI`` above the roots."""
        return element in self._documents

    def at(self, path: str) -> Element | None:
        """Return the element at a canonical path, ``None`` when there is none."""
        fragment = parse_fragment(path)
        return self.references.resolve(fragment) if fragment is not None else None

    def feature(self, element: Element) -> str:
        """Return the name of the feature that contains an element."""
        return feature_of(element)

    def describe(self, element: Element) -> str:
        """Return class, or else feature, and name of an element, for messages."""
        kind = self.class_of(element).printed or feature_of(element)
        name = element.get("name")
        return f'{kind} "{name}"' if name else kind

    def packages(self) -> Iterator[Element]:
        """Yield the roots and the packages that they contain, in document order."""
        waiting = list(reversed(self.roots))
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed([c for c in element.iterchildren() if self.is_package(c)])

    def children(self, parent: Element, spelling: Spelling) -> list[Element]:
        """Return the children in a feature, in document order."""
        return self.references.children(parent, *sorted(spelling.folded))

    def attribute(self, element: Element, spelling: Spelling) -> str | None:
        """Return the value of an attribute, ``None`` when it is absent."""
        name = self.attribute_name(element, spelling)
        return element.get(name) if name is not None else None

    def attribute_name(self, element: Element, spelling: Spelling) -> str | None:
        """Return an attribute's name as the file has it, ``None`` when it is absent."""
        for name in (spelling.name, *spelling.also):
            if name in element.attrib:
                return name
        for name in map(str, element.attrib):
            if not name.startswith("{") and spelling.accepts(name):
                return name
        return None

    def targets(
        self, element: Element, spelling: Spelling
    ) -> tuple[list[Element], list[Problem], bool]:
        """Resolve the references of one feature, written as attribute or as ``href`` children.

        Returns:
            The elements pointed at, the problems X003 and X007, and whether there was
            any reference at all.
        """
        name = self.attribute_name(element, spelling)
        own = _BLANK.split(element.get(name) or "") if name else []
        given = [(name or "", text) for text in own]
        given += [(feature_of(c), c.get("href") or "") for c in self.children(element, spelling)]
        texts = [(feature, text) for feature, text in given if text]
        limit = self.limits.reference_tokens
        if len(texts) > limit:
            return (
                [],
                [
                    problem(
                        "X003.references",
                        self.place(element),
                        feature=spelling.name,
                        number=len(texts),
                        limit=limit,
                    )
                ],
                True,
            )
        found: list[Element] = []
        problems: list[Problem] = []
        for feature, text in texts:
            target = self.target(element, feature, text)
            if isinstance(target, Problem):
                problems.append(target)
            else:
                found.append(target)
        return found, problems, bool(texts)

    def target(self, element: Element, feature: str, text: str) -> Element | Problem:
        """Resolve one reference of a feature of an element."""
        token = parse_token(text)
        if token.resource:
            return problem(
                "X007.resource",
                self.place(element),
                feature=feature,
                token=token.text,
                file=token.resource,
            )
        if token.fragment is not None:
            target = self.references.resolve(token.fragment)
            why = "" if target is not None else self.references.explain(token.fragment)
        elif token.id is not None:
            same = self.references.by_id(token.id)
            target = same[0] if len(same) == 1 else None
            why = f'{len(same) or "no"} element{"s have" if same else " has"} xmi:id "{token.id}"'
        else:
            return problem("X007.token", self.place(element), feature=feature, token=token.text)
        if target is None:
            return problem(
                "X007.nothing", self.place(element), feature=feature, token=token.text, reason=why
            )
        return target

    def is_package(self, element: Element) -> bool:
        """Tell by feature and class whether an element, below a root, is a package."""
        if fold(feature_of(element)).endswith(("package", "packages")):
            return True
        printed = element.get(XSI_TYPE)
        return printed is not None and fold(printed).endswith("package")


def _namespace(tag: str) -> str:
    return tag[1:].partition("}")[0] if tag.startswith("{") else ""
