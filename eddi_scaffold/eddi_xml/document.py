"""An EDDI document: elements with classes, places and references, whatever tool wrote it.

Nothing is done per element before somebody asks, so a file costs little more than its parse.
Classes are bound by package key and class name, never by the full namespace URI: URIs and
prefixes differ between generations of one metamodel.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.eddi_xml import vocabulary as names
from eddi_scaffold.eddi_xml.eddi_editor import in_form_of_emf
from eddi_scaffold.eddi_xml.machine_json import is_machine, read_machine
from eddi_scaffold.eddi_xml.parsing import (
    MAX_REFERENCES,
    XSI_TYPE,
    Element,
    feature_of,
    line_of,
    load,
    looks_like_xml,
    only,
    select,
)
from eddi_scaffold.eddi_xml.references import References, parse_fragment
from eddi_scaffold.eddi_xml.vocabulary import (
    METAMODEL,
    ClassName,
    Spelling,
    fold,
    package_key,
)

CLASSES = {group: text.split() for group, text in METAMODEL["classes"].items()}
KNOWN_CLASSES = frozenset(
    fold(name) for group in ("models", "packages", "others") for name in CLASSES[group]
)
_READ_NAMES = {fold(name): name for name in (*CLASSES["packages"], *CLASSES["models"])}
_MODELS = f"known are: {', '.join(CLASSES['models'])}"
_COMPLETELY_KNOWN = ("failurelogic", "bayesiannetwork")  # packages: every class should be known
_SIMILAR = 0.8
MONITORED = frozenset(
    {"bayesian_network", "consert", "fault_tree", "markov_chain", "state_machine"}
)
"""Kinds of models that monitors are made of."""
_BY_CLASS: Mapping[str, str] = METAMODEL["kinds"]
_BY_FEATURE: Mapping[str, str] = METAMODEL["kinds_of_features"]


class EddiDocument:
    """A parsed EDDI."""

    def __init__(
        self,
        document: Element,
        name: str,
        origins: Mapping[Element, Place] = MappingProxyType({}),
    ) -> None:
        self.name, self.document = name, document
        self.origins = origins  # of a file in another form: element -> its place in the file
        is_xmi = feature_of(document) == "XMI"  # the element around several roots
        self.roots = tuple(document.iterchildren()) if is_xmi else (document,)
        self.references = References(self.roots)
        self._documents = frozenset((document, *self.roots))

    def place(self, element: Element) -> Place:
        """Return the place of an element: file, line and canonical fragment path."""
        place = self.origins.get(element) or Place(self.name, line_of(element))
        return replace(place, path=self.references.path(element))

    def class_of(self, element: Element) -> ClassName:
        """Return the class that an element states: by ``xsi:type``, or by its tag at a root."""
        printed = element.get(XSI_TYPE)
        if printed is None:
            if not self.is_root(element):
                return ClassName()
            name, uri = feature_of(element), str(element.tag).rpartition("}")[0]
            printed = f"{element.prefix}:{name}" if element.prefix else name
        else:
            prefix, _, name = printed.strip().rpartition(":")
            uri = element.nsmap.get(prefix or None) or prefix
        return ClassName(package_key(uri.removeprefix("{")), fold(name), printed)

    def is_root(self, element: Element) -> bool:
        """Return whether an element is a root object, or the ``xmi:XMI`` above the roots."""
        return element in self._documents

    def class_or_feature(self, element: Element) -> str:
        """Return the class that an element states, else the feature that it is in."""
        return self.class_of(element).printed or feature_of(element)

    def describe(self, element: Element) -> str:
        """Return class, or else feature, and name of an element, for messages."""
        kind, name = self.class_or_feature(element), element.get("name")
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
        """Resolve the references of a feature: ends, problems, and whether there are any."""
        name = self.attribute_name(element, spelling)
        tokens = [(name or "", text) for text in (element.get(name) or "" if name else "").split()]
        for child in self.children(element, spelling):
            tokens += [(feature_of(child), text)] if (text := child.get("href")) else []
        if len(tokens) > MAX_REFERENCES:
            place, number = self.place(element), len(tokens)
            fields: dict[str, Any] = {"feature": spelling.name, "limit": MAX_REFERENCES}
            return [], [problem("X003.references", place, number=number, **fields)], True
        resolved = [self.target(element, feature, text) for feature, text in tokens]
        ends = [end for end in resolved if not isinstance(end, Problem)]
        return ends, [end for end in resolved if isinstance(end, Problem)], bool(tokens)

    def target(self, element: Element, feature: str, text: str) -> Element | Problem:
        """Resolve one reference of a feature of an element."""
        resource, sharp, token = text.partition("#")
        fields = {"feature": feature, "token": text}
        if sharp and resource:
            return problem("X007.resource", self.place(element), **fields, file=resource)
        token = token if sharp else text
        if token and not token.startswith("/"):
            same = self.references.by_id(token)
            target = same[0] if len(same) == 1 else None
            why = f'{len(same) or "no"} element{"s have" if same else " has"} xmi:id "{token}"'
        elif (fragment := parse_fragment(token)) is not None:
            target = self.references.resolve(fragment)
            why = "" if target is not None else self.references.explain(fragment)
        else:
            return problem("X007.token", self.place(element), **fields)
        if target is None:
            return problem("X007.nothing", self.place(element), **fields, reason=why)
        return target

    def is_package(self, element: Element) -> bool:
        """Tell by feature and class whether an element, below a root, is a package."""
        if fold(feature_of(element)).endswith(("package", "packages")):
            return True
        printed = element.get(XSI_TYPE)
        return printed is not None and fold(printed).endswith("package")

    def name_of(self, element: Element) -> str:
        """Return the name; in SACM it is an object with a content, often of the part only."""
        name = self.attribute(element, names.NAME)
        if name is not None:
            return name
        query = '*[local-name()="name"]/@content'
        contents = select(element, query) or select(element, f"*/{query}")
        return str(contents[0]) if contents else ""

    def kind_of(self, element: Element) -> str | None:
        """Return the kind of the model that an element is, ``None`` when it is none."""
        feature, parent = fold(feature_of(element)), element.getparent()
        class_name = fold((element.get(XSI_TYPE) or "").rpartition(":")[2])
        kind = _BY_CLASS.get(class_name) or _BY_FEATURE.get(feature.removesuffix("s"))
        if kind is None and self.is_root(element):
            kind = _BY_CLASS.get(feature)
        if kind == "state_machine" and self._is_chain(element):
            return "markov_chain"
        if kind == "consert" and parent is not None and not self.is_root(element):
            is_in_package = self.class_of(parent).name == names.PACKAGE_CLASS
            is_there = is_in_package or names.CONFIGURATIONS.accepts(feature_of(parent))
            return kind if is_there else None
        if kind == "assurance_case":
            outer = (fold(feature_of(ancestor)) for ancestor in element.iterancestors())
            return None if any("assurancecasepackage" in feature for feature in outer) else kind
        return kind

    def is_monitored(self, element: Element) -> bool:
        """Tell whether an element is a model that monitors are made of."""
        return self.kind_of(element) in MONITORED

    def holds_models(self, element: Element) -> bool:
        """Tell whether an element is or contains a model that monitors are made of."""
        return any(self.is_monitored(each) for each in element.iter())

    def _is_chain(self, machine: Element) -> bool:
        transitions = self.children(machine, names.TRANSITIONS)
        return bool(transitions) and all(
            self.has_rate(transition)
            and not (self.attribute(transition, names.TRIGGERS) or "").strip()
            and not self.children(transition, names.TRIGGERS)
            for transition in transitions
        )

    def has_rate(self, transition: Element) -> bool:
        """Tell whether a transition has a rate; EMF may write the zero that was not given."""
        if (self.attribute(transition, names.RATE) or "").strip("0. "):
            return True
        laws = self.children(transition, names.RATE_DISTRIBUTION)
        return not all(map(self.is_no_law, laws))

    def is_no_law(self, distribution: Element) -> bool:
        """Tell whether a distribution says that there is none."""
        type_ = (self.attribute(distribution, names.DISTRIBUTION_TYPE) or "").strip().casefold()
        return type_ in ("", "none") and not self.children(distribution, names.PARAMETERS)


class EddiFindings:
    """Problems in the order in which they were found; equal remarks are counted, not repeated."""

    def __init__(self, document: EddiDocument) -> None:
        self.document = document
        self.errors = 0  # so far, so that a caller knows whether its part has one
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
        return self.first(self.document.children(parent, spelling))

    def first(self, elements: Sequence[Element]) -> Element | None:
        """Return the first of what may be there once; report others (X011)."""
        first, problems = only(elements, "X011.twice", self.document.place)
        self.add(*problems)
        return first

    def targets(self, element: Element, link: Spelling, feature: Spelling) -> list[Element]:
        """Return what an attribute refers to; report what is in another feature (X009)."""
        ends, problems, _ = self.document.targets(element, link)
        self.add(*problems)
        is_right = {end: feature.accepts(feature_of(end)) for end in ends}
        for end in ends:
            if not is_right[end]:
                fields = {"actual": self.document.describe(end), "expected": feature.name}
                self.report("X009.expected", element, link=link.name, **fields)
        return [end for end in ends if is_right[end]]

    def key_value(self, element: Element, key: str) -> str | None:
        """Return the value of a key of an element, None where it has none."""
        values = [
            value
            for child in self.document.children(element, names.KEY_VALUE_MAPS)
            if (self.document.attribute(child, names.KEY) or "").casefold() == key.casefold()
            for value in self.document.children(child, names.VALUES)
        ]
        value = self.first(values)
        return (
            None if value is None else (self.document.attribute(value, names.VALUE) or "").strip()
        )

    def problems(self) -> list[Problem]:
        """Return everything that was found."""
        problems = list(dict.fromkeys(self._problems))
        for remark, (place, times) in self._counted.items():
            message = remark.message + (f" ({times} times)" if times > 1 else "")
            problems.append(replace(remark, message=message, place=place))
        return problems


def recognises(source: Source) -> bool:
    """Return whether a file looks like an EDDI: XML, or the JSON of a stand-alone machine."""
    return looks_like_xml(source.data) or is_machine(source)


def read_document(source: Source) -> tuple[EddiDocument | None, list[Problem]]:
    """Parse an EDDI; ``None`` and the errors X001 or X003 when that is impossible."""
    origins: Mapping[Element, Place] = {}
    if is_machine(source):
        element, origins, problems = read_machine(source)
    else:
        element, problems = load(source.data, source.name)
    if element is None:
        return None, problems
    converted = in_form_of_emf(element, source.name, origins)
    if converted is not None:
        element, origins, more = converted
        problems += more
    if element is None:
        return None, problems
    document = EddiDocument(element, source.name, origins)
    return document, [*problems, *unknown_classes(document)]


def unknown_classes(document: EddiDocument) -> Iterator[Problem]:
    """Yield a warning (X006) for each unread element of a package whose class looks misspelt."""
    for package in document.packages():
        # the reader of a root that is a model knows its parts
        for element in () if document.is_monitored(package) else package.iterchildren():
            class_name = document.class_of(element)
            is_known = element.get(XSI_TYPE) is None or class_name.name in KNOWN_CLASSES
            if is_known or document.holds_models(element):
                continue
            similar = get_close_matches(class_name.name, _READ_NAMES, 1, _SIMILAR)
            is_package = class_name.name.endswith("package")
            if similar or (class_name.package in _COMPLETELY_KNOWN and not is_package):
                hint = f"did you mean {_READ_NAMES[similar[0]]!r}?" if similar else _MODELS
                subject, place = document.describe(element), document.place(element)
                yield problem("X006.unread_class", place, hint=hint, subject=subject)
