"""What people write in a configuration -> the form that D7.2's tools read, and the generator.

``from:`` becomes ``requires``, ``field`` or ``expression``; ``MONITOR.CLAIM`` the topic of a
monitor in the same file. Every node keeps the place where it is written.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config.file import MODEL_KEYS, undecided
from eddi_scaffold.config.schema import MONITOR_AGE
from eddi_scaffold.kinds import Kind, kinds
from eddi_scaffold.yaml_text.nodes import (
    Items,
    Map,
    Node,
    Scalar,
    as_text,
    items_of,
    map_of,
    scalars_of,
    text_of,
)

_ALIASES = {
    "EDDIOoutputs": "EDDIOutputs",
    "EDDIOOutputs": "EDDIOutputs",
    "SimulatorOutput": "SimulatorOutputs",
}
"""Names of sections that D7.2's figures misspell."""
_COMMON = ("SimulatorOutputs", "MessageTypes", "Package")
PATH = re.compile(r"(?P<head>[A-Za-z_]\w*)(?P<rest>(?:\.[A-Za-z_]\w*|\[[^\[\]]*\])*)")
_CLAIM = re.compile(r'"[^"]*"|(?<![\w.])(?P<monitor>[A-Za-z_]\w*)\.(?P<claim>[A-Za-z_]\w*)')
_BLANK = re.compile(r'("[^"]*")|(?<=[0-9]) +(?=(?:ms|s|min|h)\b)')  # before the unit of a duration
_INSTEAD = ("requires", "field", "expression", "expression_file", "states")


def joined(document: Map, other: Map | None) -> Map:
    """Return a document with other values; each keeps the place where it is written.

    Maps are joined key by key, and lists of entries with an ``id`` entry by entry; anything else
    is replaced as it is. Keys and entries that the document does not have are added to it.
    """
    entries = {key.text: (key, value) for key, value in document.entries}
    for key, value in other.entries if other is not None else ():
        own_key, own = entries.get(key.text, (key, value))
        entries[key.text] = own_key, _joined(own, value)
    return replace(document, entries=tuple(entries.values()))


def _joined(value: Node, other: Node) -> Node:
    if isinstance(value, Map) and isinstance(other, Map):
        return joined(value, other)
    if isinstance(value, Items) and isinstance(other, Items):
        own, new = _by_id(value), _by_id(other)
        if own is not None and new is not None:
            both = {id_: joined(entry, new.get(id_)) for id_, entry in own.items()}
            return replace(value, items=tuple({**both, **new, **both}.values()))
    return other


def _texts(place: Place, texts: Mapping[str, str]) -> Map:
    return map_of(place, {k: Scalar(text, plain=False, place=place) for k, text in texts.items()})


def _by_id(items: Items) -> dict[str, Map] | None:
    """Return the entries of a list by their ids, ``None`` where one has none, or two the same."""
    entries = {
        id_: item
        for item in items.items
        if isinstance(item, Map) and (id_ := text_of(item, "id")) is not None
    }
    return entries if len(entries) == len(items.items) else None


def default_outputs(package: str, kind: Kind, parts: Sequence[str]) -> list[dict[str, Any]]:
    """Return the ``EDDIOutputs`` of a configuration that names none."""
    if len(parts) > 1:
        return [{"id": part, "topic": f"{package}/{part}", "event": part} for part in parts]
    return [{"id": package, "topic": f"{package}/{kind.topic}"}]


def kinds_of_type(type_: str | None) -> list[Kind]:
    """Return the kinds that the ``Model: type:`` of a configuration can mean."""
    name = (type_ or "").casefold()
    return [kind for kind in kinds().values() if name in map(str.casefold, kind.config_types)]


def spelt_out(
    documents: Sequence[Map], source: Source, override: Map | None = None
) -> tuple[list[Map], list[Problem]]:
    """Return the configuration of each monitor in a file, from its documents.

    Values of ``override`` are used in place of those of the file; of several monitors, those below
    the id of a monitor in its document, all others in what is common.
    """
    problems: list[Problem] = []
    own = [_renamed(document, problems) for document in documents]
    common = Map(())
    if len(own) > 1 and own[0].get("Model") is None:
        common, *own = own
    if len(own) > 1 and override is not None:
        ids = [text_of(document.get("Model"), "id") or "" for document in own]
        of = {k.text: v for k, v in override.entries if isinstance(v, Map) and k.text in ids}
        own = [joined(document, of.get(id_)) for document, id_ in zip(own, ids, strict=True)]
        rest = tuple(entry for entry in override.entries if entry[0].text not in of)
        common = joined(common, replace(override, entries=rest))
    else:
        own = [joined(document, override) for document in own]
    wrong = [key for key, _ in common.entries if key.text not in _COMMON]
    problems += [problem("K003.common", key.place, key=key.text) for key in wrong]
    common = replace(common, entries=tuple(e for e in common.entries if e[0] not in wrong))
    own = [_with_common(common, document) for document in own]
    robot = _Robot(source, own)
    robot.problems += problems
    return [robot.spelt_out(document) for document in own], robot.problems


