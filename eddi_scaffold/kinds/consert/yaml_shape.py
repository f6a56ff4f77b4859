"""What a ConSert file must hold where: keys, lists and scalars, each mistake with its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, most_similar, problem
from eddi_scaffold.yaml_text import nodes as y

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


MAX_ID = 128
_MOST_STRANGE = 100
"""Unknown keys of one map that are compared with a missing one."""


@dataclass(frozen=True)
class Element:
    """A map of the file whose keys have been checked.

    Attributes:
        what: what it is, for messages (``guarantee 'G'``).
        id: its id; ``None`` when it has none or cannot have one.
        place: place of its id, of the map when there is none.
    """

    node: y.Map
    what: str
    id: str | None
    place: Place

    def get(self, key: str) -> y.Node | None:
        """Return the value of a key, ``None`` when it is absent."""
        return self.node.get(key)


class Shape:
    """Reads parts of a file and collects what is wrong with them."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def report(
        self, case: str, place: Place, /, *, hint: str | None = None, **fields: object
    ) -> None:
        """Add an error."""
        self.problems.append(problem(case, place, hint=hint, **fields))

    def element(
        self,
        node: y.Node,
        what: str,
        mandatory: Sequence[str],
        optional: Sequence[str] = (),
        kind: str | None = None,
        *,
        lists: bool = False,
    ) -> Element | None:
        """Read a map: C002 for anything else, for missing and for unknown keys.

        Args:
            node: the content of the file.
            what: what it is, for messages.
            mandatory: keys that it must have.
            optional: keys that it may have.
            kind: with an ``id``, messages name ``<kind> '<id>'`` instead.
            lists: whether the mandatory keys hold lists, which may be empty.
        """
        if not isinstance(node, y.Map):
            self.report("C002.map", node.place, subject=what, node=y.describe(node))
            return None
        id_, place = self._id(node, what) if "id" in mandatory else (None, node.place)
        if id_ is not None and kind is not None:
            what = f"{kind} {y.shown(id_)}"
        self._keys(node, what, mandatory, optional, lists)
        return Element(node, what, id_, place)

    def _id(self, node: y.Map, what: str) -> tuple[str | None, Place]:
        value = node.get("id")
        if value is None:
            return None, node.place
        text = self.scalar(value, f"'id' of {what}")
        if text is not None and len(text) > MAX_ID:
            self.report("C001.long_id", value.place, length=len(text), limit=MAX_ID)
        return text, value.place

    def _keys(
        self,
        node: y.Map,
        what: str,
        mandatory: Sequence[str],
        optional: Sequence[str],
        lists: bool,
    ) -> None:
        known = dict.fromkeys((*mandatory, *optional))
        keys = node.keys()
        present, strange = set(keys), [key for key in keys if key not in known]
        instead: dict[str, str] = {}
        for key in mandatory:
            if key not in present:
                found = most_similar(key, strange[:_MOST_STRANGE])
                if found is not None:
                    instead[found] = key
                hint = _missing_hint(key, found) or (
                    f"write `{key}: []` for none" if lists else None
                )
                self.report("C002.no_key", node.place, hint=hint, subject=what, key=key)
        absent = [key for key in known if key not in present]
        for index, (name, _) in enumerate(node.entries):
            if name.text not in known and name.text not in instead:
                hint = _comma_hint(node, index) or did_you_mean(name.text, absent)
                self.report(
                    "C002.unknown_key", name.place, hint=hint, name=y.shown(name.text), subject=what
                )

    def items(self, node: y.Node, what: str) -> tuple[y.Node, ...] | None:
        """Read a list, C002 for anything else."""
        if isinstance(node, y.Items):
            return node.items
        hint = "write [] for an empty list" if y.is_null(node) else None
        self.report("C002.list", node.place, hint=hint, subject=what, node=y.describe(node))
        return None

    def scalar(self, node: y.Node, what: str) -> str | None:
        """Read a text, C002 for a list, a map and a plain null."""
        text = y.as_text(node)
        if text is None:
            hint = None
            if y.is_null(node) and isinstance(node, y.Scalar) and node.text:
                hint = f'if the text "{node.text}" is meant, put it in quotes'
            self.report("C002.text", node.place, hint=hint, subject=what, node=y.describe(node))
        return text

    def text(self, item: Element, key: str) -> str | None:
        """Read a mandatory text (a missing key has been reported)."""
        node = item.get(key)
        return None if node is None else self.scalar(node, f"{key!r} of {item.what}")

    def optional_text(self, item: Element, key: str) -> str | None:
        """Read an optional text, ``None`` when it is absent or null."""
        node = item.get(key)
        if node is None or y.is_null(node):
            return None
        return self.scalar(node, f"{key!r} of {item.what}")

    def boolean(self, item: Element, key: str, *, otherwise: bool) -> bool:
        """Read an optional Boolean: ``true`` or ``false``, without quotes."""
        node = item.get(key)
        if node is None:
            return otherwise
        value = y.as_bool(node)
        if value is None:
            self.report(
                "C002.boolean", node.place, key=key, subject=item.what, node=y.describe(node)
            )
        return otherwise if value is None else value

    def integer(self, item: Element, key: str) -> int | None:
        """Read an optional decimal integer."""
        node = item.get(key)
        if node is None or y.is_null(node):
            return None
        value = y.as_integer(node)
        if value is None:
            self.report(
                "C002.integer", node.place, key=key, subject=item.what, node=y.describe(node)
            )
        return value

    def variant(
        self,
        item: Element,
        key: str,
        allowed: Sequence[str],
        title: str,
        hints: Mapping[str, str] | None = None,
    ) -> str | None:
        """Read one of a closed set of words: C002 for any other, with a hint on the case."""
        text = self.text(item, key)
        if text is None or text in allowed:
            return text
        node = item.get(key)
        place = item.place if node is None else node.place
        self.unknown_variant(text, allowed, title, place, (hints or {}).get(text.casefold()))
        return None

    def unknown_variant(
        self,
        text: str,
        allowed: Sequence[str],
        title: str,
        place: Place,
        hint: str | None = None,
    ) -> None:
        """Report a word outside of a closed set (C002)."""
        self.report(
            "C002.unknown_word",
            place,
            hint=hint or did_you_mean(text, allowed),
            kind=title,
            word=y.shown(text),
            allowed=", ".join(allowed),
        )


def _comma_hint(node: y.Map, index: int) -> str | None:
    """Return what to do where a decimal comma has made a key: ``{start: 1,5}``."""
    name, value = node.entries[index]
    if index == 0 or not (name.text.isdecimal() and y.is_null(value)):
        return None
    key, before = node.entries[index - 1]
    if not isinstance(before, y.Scalar) or y.as_integer(before) is None:
        return None
    return f"a decimal point, not a comma: `{key.text}: {before.text}.{name.text}`"


def _missing_hint(key: str, found: str | None) -> str | None:
    if found is None:
        return None
    if (found, key) == ("dimension", "dimensions"):
        return "the key 'dimension' is there: use `dimensions: [...]`"
    return f"the key {y.shown(found)} is there: did you mean {key!r}?"
