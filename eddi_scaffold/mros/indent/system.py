"""Reader of the indentation dialect of ``.rossystem`` (2022 to today)."""

from __future__ import annotations

from dataclasses import dataclass, field

from eddi_scaffold.mros.indent.keys import Keys
from eddi_scaffold.mros.indent.lines import Line, LineCursor, blocks_of, skip_block
from eddi_scaffold.mros.model import (
    Component,
    Connection,
    InterfaceKind,
    SubSystem,
    System,
    SystemInterface,
)
from eddi_scaffold.mros.text import EMPTY_FILE, FOREIGN_FORMAT, Text, alternatives

_ARROWS: dict[str, InterfaceKind] = {
    "pub->": "publisher",
    "sub->": "subscriber",
    "ss->": "serviceserver",
    "sc->": "serviceclient",
    "as->": "actionserver",
    "ac->": "actionclient",
}
_FROM: dict[str, InterfaceKind] = {
    "frompub": "publisher",
    "fromsub": "subscriber",
    "fromss": "serviceserver",
    "fromsc": "serviceclient",
    "fromas": "actionserver",
    "fromac": "actionclient",
}
_SYSTEM = ("fromfile", "subsystems", "processes", "nodes", "parameters", "connections")
_NODE = ("from", "namespace", "interfaces", "parameters")


def read_system(text: Text) -> System:
    """Read a system.

    Raises:
        MrosSyntaxError: the text is not one; ``FOREIGN_FORMAT`` when it is the YAML of rossdl.
    """
    lines = [line for line in blocks_of(text) if not line.is_mark]
    if not lines:
        raise text.error(0, "there is nothing but comments in this file", EMPTY_FILE)
    first, *others = lines
    words = LineCursor(text, first)
    name = words.key("the system name")
    _refuse_rossdl(text, first)
    words.end()
    system = _SystemReader(text, Keys(text)).read(name, first)
    if others:
        raise text.error(others[0].offset, "one file holds one system: expected end of file")
    return system


def _refuse_rossdl(text: Text, first: Line) -> None:
    for line in first.below:
        word = line.tokens[0][1].lower() if line.tokens else ""
        if word == "systems":
            message = "this is a system in the YAML of rossdl, not a .rossystem"
            raise text.error(0, message, FOREIGN_FORMAT, "rossdl")


@dataclass
class _SystemReader:
    text: Text
    keys: Keys
    components: list[Component] = field(default_factory=list)
    connections: list[Connection] = field(default_factory=list)
    subsystems: list[SubSystem] = field(default_factory=list)

    def read(self, name: str, first: Line) -> System:
        from_file = None
        processes = parameters = 0
        for key, words, line in self.keys.known(first.below, _SYSTEM, "a key"):
            if key == "fromfile":
                from_file = words.name("a file name")
            elif key == "subsystems":
                self.subsystems += [self._subsystem(one) for one in line.below]
            elif key == "processes":
                processes += len(line.below)
            elif key == "parameters":
                parameters += len(line.below)
            elif key == "nodes":
                self.components += [self._node(one) for one in line.below]
            else:
                self.connections += [self._connection(one) for one in line.below]
            words.end()
        return System(
            "indent",
            name,
            tuple(self.components),
            tuple(self.connections),
            tuple(self.subsystems),
            from_file,
            processes,
            parameters,
            notices=tuple(self.keys.notices),
        )

    def _subsystem(self, line: Line) -> SubSystem:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.name("the name of a system")
        words.accept_punct(":")
        words.end()
        return SubSystem(name, *place)

    def _node(self, line: Line) -> Component:
        words = LineCursor(self.text, line)
        place = words.place()
        name = words.key("the name of a node")
        words.end()
        from_node = namespace = None
        interfaces: list[SystemInterface] = []
        parameters = 0
        for key, rest, inner in self.keys.known(line.below, _NODE, "a key"):
            if key == "from":
                from_node = rest.name("package.node")
            elif key == "namespace":
                namespace = rest.name("a namespace")
            elif key == "interfaces":
                interfaces += [self._interface(one) for one in inner.below]
            else:
                parameters += len(inner.below)
                skip_block(self.text, inner)
            rest.end()
        return Component(name, namespace, from_node, tuple(interfaces), parameters, *place)

    def _interface(self, line: Line) -> SystemInterface:
        words = LineCursor(self.text, line)
        place = words.place()
        label = words.key("the label of an interface")
        if words.at_end():
            return self._interface_of_2022(label, line, place)
        offset = words.offset
        word = words.name(f"an arrow ({alternatives(list(_ARROWS))})")
        kind = _ARROWS.get(word.lower())
        if kind is None:
            expected = alternatives([f"'{known}'" for known in _ARROWS])
            raise self.text.error(offset, f"expected {expected}, found '{word}'")
        if words.at_end():
            raise self.text.error(offset, f"expected a reference behind '{word}'")
        ref = words.name("a reference")
        words.end()
        return SystemInterface(kind, label, ref, None, *place)

    def _interface_of_2022(self, label: str, line: Line, place: tuple[int, int]) -> SystemInterface:
        """Read ``label:`` with ``fromPub: "package.artifact.node.interface"`` below it."""
        for key, words, _ in self.keys.known(line.below, _FROM, "a key"):
            ref = words.name("a reference")
            words.end()
            return SystemInterface(_FROM[key], label, ref, None, *place)
        expected = alternatives([f"'{known}'" for known in _ARROWS])
        last = line.tokens[-1][2]
        raise self.text.error(last, f"expected {expected} and a reference behind '{label}:'")

    def _connection(self, line: Line) -> Connection:
        words = LineCursor(self.text, line)
        place = words.place()
        offset = words.offset
        if not words.is_punct("["):
            raise words.fail("'['")
        names = words.names()
        words.end()
        if len(names) != 2:
            message = f"a connection has two labels, [from, to], this one has {len(names)}"
            raise self.text.error(offset, message)
        return Connection("", None, names[:1], names[1:], *place)
