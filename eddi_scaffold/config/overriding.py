"""Values that count in place of those of a configuration: what one robot has otherwise."""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.positioned_yaml.nodes import Items, Map, Node, as_text


def overridden(document: Map, override: Map | None) -> Map:
    """Return a document with other values; each keeps the place where it is written.

    Maps are joined key by key, and lists of entries with an ``id`` entry by entry; anything else
    is replaced as a whole. Keys and entries that the document does not have are added to it.
    """
    if override is None:
        return document
    entries = {key.text: (key, value) for key, value in document.entries}
    for key, value in override.entries:
        own = entries.get(key.text)
        entries[key.text] = (key, value) if own is None else (own[0], _joined(own[1], value))
    return replace(document, entries=tuple(entries.values()))


def _joined(value: Node, override: Node) -> Node:
    if isinstance(value, Map) and isinstance(override, Map):
        return overridden(value, override)
    if isinstance(value, Items) and isinstance(override, Items):
        own, new = _by_id(value), _by_id(override)
        if own is not None and new is not None:
            joined = {id_: overridden(entry, new.get(id_)) for id_, entry in own.items()}
            return replace(value, items=(*joined.values(), *(new[i] for i in new if i not in own)))
    return override


def _by_id(items: Items) -> dict[str, Map] | None:
    """Return the entries of a list by their ids, ``None`` where one has none, or two the same."""
    found = {
        id_: item
        for item in items.items
        if isinstance(item, Map) and (id_ := as_text(item.get("id") or item)) is not None
    }
    return found if len(found) == len(items.items) else None
