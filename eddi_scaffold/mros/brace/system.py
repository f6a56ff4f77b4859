"""Reader of the brace dialect of ``.rossystem`` (2018 to 2022)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

from eddi_scaffold.mros.brace.tokens import TokenCursor, either
from eddi_scaffold.mros.model import (
    Component,
    Connection,
    InterfaceKind,
    System,
    SystemInterface,
)
from eddi_scaffold.mros.text import Text


@dataclass(frozen=True)
class _Section:
    """The words of one section of a component."""

    kind: InterfaceKind
    entries: tuple[str, ...]
    reference: str


_PUBLISHERS = _Section("publisher", ("RosPublisher", "RosTopicPublisher"), "RefPublisher")
_SUBSCRIBERS = _Section("subscriber", ("RosSubscriber", "RosTopicSubscriber"), "RefSubscriber")
_SECTIONS: dict[str, _Section] = {
    "RosPublishers": _PUBLISHERS,
    "RosSubscribers": _SUBSCRIBERS,
    "RosSrvServers": _Section("serviceserver", ("RosServiceServer",), "RefServer"),
    "RosSrvClients": _Section("serviceclient", ("RosServiceClient",), "RefClient"),
    "RosActionServers": _Section("actionserver", ("RosActionServer", "RosServer"), "RefServer"),
    "RosActionClients": _Section("actionclient", ("RosActionClient", "RosClient"), "RefClient"),
}
_OLD_SECTIONS = {"RosTopicPublishers": _PUBLISHERS, "RosTopicSubscribers": _SUBSCRIBERS}
_CONNECTIONS = {
    "TopicConnections": ("topic", "TopicConnection"),
    "ServiceConnections": ("service", "ServiceConnection"),
    "ActionConnections": ("action", "ActionConnection"),
}
_FROM, _TO = ("From", "FromTopic", "FromSrv"), ("To", "ToTopic", "ToSrv")


def read_system(text: Text) -> System:
    """Read a system.

    Raises:
        MrosSyntaxError: the text is not one.
    """
    return _SystemReader(TokenCursor(text)).read()


@dataclass
class _SystemReader:
    braces: TokenCursor
    components: list[Component] = field(default_factory=list)
    connections: list[Connection] = field(default_factory=list)
    parameters: int = 0
    references_only: bool = False

    def read(self) -> System:
        braces = self.braces
        braces.expect("RosSystem")
        opened = braces.open()
        name = braces.name("the name of the system") if braces.accept("Name") else ""
        while self._section():
            braces.accept_punct(",")
        known = ["RosComponents", "RosComponentStacks", *_CONNECTIONS, "Parameters"]
        braces.close("}", opened, *either(known))
        braces.expect_end("system")
        return System(
            "brace",
            name,
            tuple(self.components),
            tuple(self.connections),
            parameters=self.parameters,
            references_only=self.references_only,
        )

    def _section(self) -> bool:
        braces = self.braces
        if braces.accept("RosComponents", "RosComponent"):
            self._components()
        elif braces.accept("RosComponentStacks"):
            braces.block(self._stack, self._opening())
        elif braces.accept("Parameters"):
            braces.block(self._parameter)
        else:
            section = braces.accept(*_CONNECTIONS)
            if section is None:
                return False
            kind, word = _CONNECTIONS[section]
            braces.block(lambda: self._connection(kind, word))
        return True

    def _opening(self) -> str:
        """Return the bracket that opens a list: it closes as it opened."""
        if not self.braces.is_punct("(") and not self.braces.is_punct("{"):
            self.braces.fail("'('", "'{'")
        return "(" if self.braces.is_punct("(") else "{"

    def _components(self) -> None:
        self.braces.block(self._component, self._opening())

    def _stack(self) -> None:
        braces = self.braces
        braces.expect("ComponentStack")
        opened = braces.open()
        braces.expect("name")
        braces.name("the name of the stack")
        while True:
            if braces.accept("SafetyLevel"):
                braces.name("a safety level")
            elif braces.accept("RosComponents"):
                self._components()
            elif braces.accept("QualityAttributes"):
                if not braces.is_punct("{"):
                    braces.fail("'{'")
                braces.skip_group()
            else:
                break
        braces.close("}", opened, *either(["SafetyLevel", "RosComponents", "QualityAttributes"]))

    def _parameter(self) -> None:
        braces = self.braces
        braces.expect("Parameter")
        opened = braces.open()
        braces.expect("name")
        braces.name("the name of the parameter")
        braces.skip_to("}")
        braces.close("}", opened)
        self.parameters += 1

    def _component(self) -> None:
        braces = self.braces
        line, col = braces.place()
        if not braces.is_word("ComponentInterface") or not braces.is_before("{"):
            name = braces.name("'ComponentInterface' or the name of a component")
            self.references_only = True
            self.components.append(Component(name, None, None, (), 0, line, col))
            return
        braces.expect("ComponentInterface")
        opened = braces.open()
        name = braces.name("the name of the component") if braces.accept("name") else ""
        namespace = from_node = None
        interfaces: list[SystemInterface] = []
        parameters = 0
        while True:
            section = braces.accept(*_SECTIONS, *_OLD_SECTIONS)
            if section is not None:
                of = _SECTIONS.get(section) or _OLD_SECTIONS[section]
                interfaces += braces.block(partial(self._interface, of))
            elif braces.accept("NameSpace"):
                namespace = braces.name("a namespace")
            elif braces.accept("FromRosNode"):
                from_node = braces.name("a reference to a node")
            elif braces.accept("RosParameters"):
                parameters += len(braces.block(self._node_parameter))
            else:
                break
        known = ["NameSpace", "FromRosNode", *_SECTIONS, "RosParameters"]
        braces.close("}", opened, *either(known))
        self.components.append(
            Component(name, namespace, from_node, tuple(interfaces), parameters, line, col)
        )

    def _interface(self, section: _Section) -> SystemInterface:
        braces = self.braces
        line, col = braces.place()
        if braces.accept(*section.entries) is None:
            braces.fail(*either(section.entries[:1]), "'}'")
        name = None if braces.is_punct("{") else braces.name("the name of the interface")
        opened = braces.open()
        ns = braces.name("a namespace") if braces.accept("ns") else None
        braces.expect(section.reference)
        ref = braces.name("a reference")
        braces.close("}", opened)
        shown = name if name is not None else last_part(ref)
        return SystemInterface(section.kind, shown, ref, ns, line, col)

    def _node_parameter(self) -> None:
        braces = self.braces
        if braces.accept("RosParameter") is None:
            braces.fail("'RosParameter'", "'}'")
        if not braces.is_punct("{"):
            braces.name("the name of the parameter")
        opened = braces.open()
        if braces.accept("ns"):
            braces.name("a namespace")
        if braces.accept("RefParameter"):
            braces.name("a reference")
        if braces.accept("value"):
            braces.skip_to("}")
        braces.close("}", opened, *either(["RefParameter", "value"]))

    def _connection(self, kind: str, word: str) -> None:
        braces = self.braces
        line, col = braces.place()
        if braces.accept(word) is None:
            braces.fail(f"'{word}'", "'}'")
        name = None if braces.is_punct("{") else braces.name("the name of the connection")
        opened = braces.open()
        braces.expect(*_FROM)
        sources = self._references()
        braces.expect(*_TO)
        targets = self._references()
        braces.close("}", opened)
        self.connections.append(Connection(kind, name, sources, targets, line, col))

    def _references(self) -> tuple[str, ...]:
        braces = self.braces
        if not braces.is_punct("("):
            return (braces.name("component.interface"),)
        return tuple(braces.block(lambda: braces.name("component.interface"), "("))


def last_part(ref: str) -> str:
    """Return the interface of ``package.artifact.node.interface``, which may hold dots itself."""
    return ref.split(".", 3)[-1]
