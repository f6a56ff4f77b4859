"""ConSert YAML in short -> model: ``guarantees: {MayDrive: PathIsFree AND Charge}``.

Each key is an id; gates and edges follow from the expressions. The form is told by ``guarantees``
being a map, and means what its full form (:mod:`read_yaml`) does, which ``export`` writes.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, SimilarNames
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.read_yaml import (
    DESCRIPTION,
    MAX_ID,
    RANKING,
    UNREADABLE,
    Field,
    Form,
    Read,
    Reader,
    read_full,
    text_of,
    word_of,
)
from eddi_scaffold.kinds.consert.short_texts import (
    RESERVED,
    Refused,
    Row,
    Term,
    ids_in,
    parse_expression,
    parse_ranges,
)
from eddi_scaffold.yaml_text import nodes as y
from eddi_scaffold.yaml_text.spans import inside_scalar

_FUNCTIONS: Mapping[str, model.GateFunction] = {"AND": "And", "OR": "Or"}
_SUBSETS: Mapping[str | None, model.Subset] = {"within": "Guarantee", "covers": "Demand"}
_Make = Callable[[str, model.Subset], model.Dimension]
"""Returns the dimension of a type; how the values of guarantee and demand lie to each other."""


def read_consert(
    source: Source, name: str | None = None
) -> tuple[model.ConSert | None, list[Problem]]:
    """Read one ConSert as far as possible, so that checking can go on behind a faulty part.

    Returns:
        A ConSert in which faulty parts are replaced, ``None`` when an id or an edge could not be
        read (checking would report its consequences); and all problems (C001 to C008).
    """
    root, problems = y.read_map(source, "C001")
    if root is None:
        return None, problems
    name = source.stem if name is None else name
    if not isinstance(root.get("guarantees"), y.Map):
        consert, more = read_full(root, name)
        return consert, [*problems, *more]
    reader = ShortReader(source.text("C001"))
    return reader.read(root, name), [*problems, *reader.problems]


class _Supported(NamedTuple):
    """A gate or guarantee, and the expression of what supports it."""

    node: Any
    expression: y.Scalar | None


class _Members(NamedTuple):
    """A service, and the nodes that name its members."""

    make: Any  # class of the service
    id: str
    type: str
    members: tuple[y.Scalar, ...]
    place: Place


class ShortReader(Reader):
    """Reads the maps of the short form; gates and edges follow from the expressions."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text  # of the file
        self._gates: list[model.Gate] = []
        self._edges: list[model.Propagation] = []
        self._ids: set[str] = set()
        self._numbers: Counter[str] = Counter()

    def read(self, root: y.Map, name: str) -> model.ConSert | None:
        """Read one ConSert."""
        form = Form(partial(self._consert, name), _SECTIONS, hints=_HINTS)
        consert: model.ConSert | None = self.element(root, "the ConSert", form)
        return consert

    def locate(self, node: y.Scalar) -> Callable[[int], Place]:
        """Return offset in a text -> place in the file."""
        return inside_scalar(self._text, node.place)

    def refuse(self, node: y.Scalar, refused: Refused, subject: str) -> None:
        """Report what is wrong inside of a text."""
        at = y.Scalar("", plain=True, place=self.locate(node)(refused.offset))
        self.report(refused.case, at, hint=refused.hint, subject=subject, **refused.fields)

    def _consert(self, name: str, *sections: Any, place: Place) -> model.ConSert:
        evidence, demands, gates, guarantees, required, provided = (s or () for s in sections)
        supported: list[_Supported] = [*gates, *guarantees]
        self._ids = {node.id for node in (*evidence, *demands, *(s.node for s in supported))}
        similar = SimilarNames(self._ids)
        nodes = {
            item: self._support(*item, similar)
            for item in sorted(supported, key=lambda item: item.node.place.line or 0)
        }
        return model.ConSert(
            name,
            tuple(nodes[item] for item in guarantees),
            demands,
            evidence,
            tuple(self._gates),
            tuple(self._edges),
            tuple(self._services(required, [node.id for node in demands])),
            tuple(self._services(provided, [item.node.id for item in guarantees])),
            place,
        )

    def _support(self, node: Any, expression: y.Scalar | None, similar: SimilarNames) -> Any:
        """Add the edges into a gate or guarantee, and the gates that its parentheses need."""
        if expression is None:
            return node
        row = self._row(expression, f"{node.kind} {y.shown(node.id)}", similar)
        if isinstance(node, model.Gate):
            node = replace(node, function=_FUNCTIONS[row.word])
            self._gates.append(node)
        elif not row.terms:
            return replace(node, default=True)
        elif row.word == "OR":
            row = Row("AND", [row] if len(row.terms) > 1 else row.terms)
        waiting = deque([(node.id, row)])
        while waiting:
            target, (_, terms) = waiting.popleft()
            for term in terms:
                source = term.id if isinstance(term, Term) else self._free_name(node.id, term)
                if isinstance(term, Row):
                    self._gates.append(model.Gate(source, _FUNCTIONS[term.word], node.place))
                    waiting.append((source, term))
                self._edges.append(model.Propagation(source, target, expression.place))
        return node

    def _row(self, expression: y.Scalar, subject: str, similar: SimilarNames) -> Row:
        """Read an expression; of a faulty one stays what is known, so that checking can go on."""
        faults: list[Refused] = []
        try:
            row = parse_expression(expression.text)
        except Refused as refused:
            row, faults = Row("AND", []), [refused]
        for term in _terms(row):
            if term.id not in self._ids:
                hint, id_ = similar.hint(term.id), y.shown(term.id)
                faults.append(Refused("C008.no_term", term.offset, hint, id=id_))
        for fault in faults:
            self.refuse(expression, fault, subject)
        if faults:
            known = (Term(id_, 0) for id_ in ids_in(expression.text) if id_ in self._ids)
            return Row("AND", [*known])
        return row

    def _free_name(self, owner: str, row: Row) -> str:
        name = base = f"{owner}_{row.word.lower()}"
        while name in self._ids:
            self._numbers[base] += 1
            name = f"{base}_{self._numbers[base] + 1}"
        self._ids.add(name)
        return name

    def _services(self, services: tuple[_Members, ...], known: list[str]) -> Iterator[Any]:
        similar, ids = SimilarNames(known), set(known)
        for service in services:
            unknown = [member for member in service.members if member.text not in ids]
            for member in unknown:
                hint, fields = similar.hint(member.text), {"kind": service.make.member_kind}
                name = f"{service.make.kind} {y.shown(service.id)}"
                fields |= {"name": name, "member": y.shown(member.text)}
                self.report("C008.unknown_member", member, hint=hint, **fields)
            if not unknown:
                members = tuple(member.text for member in service.members)
                yield service.make(service.id, service.type, members, service.place)


