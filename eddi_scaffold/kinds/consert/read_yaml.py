"""ConSert YAML (SESAME D7.2 Fig 6) -> model: a table of what each map holds, and one reader of it.

A faulty part is reported and becomes ``None``, and so does all that it is in.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.yaml_text import nodes as y

Read = Callable[["Reader", y.Node, str, str], Any]
"""Reads a node, given what it is and what it is in, for messages; ``None`` after a problem."""


class Field(NamedTuple):
    """A key of a map."""

    key: str
    read: Read
    is_optional: bool = False


class Form(NamedTuple):
    """What a map holds."""

    make: Callable[..., Any]  # takes the values that are there by their keys, and a place
    fields: tuple[Field, ...]
    kind: str = ""  # of an element with an id, which messages call `<kind> '<id>'`

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of its fields."""
        return tuple(field.key for field in self.fields)


def read_full(root: y.Map, name: str) -> tuple[model.ConSert | None, list[Problem]]:
    """Read a ConSert in the full form."""
    reader = Reader()
    consert = reader.element(root, "the ConSert", Form(partial(model.ConSert, name), _SECTIONS))
    return (None if reader.problems else consert), reader.problems


class Reader:
    """Reads maps by their forms, and collects what is wrong with them."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def report(
        self, case: str, node: y.Node, /, *, hint: str | None = None, **fields: object
    ) -> None:
        """Add an error at a node."""
        self.problems.append(problem(case, node.place, hint=hint, **fields))

    def element(self, node: y.Node, what: str, form: Form, place: Place | None = None) -> Any:
        """Read a map."""
        if not isinstance(node, y.Map):
            self.report("C002.map", node, subject=what, node=y.describe(node))
            return None
        place = place or node.place
        id_ = node.get("id") if form.kind else None
        if id_ is not None:
            place, text = id_.place, y.as_text(id_)
            if text is not None:
                what = f"{form.kind} {y.shown(text)}"
        self.check_keys(node, what, form)
        values: dict[str, Any] = {}
        for field in form.fields:
            if (child := node.get(field.key)) is not None:
                values[field.key] = field.read(self, child, f"{field.key!r} of {what}", what)
        values = {key: value for key, value in values.items() if value is not None}
        is_complete = all(field.is_optional or field.key in values for field in form.fields)
        return form.make(**values, place=place) if is_complete else None

    def check_keys(self, node: y.Map, what: str, form: Form) -> None:
        """Report keys that are missing or unknown."""
        present, known = set(node.keys()), {field.key: field for field in form.fields}
        absent = [key for key in known if key not in present]
        for key in absent:
            if not known[key].is_optional:
                case = "C002.no_section" if form.fields is _SECTIONS else "C002.no_key"
                self.report(case, node, subject=what, key=key)
        similar = SimilarNames(absent)
        for name, _ in node.entries:
            if name.text not in known:
                fields = {"name": y.shown(name.text), "subject": what}
                self.report("C002.unknown_key", name, hint=similar.hint(name.text), **fields)

    def unknown_word(self, word: y.Scalar, title: str, known: tuple[str, ...]) -> None:
        """Report a word outside of a closed set."""
        fields = {"word": y.shown(word.text), "allowed": ", ".join(known)}
        self.report("C002.unknown_word", word, kind=title, **fields)


def _or_null(read: Read) -> Read:
    return lambda reader, node, what, owner: (
        None if y.is_null(node) else read(reader, node, what, owner)
    )


def _scalar(convert: Callable[[y.Node], Any], case: str) -> Read:
    def read_scalar(reader: Reader, node: y.Node, what: str, _owner: str) -> Any:
        value = convert(node)
        if value is None:
            reader.report(case, node, subject=what, node=y.describe(node))
        return value

    return read_scalar


def _bound(node: y.Node) -> model.Bound | None:
    number = y.as_number(node)
    return None if number is None else model.Bound(number.text, number.value)


text_of = _scalar(y.as_text, "C002.text")


def word_of(title: str, known: tuple[str, ...]) -> Read:
    """Return what reads a word of a closed set."""

    def read_word(reader: Reader, node: y.Node, what: str, owner: str) -> str | None:
        text = text_of(reader, node, what, owner)
        if text is not None and text not in known and isinstance(node, y.Scalar):
            reader.unknown_word(node, title, known)
        return text if text in known else None

    return read_word


def _list_of(read: Read, item: str, *, may_be_empty: bool = False) -> Read:
    """Return what reads a list.

    An item is named by its ``number``, by ``what`` the list is, or by what the list is in.
    """

    def read_list(reader: Reader, node: y.Node, what: str, owner: str) -> tuple[Any, ...] | None:
        if not isinstance(node, y.Items):
            hint = "write [] for an empty list" if y.is_null(node) else None
            reader.report("C002.list", node, hint=hint, subject=what, node=y.describe(node))
            return None
        if not node.items and not may_be_empty:
            reader.report("C006.empty_list", node, subject=what)
            return None
        items = [
            read(reader, child, item.format(number=number, what=what, owner=owner), owner)
            for number, child in enumerate(node.items, 1)
        ]
        return None if None in items else tuple(items)

    return read_list


def _variant_of(title: str, forms: Mapping[str, Form]) -> Read:
    """Return what reads a map with one key, which tells what it holds."""
    known = tuple(forms)

    def read_variant(reader: Reader, node: y.Node, what: str, _owner: str) -> Any:
        if not isinstance(node, y.Map) or len(node.entries) != 1:
            actual = y.describe(node)
            if isinstance(node, y.Map):
                actual += f" with {len(node.entries)} keys"
            keys = f"one key ({', '.join(known)})"
            reader.report("C002.map_with_keys", node, subject=what, keys=keys, actual=actual)
            return None
        key, content = node.entries[0]
        if key.text not in known:
            reader.unknown_word(key, title, known)
            return None
        return reader.element(content, f"{key.text!r} in {what}", forms[key.text], node.place)

    return read_variant


_TYPE = Field("type", text_of)
_SUBSETS = ("Demand", "Guarantee", "Equals", "Intersection")
_SUBSET = Field("subset", word_of("subset", _SUBSETS), is_optional=True)
_BOUND, _BOOLEAN = _scalar(_bound, "C002.number"), _scalar(y.as_bool, "C002.boolean")
_ENDS = (Field("start", _BOUND), Field("end", _BOUND))
_RANGE = _variant_of(
    "kind of range",
    {
        name: Form(partial(model.Range, inclusive=end, start_inclusive=start), _ENDS)
        for (start, end), name in model.RANGES.items()
    },
)
_CATEGORIES = Field("covered", _list_of(text_of, "a category of {owner}"))
_RANGES = Field("covered", _list_of(_RANGE, "a range of {owner}"))
_UOM = Field("uom", _or_null(text_of), is_optional=True)
_DIMENSION = _variant_of(
    "kind of dimension",
    {
        "Binary": Form(model.BinaryDimension, (_TYPE, Field("value", _BOOLEAN, is_optional=True))),
        "Categorical": Form(model.CategoricalDimension, (_TYPE, _CATEGORIES, _SUBSET)),
        "Numeric": Form(model.NumericDimension, (_TYPE, _RANGES, _SUBSET, _UOM)),
    },
)
_ID = Field("id", text_of)
_DESCRIPTION = Field("description", _or_null(text_of), is_optional=True)
_DIMENSIONS = Field("dimensions", _list_of(_DIMENSION, "a dimension of {owner}", may_be_empty=True))
_DEFAULT = Field("default", _BOOLEAN, is_optional=True)
_RANKING = Field("ranking", _or_null(_scalar(y.as_integer, "C002.integer")), is_optional=True)
_FUNCTION = word_of("gate function", ("And", "Or"))
_SERVICE_TYPE = Field("functional_service_type", text_of)
_IDS = _list_of(text_of, "a member of {what}", may_be_empty=True)
_ELEMENTS = {
    "guarantees": Form(
        model.Guarantee, (_ID, _DIMENSIONS, _DESCRIPTION, _DEFAULT, _RANKING), "guarantee"
    ),
    "demands": Form(model.Demand, (_ID, _DIMENSIONS, _DESCRIPTION), "demand"),
    "evidence": Form(
        model.Evidence, (_ID, Field("dimension", _DIMENSION), _DESCRIPTION), "evidence"
    ),
    "gates": Form(model.Gate, (_ID, Field("function", _FUNCTION)), "gate"),
    "tree_propagations": Form(
        lambda place, **ends: model.Propagation(ends["from"], ends["to"], place),
        (Field("from", text_of), Field("to", text_of)),
    ),
    "required_services": Form(
        model.RequiredService, (_ID, _SERVICE_TYPE, Field("demands", _IDS)), "service"
    ),
    "provided_services": Form(
        model.ProvidedService, (_ID, _SERVICE_TYPE, Field("guarantees", _IDS)), "service"
    ),
}


def _section(key: str, form: Form) -> Field:
    def read_element(reader: Reader, node: y.Node, what: str, _owner: str) -> Any:
        return reader.element(node, what, form)

    read = _list_of(read_element, "item {number} of {what}", may_be_empty=True)
    return Field(key, lambda reader, node, _what, owner: read(reader, node, repr(key), owner))


_SECTIONS = (
    *(_section(key, form) for key, form in _ELEMENTS.items()),
    Field("system", text_of, is_optional=True),
)
"""The keys of the top level, the mandatory ones in the order of SESAME D7.2 Fig 6."""
