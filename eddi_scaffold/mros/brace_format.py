"""Readers of ``.rossystem`` and ``.ros`` with braces (2018 to 2022).

White space separates, line ends mean nothing. No word is reserved: whether one is a keyword follows
from its place. What is not a token becomes an error only when a reader gets there, so that the
first error of a file is the one that is reported.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TypeVar

from eddi_scaffold.common.problems import problem
from eddi_scaffold.mros.model import (
    SECTIONS,
    Artifact,
    Component,
    Connection,
    Interface,
    Package,
    RosModel,
    Section,
    Spec,
    System,
    SystemInterface,
)
from eddi_scaffold.mros.text import SPEC_PARTS, STRING, Cursor, Text, Token, never_closed

T = TypeVar("T")

_TOKEN = re.compile(
    rf"""(?:\s+|//[^\n]*|/\*[\s\S]*?\*/)*
        (?:(?P<word>(?!/\*)[^\s"'{{}}()\[\],:]+)
          |{STRING}
          |(?P<punct>[{{}}()\[\],:])
          |(?P<bad>["']|/\*)
          |(?P<end>\Z))""",
    re.VERBOSE,
)
_CLOSING = {"{": "}", "(": ")", "[": "]"}
_LIST = "({"  # lists of systems open with either bracket
_CONNECTIONS = ("TopicConnections", "ServiceConnections", "ActionConnections")
_SYSTEM_SECTIONS = {section.system_section: section for section in SECTIONS.values()}
_SECTIONS_OF_2018 = {f"{section.system_entries[-1]}s": section for section in SECTIONS.values()}
_PACKAGES = ("Package", "CatkinPackage", "AmentPackage")
_MODEL_SECTIONS = {f"{section.entry}s": section for section in SECTIONS.values()}
_SPECS = {"TopicSpec": "topic", "ServiceSpec": "service", "ActionSpec": "action"}


def _tokens_of(text: str) -> list[Token]:
    """Return all tokens; after ``bad`` nothing follows but the end."""
    tokens: list[Token] = []
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "end"
        if kind == "end":
            break
        tokens.append((kind, match[kind], match.start(kind)))
        if kind == "bad":
            tokens[-1:] = [never_closed(match[kind], match.start(kind))]
            break
    return [*tokens, ("end", "end of file", len(text))]


class BraceReader(Cursor):
    """Reader of either."""

    def __init__(self, text: Text) -> None:
        super().__init__(text, _tokens_of(text.text))

    def open(self, brackets: str = "{") -> int:
        """Take one of some opening brackets and return its offset."""
        offset = self.token[2]
        self.expect(*brackets)
        return offset

    def close(self, opened: int, *others: str) -> None:
        """Take the bracket that closes one; the error names its place."""
        bracket = self.text.text[opened]
        if not self.accept(_CLOSING[bracket]):
            place = self.text.place(opened)
            closes = f"it closes the '{bracket}' of line {place.line}, column {place.col}"
            self.fail(*map(repr, others), f"'{_CLOSING[bracket]}' ({closes})")

    def block(self, read: Callable[[], T], brackets: str = "{") -> list[T]:
        """Read ``{ element ,? ... }``: a comma may be missing, and one may follow the last."""
        opened = self.open(brackets)
        elements: list[T] = []
        while not self.is_next("}", ")", "]") and not self.at_end():
            elements.append(read())
            self.accept(",")
        self.close(opened)
        return elements

    def keys(self, opened: int, known: Sequence[str], *aliases: str) -> Iterator[str]:
        """Take each key up to the closing bracket; what follows it is for the caller."""
        words = (*known, *aliases)
        while key := self.accept(*words):
            yield key
        self.close(opened, *known)

    def named(self, of: str) -> str:
        """Take ``name`` and what follows it."""
        self.expect("name")
        return self.name(f"the name of {of}")

    def behind(self, word: str, what: str) -> str | None:
        """Take a word and what follows it, if it is there."""
        return self.name(what) if self.accept(word) else None

    def skip_group(self, *opened: int) -> None:
        """Take a balanced group of brackets, or what remains of one."""
        stack = [*opened] or [self.open("{([")]
        while stack:
            kind, value, offset = self.token
            if kind in ("end", "bad") or value in ("}", ")", "]"):
                self.close(stack.pop())
                continue
            if value in _CLOSING:
                stack.append(offset)
            self._index += 1

    def skip_parameter(self, word: str) -> None:
        """Take a parameter, of which only the number counts."""
        self.expect(word)
        if not self.is_next("{"):
            self.name("the name of the parameter")
        opened = self.open()
        self.behind("name", "the name of the parameter")
        self.skip_group(opened)

    # systems

    def system(self) -> System:
        """Read a system."""
        self._system = system = System(self.text.file, "brace", "")
        self.expect("RosSystem")
        opened = self.open()
        system.name = self.behind("Name", "the name of the system") or ""
        known = ("RosComponents", "RosComponentStacks", *_CONNECTIONS, "Parameters")
        for key in self.keys(opened, known, "RosComponent"):
            if key == "RosComponentStacks":
                self.block(self._stack, _LIST)
            elif key == "Parameters":
                self.block(partial(self.skip_parameter, "Parameter"))
            elif key in _CONNECTIONS:
                system.connections += self.block(partial(self._connection, key[:-1]))
            else:
                system.components += self.block(self._component, _LIST)
            self.accept(",")
        if not self.at_end():
            self.fail("end of file (the system ends before)")
        return system

    def _stack(self) -> None:
        self.expect("ComponentStack")
        opened = self.open()
        self.named("the stack")
        for key in self.keys(opened, ("SafetyLevel", "RosComponents", "QualityAttributes")):
            if key == "SafetyLevel":
                self.name("a safety level")
            elif key == "RosComponents":
                self._system.components += self.block(self._component, _LIST)
            else:
                self.skip_group(self.open())

    def _component(self) -> Component:
        place = self.place()
        name = self.name("'ComponentInterface' or the name of a component")
        if name != "ComponentInterface" or not self.is_next("{"):
            self._system.references_only = True
            return Component(name, place)
        opened = self.open()
        component = Component(self.behind("name", "the name of the component") or "", place)
        known = ("NameSpace", "FromRosNode", *_SYSTEM_SECTIONS, "RosParameters")
        for key in self.keys(opened, known, *_SECTIONS_OF_2018):
            if key == "NameSpace":
                component.namespace = self.name("a namespace")
            elif key == "FromRosNode":
                component.from_node = self.name("a reference to a node")
            elif key == "RosParameters":
                component.parameters += len(
                    self.block(partial(self.skip_parameter, "RosParameter"))
                )
            else:
                section = _SYSTEM_SECTIONS.get(key) or _SECTIONS_OF_2018[key]
                component.interfaces += self.block(partial(self._system_interface, section))
        return component

    def _system_interface(self, section: Section) -> SystemInterface:
        place = self.place()
        self.expect(*section.system_entries)
        name = None if self.is_next("{") else self.name("the name of the interface")
        opened = self.open()
        ns = self.behind("ns", "a namespace")
        self.expect(section.reference)
        ref = self.name("a reference")
        self.close(opened)
        if name is None:  # the interface of package.artifact.node.interface may hold dots itself
            name = ref.split(".", 3)[-1]
        return SystemInterface(section.kind, name, ref, ns, place)

    def _connection(self, entry: str) -> Connection:
        place = self.place()
        self.expect(entry)
        name = None if self.is_next("{") else self.name("the name of the connection")
        opened = self.open()
        self.expect("From", "FromTopic", "FromSrv")
        sources = self._ends()
        self.expect("To", "ToTopic", "ToSrv")
        targets = self._ends()
        self.close(opened)
        kind = entry.removesuffix("Connection").lower()
        return Connection(kind, name, sources, targets, place)

    def _ends(self) -> tuple[str, ...]:
        end = partial(self.name, "component.interface")
        return tuple(self.block(end, "(")) if self.is_next("(") else (end(),)

    # node models

    def model(self) -> RosModel:
        """Read the packages of a file."""
        self.expect("PackageSet")
        opened = self.open()
        model = RosModel(self.text.file, "brace")
        if self.accept("package"):
            model.packages = self.block(self._package)
        while self.is_next(*_PACKAGES):
            model.packages.append(self._package())
            self.accept(",")
        self.close(opened, *_PACKAGES)
        while self.is_next("}"):
            model.problems.append(problem("M004.brace", self.place()))
            self.expect("}")
        if not self.at_end():
            self.fail("end of file (the package set ends before)")
        return model

    def _package(self) -> Package:
        self.expect(*_PACKAGES)
        package = Package(self.name("the name of the package"))
        opened = self.open()
        known = ("FromGitRepo", "Specs", "Artifact", "Dependencies")
        for key in self.keys(opened, known, "spec", "artifact", "dependency"):
            if key == "FromGitRepo":
                self.name("the address of a repository")
            elif key in ("Specs", "spec"):
                package.specs += self.block(self._spec)
            elif key == "artifact":
                package.artifacts += self.block(self._artifact)
            elif key == "Artifact":
                package.artifacts.append(self._artifact())
                self.accept(",")
            else:
                self.skip_group()
        return package

    def _artifact(self) -> Artifact:
        self.accept("Artifact")
        artifact = Artifact(self.name("the name of the artifact"))
        opened = self.open()
        self.accept("node")
        if self.accept("Node"):
            self._node(artifact)
        self.close(opened, *(() if artifact.node is not None else ("Node",)))
        return artifact

    def _node(self, artifact: Artifact) -> None:
        opened = self.open()
        artifact.node = self.named("the node")
        of_one = ("parameter", *SECTIONS)
        for key in self.keys(opened, (*_MODEL_SECTIONS, "Parameters"), *of_one):
            if key in ("Parameters", "parameter"):
                artifact.parameters += len(self.block(partial(self.skip_parameter, "Parameter")))
            else:
                section = _MODEL_SECTIONS.get(key) or SECTIONS[key]
                artifact.interfaces += self.block(partial(self._interface, section))
            self.accept(",")

    def _interface(self, section: Section) -> Interface:
        place = self.place()
        self.expect(section.entry)
        opened = self.open()
        name = self.named("the interface")
        self.expect(section.type_word)
        type_place = self.place()
        of = self.name("a type")
        ns = self.behind("namespace", "a namespace")
        if ns and self.is_next("{", "("):
            self.skip_group()
        self.close(opened)
        return Interface(section.kind, name, of, ns, place, type_place)

    def _spec(self) -> Spec:
        kind = _SPECS[self.expect(*_SPECS)]
        name = self.name("the name of the specification")
        opened = self.open()
        sections = [
            (part, () if self.accept("MessageDefinition") else tuple(self.block(self.field)))
            for part in self.keys(opened, SPEC_PARTS)
        ]
        return Spec(kind, name, tuple(sections))
