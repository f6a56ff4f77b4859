"""Reader of the brace dialect of ``.ros`` (2018 to 2022)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

from eddi_scaffold.mros.brace.tokens import TokenCursor, either
from eddi_scaffold.mros.model import (
    Artifact,
    Field,
    Interface,
    InterfaceKind,
    Notice,
    Package,
    RosModel,
    RosNode,
    Spec,
)
from eddi_scaffold.mros.text import Text

_PACKAGES = ("Package", "CatkinPackage", "AmentPackage")
_SECTIONS: dict[str, tuple[InterfaceKind, str, str]] = {
    "Publishers": ("publisher", "Publisher", "message"),
    "publisher": ("publisher", "Publisher", "message"),
    "Subscribers": ("subscriber", "Subscriber", "message"),
    "subscriber": ("subscriber", "Subscriber", "message"),
    "ServiceServers": ("serviceserver", "ServiceServer", "service"),
    "serviceserver": ("serviceserver", "ServiceServer", "service"),
    "ServiceClients": ("serviceclient", "ServiceClient", "service"),
    "serviceclient": ("serviceclient", "ServiceClient", "service"),
    "ActionServers": ("actionserver", "ActionServer", "action"),
    "actionserver": ("actionserver", "ActionServer", "action"),
    "ActionClients": ("actionclient", "ActionClient", "action"),
    "actionclient": ("actionclient", "ActionClient", "action"),
}
_SPECS = {"TopicSpec": "topic", "ServiceSpec": "service", "ActionSpec": "action"}
_PARTS = ("message", "request", "response", "goal", "result", "feedback")


def read_model(text: Text) -> RosModel:
    """Read the packages of a file.

    Raises:
        MrosSyntaxError: the text is not a model of this dialect.
    """
    return _ModelReader(TokenCursor(text)).read()


@dataclass
class _Draft:
    """A package while it is read."""

    artifacts: list[Artifact] = field(default_factory=list)
    specs: list[Spec] = field(default_factory=list)
    dependencies: list[str] = field(default_factory=list)


@dataclass
class _ModelReader:
    braces: TokenCursor
    packages: list[Package] = field(default_factory=list)

    def read(self) -> RosModel:
        braces = self.braces
        braces.expect("PackageSet")
        opened = braces.open()
        if braces.accept("package"):
            braces.block(self._package)
        else:
            while braces.is_word(*_PACKAGES):
                self._package()
                braces.accept_punct(",")
        braces.close("}", opened, *either(_PACKAGES))
        notices = [Notice("M004.brace", line, col, {}) for line, col in braces.surplus()]
        braces.expect_end("package set")
        return RosModel("brace", tuple(self.packages), tuple(notices))

    def _package(self) -> None:
        braces = self.braces
        line, col = braces.place()
        kind = braces.expect(*_PACKAGES)
        name = braces.name("the name of the package")
        opened = braces.open()
        draft = _Draft()
        while self._part(draft):
            pass
        known = ["FromGitRepo", "Specs", "Artifact", "Dependencies"]
        braces.close("}", opened, *either(known))
        self.packages.append(
            Package(
                name,
                kind,
                tuple(draft.artifacts),
                tuple(draft.specs),
                tuple(draft.dependencies),
                line,
                col,
            )
        )

    def _part(self, draft: _Draft) -> bool:
        braces = self.braces
        if braces.accept("FromGitRepo"):
            braces.name("the address of a repository")
        elif braces.accept("Specs", "spec"):
            draft.specs += braces.block(self._spec)
        elif braces.accept("artifact"):
            draft.artifacts += braces.block(self._artifact)
        elif braces.is_word("Artifact"):
            draft.artifacts.append(self._artifact())
            braces.accept_punct(",")
        elif braces.accept("Dependencies", "dependency"):
            braces.block(lambda: self._dependency(draft))
        else:
            return False
        return True

    def _dependency(self, draft: _Draft) -> None:
        braces = self.braces
        braces.accept("PackageDependency", "ExternalDependency")
        if braces.is_punct("{") or braces.is_punct("["):
            braces.skip_group()
        else:
            draft.dependencies.append(braces.name("the name of a package"))

    def _artifact(self) -> Artifact:
        braces = self.braces
        line, col = braces.place()
        braces.expect("Artifact")
        name = braces.name("the name of the artifact")
        opened = braces.open()
        braces.accept("node")
        node = self._node() if braces.is_word("Node") else None
        braces.close("}", opened, *(() if node else ("'Node'",)))
        return Artifact(name, node, line, col)

    def _node(self) -> RosNode:
        braces = self.braces
        braces.expect("Node")
        opened = braces.open()
        braces.expect("name")
        name = braces.name("the name of the node")
        interfaces: list[Interface] = []
        parameters = 0
        while True:
            section = braces.accept(*_SECTIONS)
            if section is not None:
                kind, entry, type_word = _SECTIONS[section]
                interfaces += braces.block(partial(self._interface, kind, entry, type_word))
            elif braces.accept("Parameters", "parameter"):
                parameters += len(braces.block(self._parameter))
            else:
                break
            braces.accept_punct(",")
        known = [word for word in _SECTIONS if word[0].isupper()]
        braces.close("}", opened, *either([*known, "Parameters"]))
        return RosNode(name, tuple(interfaces), parameters)

    def _interface(self, kind: InterfaceKind, entry: str, type_word: str) -> Interface:
        braces = self.braces
        line, col = braces.place()
        if braces.accept(entry) is None:
            braces.fail(f"'{entry}'", "'}'")
        opened = braces.open()
        braces.expect("name")
        name = braces.name("the name of the interface")
        braces.expect(type_word)
        type_line, type_col = braces.place()
        of = braces.name("a type")
        ns = None
        if braces.accept("namespace"):
            ns = braces.name("a namespace")
            if braces.is_punct("{") or braces.is_punct("("):
                braces.skip_group()
        braces.close("}", opened)
        return Interface(kind, name, of, ns, line, col, type_line, type_col)

    def _parameter(self) -> int:
        braces = self.braces
        if braces.accept("Parameter") is None:
            braces.fail("'Parameter'", "'}'")
        opened = braces.open()
        braces.expect("name")
        braces.name("the name of the parameter")
        braces.skip_to("}")
        braces.close("}", opened)
        return 1

    def _spec(self) -> Spec:
        braces = self.braces
        line, col = braces.place()
        kind = _SPECS[braces.expect(*_SPECS)]
        name = braces.name("the name of the specification")
        opened = braces.open()
        sections: list[tuple[str, tuple[Field, ...]]] = []
        while True:
            part = braces.accept(*_PARTS)
            if part is None:
                break
            fields = [] if braces.accept("MessageDefinition") else braces.block(self._field)
            sections.append((part, tuple(fields)))
        braces.close("}", opened, *either(_PARTS))
        return Spec(kind, name, tuple(sections), line, col)

    def _field(self) -> Field:
        braces = self.braces
        of = braces.name("the type of a field")
        if braces.accept_punct("["):
            if not braces.is_punct("]"):
                braces.name("a length")
            if not braces.accept_punct("]"):
                braces.fail("']'")
            of += "[]"
        name = braces.name("the name of the field")
        name, equals, value = name.partition("=")
        if equals and not value:
            value = braces.name(f"the value of {name}")
        return Field(of, name, value if equals else None)