def _renamed(document: Map, problems: list[Problem]) -> Map:
    """Return a document with the names of its sections as they are meant."""
    entries = []
    for key, node in document.entries:
        name = _ALIASES.get(key.text, key.text)
        entries.append((replace(key, text=name), node))
        if name != key.text:
            problems.append(problem("K002", key.place, key=key.text, name=name))
    return replace(document, entries=tuple(entries))


def _with_common(common: Map, document: Map) -> Map:
    """Return a document with what is common to all, of the topics those that it mentions."""
    if not common.entries:
        return document
    texts = {scalar.text for scalar in scalars_of(document)}
    words = {word for text in texts for word in re.findall(r"\w+", text)} | texts
    entries = []
    for key, value in common.entries:
        used = [item for item in items_of(value) if text_of(item, "id") in words]
        entries.append((key, Items(tuple(used), value.place) if key.text == _COMMON[0] else value))
    return joined(Map(tuple(entries), document.place), document)


class _Robot:
    """The monitors of one file."""

    def __init__(self, source: Source, documents: Sequence[Map]) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self.clashing: Collection[str | None] = ()  # topics with the id of another monitor
        self.documents: dict[str, Map] = {}
        self.parts: dict[str, Sequence[str]] = {}  # file of a model -> what is published apart
        for document in documents:
            id_ = text_of(document.get("Model"), "id")
            if id_ is not None:
                self.documents.setdefault(id_, document)

    def spelt_out(self, document: Map) -> Map:
        """Return a configuration in full."""
        own = text_of(document.get("Model"), "id")
        topics = {text_of(item, "id") for item in items_of(document.get("SimulatorOutputs"))}
        self.clashing = {id_ for id_ in topics & {*self.documents} if id_ != own}
        read: dict[str, Map] = {}
        full: dict[str, tuple[Scalar, Node]] = {}
        for key, value in document.entries:
            node = value
            if key.text == "Model" and isinstance(value, Map):
                node = _model(document, value)
            elif key.text == "EDDIInputs" and isinstance(value, Items):
                inputs = tuple(self._input(item, topics, read) for item in value.items)
                node = replace(value, items=inputs)
            full[key.text] = key, node
        if read:
            none = Scalar("SimulatorOutputs", plain=True), Items(())
            key, value = full.get("SimulatorOutputs", none)
            full["SimulatorOutputs"] = key, Items((*items_of(value), *read.values()), value.place)
        return replace(document, entries=tuple(full.values()))

    def _input(self, entry: Node, topics: Collection[str | None], read: dict[str, Map]) -> Node:
        node = entry.get("from") if isinstance(entry, Map) else None
        if node is None or not isinstance(entry, Map):
            return entry
        text, place = as_text(node), node.place
        clashing = [key for key in _INSTEAD if entry.get(key) is not None]
        self.problems += [problem("K003.from", place, key=key) for key in clashing]
        names = ["EDDIInputs", text_of(entry, "id") or "", "from"]
        faults = [problem("K003.from_text", place)] if text is None else [*undecided(node, names)]
        self.problems += faults
        if text is None or faults:
            others = [pair for pair in entry.entries if pair[0].text != "from"]
            return replace(entry, entries=tuple(others))
        match, new = PATH.fullmatch(text.strip()), dict[str, Node | str | None]()
        claims: list[str] = []  # that are read
        if match is not None and (match["head"] in topics or match["head"] not in self.documents):
            head, rest = match["head"], match["rest"]
            self._clash(head, node)
            new["requires"] = Items((Scalar(head, plain=False, place=place),), place)
            col = None if place.col is None else place.col + len(head) + 1
            field = Scalar(rest.removeprefix("."), plain=False, place=replace(place, col=col))
            new["field"] = field if rest else None
        elif match is not None:
            reading = self._reading(match["head"], match["rest"].removeprefix("."), node, read)
            if reading is not None:
                claims.append(match[0])
                new["requires"] = Items((Scalar(reading[0], plain=False, place=place),), place)
                new["field"] = Scalar(reading[1], plain=False, place=place)
        else:

            def spelt(claim: re.Match[str]) -> str:
                name = claim["monitor"]
                if name is None or name in topics or name not in self.documents:
                    self._clash(name, node)
                    return claim[0]
                reading = self._reading(name, claim["claim"], node, read)
                if reading is None:
                    return claim[0]
                claims.append(claim[0])
                return ".".join(reading)

            written = _BLANK.sub(lambda blank: blank[1] or "", text)
            new["expression"] = Scalar(_CLAIM.sub(spelt, written), plain=False, place=place)
        if claims and entry.get("max_age") is None:
            new["max_age"] = str(MONITOR_AGE)
        entries: list[tuple[Scalar, Node]] = []
        for key, value in entry.entries:
            entries += map_of(place, new).entries if key.text == "from" else [(key, value)]
        return replace(entry, entries=tuple(entries))

    def _clash(self, name: str | None, node: Node) -> None:
        if name in self.clashing:
            self.problems.append(problem("K006.topic_and_monitor", node.place, name=name))

    def _reading(
        self, monitor: str, claim: str, node: Node, read: dict[str, Map]
    ) -> tuple[str, str] | None:
        """Return id and field by which a claim of another monitor is read; note its topic."""
        document = self.documents[monitor]
        model = document.get("Model")
        model = _model(document, model) if isinstance(model, Map) else model
        kind = next(iter(kinds_of_type(text_of(model, "type"))), None)
        if kind is None or kind.claim is None:  # told where its type is read
            return None
        package, keys = package_name(monitor), kind.claim.options
        parts = self._parts(model, kind) if kind.claim.apart else ()
        outputs = [item for item in items_of(document.get("EDDIOutputs")) if isinstance(item, Map)]
        texts = [{key.text: as_text(value) for key, value in item.entries} for item in outputs]
        texts = texts or [dict(output) for output in default_outputs(package, kind, parts)]
        all_of_it = [text for text in texts if not text.get("field")]
        fitting = [text for text in all_of_it if text.get("event") in {None, claim}]
        topic = next((text["topic"] for text in fitting if text.get("topic")), None)
        hint = None
        if not claim:
            hint = f"such as {monitor}.CLAIM"
        elif keys and isinstance(model, Map) and not any(items_of(model.get(key)) for key in keys):
            hint = f"write it below `Model: {keys[0]}:` of {monitor}"
        elif parts and claim not in parts:
            hint = f"there are: {', '.join(parts)}"
        elif topic is None:
            hint = "it has no topic in `EDDIOutputs`"
        if hint is not None or topic is None:
            self.problems.append(problem("K020.claim", node.place, hint=hint, monitor=monitor))
            return None
        id_ = f"{package}_{claim}" if len(all_of_it) > 1 else package
        is_of_d72 = any(text_of(model, key) == text for key, text in kind.wire_of_d72.items())
        claim = kind.claim.d72(claim) if is_of_d72 else claim
        type_, topic = f"eddi_messages/{kind.claim.message}", topic + kind.claim.behind
        read.setdefault(id_, _texts(node.place, {"id": id_, "type": type_, "topic": topic}))
        return id_, kind.claim.field.format(claim)

    def _parts(self, model: Node | None, kind: Kind) -> Sequence[str]:
        """Return the parts of a model that are published apart, of a file that is there."""
        parameters = items_of(model.get("parameters") if isinstance(model, Map) else None)
        named = (text_of(item, key) for item in (model, *parameters) for key in MODEL_KEYS)
        name = next(filter(None, named), "")
        if name not in self.parts:
            self.parts[name] = ()
            with suppress(EddiError, OSError, ValueError):  # told where the model is read
                source = read_source(next_to(self.source.name, name))
                models = kind.model_class.read_file(source, ()).models
                self.parts[name] = models[0].separate_outputs() if models else ()
        return self.parts[name]