def _terms(row: Row) -> Iterator[Term]:
    for term in row.terms:
        yield from [term] if isinstance(term, Term) else _terms(term)


def _what(reader: Reader, node: y.Node, what: str, _owner: str) -> _Make | None:
    """Read what is observed, expected or guaranteed: ``bool``, categories or ranges."""
    assert isinstance(reader, ShortReader)
    place = node.place
    if isinstance(node, y.Items):
        if not node.items:
            reader.report("C006.empty_list", node, subject=what)
            return None
        covered = [item.text for item in node.items if isinstance(item, y.Scalar)]
        return lambda type_, subset: model.CategoricalDimension(
            type_, tuple(covered), subset, place
        )
    if not isinstance(node, y.Scalar):
        reader.report("C002.text", node, subject=what, node=y.describe(node))
        return None
    if node.text == "bool":
        return lambda type_, _: model.BinaryDimension(type_, place)
    try:
        ranges, unit = parse_ranges(node.text, reader.locate(node))
    except Refused as refused:
        reader.refuse(node, refused, what)
        return None
    return lambda type_, subset: model.NumericDimension(type_, ranges, subset, unit, place)


def _unreadable(_type: str, _subset: model.Subset) -> model.Dimension:
    return UNREADABLE


def _expression(reader: Reader, node: y.Node, what: str, owner: str) -> Any:
    return None if text_of(reader, node, what, owner) is None else node


def _members(reader: Reader, node: y.Node, what: str, owner: str) -> tuple[y.Node, ...]:
    if not isinstance(node, y.Items):
        reader.report("C002.list", node, subject=what, node=y.describe(node))
        return ()
    title = f"a member of {what}"
    return tuple(item for item in node.items if text_of(reader, item, title, owner) is not None)


def _content(*values: Any, **_: Place) -> tuple[Any, ...]:
    return values


