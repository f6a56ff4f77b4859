"""Readers of ``.rossystem``, ``.ros``, ``.ros1`` and ``.ros2`` with indentation (2022 to today).

Keys may be in any case. An unknown one is a warning, so that a future one does not block reading;
one that is nearly known is an error, because what is below it would be lost.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import get_close_matches

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.mros.indent_lines import Line, LineCursor, blocks_of, skip_block
from eddi_scaffold.mros.model import (
    SECTIONS,
    Artifact,
    Component,
    Connection,
    Field,
    Interface,
    InterfaceKind,
    Package,
    RosModel,
    Spec,
    SubSystem,
    System,
    SystemInterface,
)
from eddi_scaffold.mros.text import SPEC_PARTS, Text, alternatives, quoted

_ARROWS = {section.arrow: section.kind for section in SECTIONS.values()}
_FROM = {f"from{arrow.removesuffix('->')}": kind for arrow, kind in _ARROWS.items()}
_SYSTEM = ("fromfile", "subsystems", "processes", "nodes", "parameters", "connections")
_NODE = ("from", "namespace", "interfaces", "parameters")
_PACKAGE = ("fromgitrepo", "artifacts", "msgs", "srvs", "actions", "specs", "dependencies")
_SECTIONS = {
    f"{kind}{plural}": section.kind for kind, section in SECTIONS.items() for plural in ("", "s")
}
_ARTIFACT = ("node", "parameters", "parameter", *_SECTIONS)
_SPEC_KINDS = {"msgs": "topic", "srvs": "service", "actions": "action", "specs": ""}
_SPEC_WORDS = {"msg": "topic", "srv": "service", "action": "action"}


class IndentReader:
    """Reader of either."""

    def __init__(self, text: Text) -> None:
        self.text = text
        self.problems: list[Problem] = []

    # what systems and models have in common

    def _known(self, line: Line, keys: Sequence[str]) -> Iterator[tuple[str, LineCursor, Line]]:
        """Yield known keys below a line, in lower case, each with the rest of its line, and it."""
        similar: dict[str, list[str]] = {}  # a generated file may repeat a key thousands of times
        for inner in line.below:
            rest = LineCursor(self.text, inner)
            place = rest.place()
            key = rest.key("a key")
            if key.lower() in keys:
                yield key.lower(), rest, inner
                continue
            if key not in similar:
                similar[key] = get_close_matches(key.lower(), keys, n=1, cutoff=0.8)
            if similar[key]:
                self.problems.append(
                    problem("M006.misspelt", place, key=key, meant=similar[key][0])
                )
            else:
                self.problems.append(problem("M005.unknown_key", place, key=key))

    def _heading(self, line: Line, what: str) -> tuple[str, Place]:
        """Read a line that is ``name:``; return the name and its place."""
        words = LineCursor(self.text, line)
        place, name = words.place(), words.key(what)
        words.end()
        return name, place

    # systems

    def system(self) -> System:
        """Read a system; the YAML of rossdl is refused."""
        lines = blocks_of(self.text)
        if not lines:
            raise self.text.error(0, "there is nothing but comments in this file", "empty")
        first = lines[0]
        words = LineCursor(self.text, first)
        name = words.key("the system name")
        if any(line.tokens[0][1].lower() == "systems" for line in first.below):
            message = "this is a system in the YAML of rossdl, not a .rossystem"
            raise self.text.error(0, message, "rossdl")
        words.end()
        system = System(self.text.file, "indent", name, problems=self.problems)
        for key, rest, line in self._known(first, _SYSTEM):
            if key == "fromfile":
                system.from_file = rest.name("a file name")
            elif key == "subsystems":
                system.subsystems += map(self._subsystem, line.below)
            elif key == "processes":
                system.processes += len(line.below)
            elif key == "nodes":
                system.components += map(self._component, line.below)
            elif key == "connections":
                system.connections += map(self._connection, line.below)
            rest.end()
        if len(lines) > 1:
            message = "one file holds one system: expected end of file"
            raise self.text.error(lines[1].offset, message)
        return system

    def _subsystem(self, line: Line) -> SubSystem:
        words = LineCursor(self.text, line)
        place, name = words.place(), words.name("the name of a system")
        words.accept(":")
        words.end()
        return SubSystem(name, place)

    def _component(self, line: Line) -> Component:
        name, place = self._heading(line, "the name of a node")
        component = Component(name, place)
        for key, rest, inner in self._known(line, _NODE):
            if key == "from":
                component.from_node = rest.name("package.node")
            elif key == "namespace":
                component.namespace = rest.name("a namespace")
            elif key == "interfaces":
                component.interfaces += map(self._system_interface, inner.below)
            else:
                component.parameters += len(inner.below)
                skip_block(self.text, inner)
            rest.end()
        return component

    def _system_interface(self, line: Line) -> SystemInterface:
        words = LineCursor(self.text, line)
        place, label = words.place(), words.key("the label of an interface")
        expected = alternatives([*map(repr, _ARROWS)])
        if words.at_end():  # in 2022 `fromPub: "package.artifact.node.interface"` is below it
            for key, words, _ in self._known(line, [*_FROM]):
                ref = words.name("a reference")
                words.end()
                return SystemInterface(_FROM[key], label, ref, None, place)
            words.fail(f"{expected} and a reference behind '{label}:'")
        offset = words.token[2]
        arrow = words.name(f"an arrow ({', '.join(_ARROWS)})")
        kind = _ARROWS.get(arrow.lower())
        if kind is None:
            raise self.text.error(offset, f"expected {expected}, found '{arrow}'")
        if words.at_end():
            raise self.text.error(offset, f"expected a reference behind '{arrow}'")
        ref = words.name("a reference")
        words.end()
        return SystemInterface(kind, label, ref, None, place)

    def _connection(self, line: Line) -> Connection:
        words = LineCursor(self.text, line)
        place, offset = words.place(), words.token[2]
        if not words.is_next("["):
            words.fail("'['")
        labels = words.names()
        words.end()
        if len(labels) != 2:
            message = f"a connection has two labels, [from, to], this one has {len(labels)}"
            raise self.text.error(offset, message)
        return Connection("", None, labels[:1], labels[1:], place)

    # node models

    def model(self) -> RosModel:
        """Read the packages of a file."""
        packages = [self._package(line) for line in blocks_of(self.text)]
        return RosModel(self.text.file, "indent", packages, self.problems)

    def _package(self, line: Line) -> Package:
        package = Package(self._heading(line, "a package name")[0])
        for key, rest, inner in self._known(line, _PACKAGE):
            if key == "artifacts":
                package.artifacts += map(self._artifact, inner.below)
                rest.end()
            elif key in _SPEC_KINDS:
                package.specs += [self._spec(spec, _SPEC_KINDS[key]) for spec in inner.below]
            else:
                skip_block(self.text, inner)
            rest.skip()  # a real file has `specs:Vector3`
        return package

    def _artifact(self, line: Line) -> Artifact:
        artifact = Artifact(self._heading(line, "the name of an artifact")[0])
        blocks = [line]
        for block in blocks:
            for key, rest, inner in self._known(block, _ARTIFACT):
                if key == "node":
                    artifact.node = rest.name("the name of the node")
                    blocks.append(inner)  # its sections may be indented deeper than itself
                elif key in _SECTIONS:
                    kind = _SECTIONS[key]
                    artifact.interfaces += [self._interface(each, kind) for each in inner.below]
                else:
                    artifact.parameters += len(inner.below)
                    skip_block(self.text, inner)
                rest.end()
        return artifact

    def _interface(self, line: Line, kind: InterfaceKind) -> Interface:
        name, place = self._heading(line, "the name of an interface")
        of = ns = None
        type_place = place
        for key, rest, inner in self._known(line, ("type", "ns", "qos")):
            if key == "type":
                type_place = rest.place()
                of = rest.name(f"the type of '{name}' behind 'type:'")
                rest.end()
            elif key == "ns":
                ns = None if rest.at_end() else rest.name("a namespace")
            else:
                skip_block(self.text, inner)
            rest.skip()
        if of is None:
            raise self.text.error(line.offset, f"the interface {quoted(name)} has no 'type:'")
        return Interface(kind, name, of, ns, place, type_place)

    def _spec(self, line: Line, kind: str) -> Spec:
        words = LineCursor(self.text, line)
        name = words.name("the name of a specification")
        if words.accept(":") and not words.at_end():
            kind = _SPEC_WORDS.get(name.lower(), kind)
            name = words.name("the name of a specification")
        words.end()
        return Spec(kind, name, tuple(map(self._section, line.below)))

    def _section(self, line: Line) -> tuple[str, tuple[Field, ...]]:
        words = LineCursor(self.text, line)
        offset, expected = words.token[2], alternatives(SPEC_PARTS)
        part = words.name(expected)
        if part.lower() not in SPEC_PARTS:
            raise self.text.error(offset, f"expected {expected}, found {quoted(part)}")
        words.accept(":")
        fields: list[Field] = []
        for cursor in (words, *(LineCursor(self.text, inner) for inner in line.below)):
            while not cursor.at_end():
                fields.append(cursor.field())
        return part.lower(), tuple(fields)