def _model(document: Map, section: Map) -> Map:
    """Return a section with the file of the model as D7.2 names it, and thresholds of a network."""
    entries: list[tuple[Scalar, Node]] = []
    of_type = kinds_of_type(text_of(section, "type"))
    is_network = any("evidence" in kind.options for kind in of_type)
    for key, value in section.entries:
        if key.text == "model" and isinstance(value, Scalar):
            file = map_of(value.place, {"model": value})
            entries.append((replace(key, text="parameters"), Items((file,), value.place)))
        elif key.text == "thresholds" and is_network and isinstance(value, Items):
            items = tuple(map(_threshold, value.items))
            entries.append((replace(key, text="evidence"), replace(value, items=items)))
        else:
            entries.append((key, value))
    wire = {key: text for kind in of_type for key, text in kind.wire_of_d72.items()}
    is_of_d72 = text_of(document.get("Package"), "wire") == "d7.2"
    added = {key: text for key, text in wire.items() if is_of_d72 and section.get(key) is None}
    return replace(section, entries=(*entries, *map_of(section.place, added).entries))


def _threshold(entry: Node) -> Node:
    """Return a threshold with node and state in place of ``of: Lost=Yes``."""
    of = text_of(entry, "of")
    if of is None or not isinstance(entry, Map):
        return entry
    node, equals, state = map(str.strip, of.partition("="))
    entries: list[tuple[Scalar, Node]] = []
    for key, value in entry.entries:
        parts = {"node": node, "state": state} if equals else {"node": node}
        entries += _texts(value.place, parts).entries if key.text == "of" else [(key, value)]
    return replace(entry, entries=tuple(entries))
