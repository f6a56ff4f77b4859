"""Reader of the indentation dialect of ``.ros``, ``.ros1`` and ``.ros2`` (2022 to today)."""

from __future__ import annotations

from dataclasses import dataclass

from eddi_scaffold.mros.indent.keys import Keys
from eddi_scaffold.mros.indent.lines import Line, LineCursor, blocks_of, skip_block
from eddi_scaffold.mros.model import (
    Artifact,
    Field,
    Interface,
    InterfaceKind,
    Package,
    RosModel,
    RosNode,
    Spec,
)
from eddi_scaffold.mros.text import Text, quoted

_PACKAGE = ("fromgitrepo", "artifacts", "msgs", "srvs", "actions", "specs", "dependencies")
_KINDS: dict[str, InterfaceKind] = {
    "publisher": "publisher",
    "subscriber": "subscriber",
    "serviceserver": "serviceserver",
    "serviceclient": "serviceclient",
    "actionserver": "actionserver",
    "actionclient": "actionclient",
}
_SECTIONS: dict[str, InterfaceKind] = _KINDS | {f"{name}s": kind for name, kind in _KINDS.items()}
_SPEC_KINDS = {"msgs": "topic", "srvs": "service", "actions": "action", "specs": ""}
_SPEC_WORDS = {"msg": "topic", "srv": "service", "action": "action"}
_PARTS = ("message", "request", "response", "goal", "result", "feedback")


def read_model(text: Text) -> RosModel:
    """Read the packages of a file.

    Raises:
        MrosSyntaxError: the text is not a model of this dialect.
    """
    reader = _ModelReader(text, Keys(text))
    lines = [line for line in blocks_of(text) if not line.is_mark]
    packages = tuple(reader.package(line) for line in lines)
    return RosModel("indent", packages, tuple(reader.keys.notices))


@dataclass
class _ModelReader:
    text: Text
    keys: Keys

    def package(self, line: Line) -> Package:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.key("a package name")
        words.end()
        artifacts: list[Artifact] = []
        specs: list[Spec] = []
        dependencies: list[str] = []
        for key, rest, inner in self.keys.known(line.below, _PACKAGE, "a key"):
            if key == "fromgitrepo":
                rest.name("the address of a repository")
                rest.skip()
            elif key == "artifacts":
                artifacts += [self._artifact(one) for one in inner.below]
            elif key == "dependencies":
                dependencies += self._dependencies(rest, inner)
            else:
                rest.skip()  # a real file has `specs:Vector3`
                specs += [self._spec(one, _SPEC_KINDS[key]) for one in inner.below]
            rest.end()
        return Package(name, "", tuple(artifacts), tuple(specs), tuple(dependencies), *place)

    def _dependencies(self, words: LineCursor, line: Line) -> list[str]:
        found = [] if words.at_end() else list(words.names())
        for inner in line.below:
            rest = LineCursor(self.text, inner)
            found += rest.names()
            rest.end()
        return found

    def _artifact(self, line: Line) -> Artifact:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.key("the name of an artifact")
        words.end()
        node_name = None
        interfaces: list[Interface] = []
        parameters = 0
        blocks = [line]
        while blocks:
            block = blocks.pop(0)
            for key, rest, inner in self.keys.known(
                block.below, ("node", "parameters", "parameter", *_SECTIONS), "a key"
            ):
                if key == "node":
                    node_name = rest.name("the name of the node")
                    blocks.append(inner)  # its sections may be indented deeper than itself
                elif key in _SECTIONS:
                    interfaces += [self._interface(one, _SECTIONS[key]) for one in inner.below]
                else:
                    parameters += len(inner.below)
                    skip_block(self.text, inner)
                rest.end()
        node = None if node_name is None else RosNode(node_name, tuple(interfaces), parameters)
        return Artifact(name, node, *place)

    def _interface(self, line: Line, kind: InterfaceKind) -> Interface:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.key("the name of an interface")
        words.end()
        of = ns = None
        type_place, deadline = place, ""
        for key, rest, inner in self.keys.known(line.below, ("type", "ns", "qos"), "a key"):
            if key == "type":
                if rest.at_end():
                    raise rest.fail(f"the type of '{name}' behind 'type:'")
                type_place = rest.place()
                of = rest.name("a type")
                rest.end()
            elif key == "ns":
                ns = None if rest.at_end() else rest.name("a namespace")
                rest.skip()
            else:
                rest.skip()
                skip_block(self.text, inner)
                deadline = _deadline(inner)
        if of is None:
            raise self.text.error(line.offset, f"the interface {quoted(name)} has no 'type:'")
        return Interface(kind, name, of, ns, *place, *type_place, deadline)

    def _spec(self, line: Line, kind: str) -> Spec:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.name("the name of a specification")
        if words.accept_punct(":") and not words.at_end():
            kind = _SPEC_WORDS.get(name.lower(), kind)
            name = words.name("the name of a specification")
        words.end()
        sections = tuple(self._section(inner) for inner in line.below)
        return Spec(kind, name, sections, *place)

    def _section(self, line: Line) -> tuple[str, tuple[Field, ...]]:
        words = LineCursor(self.text, line)
        offset = words.offset
        name = words.name("message, request, response, goal, result or feedback")
        if name.lower() not in _PARTS:
            expected = "message, request, response, goal, result or feedback"
            raise self.text.error(offset, f"expected {expected}, found {quoted(name)}")
        words.accept_punct(":")
        fields = list(self._fields(words))
        for inner in line.below:
            fields += self._fields(LineCursor(self.text, inner))
        return name.lower(), tuple(fields)

    def _fields(self, words: LineCursor) -> list[Field]:
        found: list[Field] = []
        while not words.at_end():
            first = words.name("the type of a field")
            if words.accept_punct(":"):
                found.append(Field(self._type_behind(words), first))
                continue
            first = self._array_of(first, words)
            name = words.name("the name of the field")
            name, equals, value = name.partition("=")
            if equals and not value:
                value = words.name(f"the value of {name}")
            found.append(Field(first, name, value if equals else None))
        return found

    def _array_of(self, of: str, words: LineCursor) -> str:
        """Read ``[]`` or ``[9]`` behind a type, if it is there."""
        if not words.accept_punct("["):
            return of
        if not words.is_punct("]"):
            words.name("a length")
        if not words.accept_punct("]"):
            raise words.fail("']'")
        return f"{of}[]"

    def _type_behind(self, words: LineCursor) -> str:
        """Read the type of ``name: type``, a form of May 2023; ``[T]`` also marks plain fields."""
        if not words.accept_punct("["):
            plain = words.name("the type of the field")
            return self._array_of(plain, words)
        of = words.name("the type of the field")
        if not words.accept_punct("]"):
            raise words.fail("']'")
        return f"[{of}]"


def _deadline(qos: Line) -> str:
    """Return what stands behind ``deadline:`` in a quality of service."""
    for line in qos.below:
        key, *rest = [text for _, text, _ in line.tokens] or [""]
        if key.casefold() == "deadline" and rest[:1] == [":"]:
            return " ".join(rest[1:]).strip("\"'")
    return ""
