"""ConSert YAML in short -> its full form: ``guarantees: {MayDrive: PathIsFree AND Charge}``.

Each key is an id; gates and edges follow from the expressions. The form is told by ``guarantees``
being a map. What it means is what the full form means that is made of it here, node by node with
their places, and that ``export`` writes.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator
from typing import NamedTuple

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.read_yaml import Field, Form, Reader, read_full, text_of, word_of
from eddi_scaffold.kinds.consert.short_texts import (
    RESERVED,
    Refused,
    Row,
    Term,
    parse_expression,
    parse_ranges,
)
from eddi_scaffold.yaml_text import nodes as y
from eddi_scaffold.yaml_text.spans import inside_scalar

_SUBSETS = {"within": "Guarantee", "covers": "Demand"}
_MATCH = word_of("match", tuple(_SUBSETS))


def read_consert(source: Source) -> tuple[model.ConSert | None, list[Problem]]:
    """Read one ConSert, ``None`` where something of it could not be read, with all problems."""
    root, problems = y.read_map(source, "C001")
    if root is None:
        return None, problems
    if isinstance(root.get("guarantees"), y.Map):
        expansion = _Expansion(source.text("C001"))
        root = expansion.full_form(root)
        if expansion.problems:
            return None, [*problems, *expansion.problems]
    consert, more = read_full(root, source.stem)
    return consert, [*problems, *more]


def _form(main: str, *others: str) -> Form:
    """Return the form of a map that has a key and may have others."""
    fields = (Field(key, text_of, is_optional=key != main) for key in (main, *others))
    return Form(dict, tuple(fields))


_PROPERTY = _form("is", "type", "description", "match")
_SECTIONS = {
    "evidence": ("evidence", _PROPERTY),
    "demands": ("demand", _PROPERTY),
    "gates": ("gate", _form("when")),
    "guarantees": ("guarantee", _form("when", "gives", *_PROPERTY.keys[1:], "ranking")),
    "requires": ("required service", _form("demands", "type")),
    "provides": ("provided service", _form("guarantees", "type")),
}
"""Key -> what it declares, and the form of that; the first key of a form may stand alone."""
_NODES = ("evidence", "demands", "gates", "guarantees")  # of these, what has an id in expressions
_ROOT = _form("guarantees", *_SECTIONS)


class _Declared(NamedTuple):
    """What a section declares."""

    key: y.Scalar
    what: str  # for messages
    parts: dict[str, y.Node]
    main: y.Node | None  # the part that may stand alone

    @property
    def id(self) -> str:
        return self.key.text


class _Expansion(Reader):
    """Makes the full form of a short one."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text  # of the file
        self._gates: list[y.Node] = []
        self._edges: list[y.Node] = []
        self._ids: set[str] = set()
        self._numbers: Counter[str] = Counter()

    def full_form(self, root: y.Map) -> y.Map:
        """Return the full form."""
        self.check_keys(root, "the ConSert", _ROOT)
        of = {key: [*self._declared(root, key)] for key in _SECTIONS}
        self._ids = {item.id for key in _NODES for item in of[key]}
        similar = SimilarNames(self._ids)
        for item in of["gates"]:
            row = self._row(item, similar)
            self._add_gate(item.id, row, item.key.place)
            self._join(item, row)
        full = {
            "guarantees": [self._guarantee(item, similar) for item in of["guarantees"]],
            "demands": [self._property(item, "dimensions") for item in of["demands"]],
            "evidence": [self._property(item, "dimension") for item in of["evidence"]],
            "gates": self._gates,
            "tree_propagations": self._edges,
            "required_services": self._services(of["requires"], of["demands"], "demand"),
            "provided_services": self._services(of["provides"], of["guarantees"], "guarantee"),
        }
        lists = {key: y.Items(tuple(items), root.place) for key, items in full.items()}
        return y.map_of(root.place, lists)

    def _declared(self, root: y.Map, section: str) -> Iterator[_Declared]:
        node, (kind, form) = root.get(section), _SECTIONS[section]
        if node is not None and not isinstance(node, y.Map):
            self.report("C002.map", node, subject=repr(section), node=y.describe(node))
        for key, value in node.entries if isinstance(node, y.Map) else ():
            if key.text.lower() in RESERVED:
                self.report("C018.reserved", key, id=y.shown(key.text))
            what, parts = f"{kind} {y.shown(key.text)}", {form.keys[0]: value}
            if isinstance(value, y.Map):
                self.check_keys(value, what, form)
                parts = {name.text: part for name, part in value.entries}
            yield _Declared(key, what, parts, parts.get(form.keys[0]))

    def _property(self, item: _Declared, key: str) -> y.Node:
        """Return evidence or a demand."""
        subset, place = self._subset(item), item.key.place
        of: y.Node = self._dimension(item, item.main, "Demand" if key == "dimension" else subset)
        of = of if key == "dimension" else y.Items((of,), place)
        return y.map_of(
            place, {"id": item.key, "description": item.parts.get("description"), key: of}
        )

    def _guarantee(self, item: _Declared, similar: SimilarNames) -> y.Node:
        parts, place = item.parts, item.key.place
        default = isinstance(item.main, y.Scalar) and item.main.text == "always"
        if not default:
            row = self._row(item, similar)
            if row.word == "OR" and len(row.terms) > 1:
                row = Row("AND", [row])
            self._join(item, row)
        of = self._dimension(item, parts.get("gives"), self._subset(item))
        node = {"id": item.key, "description": parts.get("description")}
        node |= {"dimensions": y.Items((of,), place), "ranking": parts.get("ranking")}
        return y.map_of(place, {**node, "default": "true" if default else None})

    def _subset(self, item: _Declared) -> str:
        match = item.parts.get("match")
        word = match and _MATCH(self, match, f"'match' of {item.what}", item.what)
        return _SUBSETS[word or "within"]

    def _dimension(self, item: _Declared, what: y.Node | None, subset: str) -> y.Map:
        """Return what is observed, expected or guaranteed: true, categories or ranges."""
        place = item.key.place if what is None else what.place
        nodes: dict[str, y.Node | str] = {"type": item.parts.get("type", item.key)}
        if isinstance(what, y.Items):
            nodes |= {"covered": what, "subset": subset}
            return y.map_of(place, {"Categorical": y.map_of(place, nodes)})
        text = what and text_of(self, what, item.what, "")
        if text and text != "bool" and isinstance(what, y.Scalar):
            try:
                ranges, unit = parse_ranges(text)
            except Refused as refused:
                self._refuse(what, refused, item.what)
            else:
                locate = inside_scalar(self._text, place, text)
                covered: list[y.Node] = []
                for name, start, end, offset in ranges:
                    at = locate(offset)
                    covered.append(y.map_of(at, {name: y.map_of(at, {"start": start, "end": end})}))
                nodes |= {"covered": y.Items(tuple(covered), place)}
                nodes |= {"subset": subset, "uom": y.Scalar(unit, plain=False, place=place)}
                return y.map_of(place, {"Numeric": y.map_of(place, nodes)})
        return y.map_of(place, {"Binary": y.map_of(place, nodes)})

    def _row(self, item: _Declared, similar: SimilarNames) -> Row:
        """Read an expression; a faulty one is reported, and empty."""
        node, row = item.main, Row("AND", [])
        text = None if node is None else text_of(self, node, item.what, "")
        if text is None or not isinstance(node, y.Scalar):
            return row
        try:
            row = parse_expression(text)
        except Refused as refused:
            self._refuse(node, refused, item.what)
        for term in _terms(row):
            if term.id not in self._ids:
                hint, id_ = similar.hint(term.id), y.shown(term.id)
                unknown = Refused("C008.no_term", term.offset, hint, id=id_)
                self._refuse(node, unknown, item.what)
        return row

    def _refuse(self, node: y.Scalar, refused: Refused, subject: str) -> None:
        """Report what is wrong inside of a text, at its character."""
        place = inside_scalar(self._text, node.place, node.text)(refused.offset)
        fields = {"hint": refused.hint, "subject": subject, **refused.fields}
        self.problems.append(problem(refused.case, place, **fields))

    def _join(self, item: _Declared, row: Row) -> None:
        """Add the edges of a row, and the gates that its parentheses need, a row at a time."""
        waiting = deque([(item.id, row)])
        place = item.main.place if item.main else item.key.place
        while waiting:
            target, (_, terms) = waiting.popleft()
            for term in terms:
                if isinstance(term, Term):
                    source = term.id
                else:
                    source = self._free_name(f"{item.id}_{term.word.lower()}")
                    self._add_gate(source, term, place)
                    waiting.append((source, term))
                ends = {"from": source, "to": target}
                texts = {key: y.Scalar(id_, plain=False, place=place) for key, id_ in ends.items()}
                self._edges.append(y.map_of(place, texts))

    def _add_gate(self, id_: str, row: Row, place: Place) -> None:
        node = y.Scalar(id_, plain=False, place=place)
        self._gates.append(y.map_of(place, {"id": node, "function": row.word.capitalize()}))

    def _free_name(self, base: str) -> str:
        name = base
        while name in self._ids:
            self._numbers[base] += 1
            name = f"{base}_{self._numbers[base] + 1}"
        self._ids.add(name)
        return name

    def _services(
        self, services: list[_Declared], known: list[_Declared], kind: str
    ) -> list[y.Node]:
        ids = {item.id: None for item in known}
        similar = SimilarNames(ids)
        nodes: list[y.Node] = []
        for item in services:
            for member in y.scalars_of(item.main):
                if member.text not in ids:
                    fields = {"name": item.what, "kind": kind, "member": y.shown(member.text)}
                    hint = similar.hint(member.text)
                    self.report("C008.unknown_member", member, hint=hint, **fields)
            type_ = item.parts.get("type", item.key)
            node = {"id": item.key, "functional_service_type": type_, f"{kind}s": item.main}
            nodes.append(y.map_of(item.key.place, node))
        return nodes


def _terms(row: Row) -> Iterator[Term]:
    for term in row.terms:
        yield from [term] if isinstance(term, Term) else _terms(term)