_ALWAYS = y.Scalar("always", plain=True)
_TYPE = Field("type", text_of, is_optional=True)
_MATCH = Field("match", word_of("match", ("within", "covers")), is_optional=True)
_DECLARED = Form(_content, (Field("is", _what, substitute=_unreadable), _TYPE, DESCRIPTION, _MATCH))
_GUARANTEED = Form(
    _content,
    (
        Field("when", _expression, substitute=_ALWAYS),
        Field("gives", _what, is_optional=True),
        *(_TYPE, DESCRIPTION, _MATCH, RANKING),
    ),
)


def _declared(reader: Reader, value: y.Node, what: str) -> tuple[Any, ...]:
    if isinstance(value, y.Map):
        content: tuple[Any, ...] = reader.element(value, what, _DECLARED)
        return content
    return (_what(reader, value, what, "") or _unreadable, None, None, None)


def _evidence(reader: Reader, key: y.Scalar, value: y.Node, what: str) -> model.Evidence:
    make, type_, description, _ = _declared(reader, value, what)
    return model.Evidence(key.text, make(type_ or key.text, "Demand"), description, key.place)


def _demand(reader: Reader, key: y.Scalar, value: y.Node, what: str) -> model.Demand:
    make, type_, description, match = _declared(reader, value, what)
    dimension = make(type_ or key.text, _SUBSETS[match or "within"])
    return model.Demand(key.text, (dimension,), description, key.place)


def _gate(reader: Reader, key: y.Scalar, value: y.Node, what: str) -> _Supported:
    return _Supported(model.Gate(key.text, "And", key.place), _expression(reader, value, what, ""))


def _guarantee(reader: Reader, key: y.Scalar, value: y.Node, what: str) -> _Supported:
    if isinstance(value, y.Map):
        content = reader.element(value, what, _GUARANTEED)
    else:
        content = (_expression(reader, value, what, "") or _ALWAYS, *[None] * 5)
    when, gives, type_, description, match, ranking = content
    type_ = type_ or key.text
    dimension = gives(type_, _SUBSETS[match or "within"]) if gives else model.BinaryDimension(type_)
    default = when.text == "always"
    node = model.Guarantee(key.text, (dimension,), description, default, ranking, key.place)
    return _Supported(node, None if default else when)


def _service(make: Any) -> Callable[[Reader, y.Scalar, y.Node, str], _Members]:
    members = f"{make.member_kind}s"
    form = Form(_content, (_TYPE, Field(members, _members)))

    def read(reader: Reader, key: y.Scalar, value: y.Node, what: str) -> _Members:
        if isinstance(value, y.Map):
            content = reader.element(value, what, form) or (None, ())
        else:
            content = (None, _members(reader, value, what, ""))
        return _Members(make, key.text, content[0] or key.text, content[1], key.place)

    return read


def _entries(kind: str, read: Callable[[Reader, y.Scalar, y.Node, str], Any]) -> Read:
    """Return what reads a map of ids."""

    def read_map(reader: Reader, node: y.Node, what: str, _owner: str) -> tuple[Any, ...]:
        if not isinstance(node, y.Map):
            reader.report("C002.map", node, subject=what, node=y.describe(node))
            return ()
        for key, _ in node.entries:
            if key.text.lower() in RESERVED:
                reader.report("C018.reserved", key, id=y.shown(key.text))
            elif len(key.text) > MAX_ID:
                reader.report("C001.long_id", key, length=len(key.text), limit=MAX_ID)
        return tuple(
            read(reader, key, value, f"{kind} {y.shown(key.text)}") for key, value in node.entries
        )

    return read_map


_SECTIONS = (
    Field("evidence", _entries("evidence", _evidence), is_optional=True),
    Field("demands", _entries("demand", _demand), is_optional=True),
    Field("gates", _entries("gate", _gate), is_optional=True),
    Field("guarantees", _entries("guarantee", _guarantee)),
    Field("requires", _entries("service", _service(model.RequiredService)), is_optional=True),
    Field("provides", _entries("service", _service(model.ProvidedService)), is_optional=True),
)
_HINTS = {
    "tree_propagations": "edges follow from the expressions",
    "required_services": "write `requires: {SERVICE: [DEMAND, ...]}`",
    "provided_services": "write `provides: {SERVICE: [GUARANTEE, ...]}`",
}
