"""A directory of node models as a dictionary: which interfaces are defined, and where."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.mros.model import (
    Interface,
    InterfaceKind,
    Notice,
    RosModel,
    RosNode,
    System,
)

WORDS: dict[InterfaceKind, str] = {
    "publisher": "a publisher",
    "subscriber": "a subscriber",
    "serviceserver": "a service server",
    "serviceclient": "a service client",
    "actionserver": "an action server",
    "actionclient": "an action client",
}


@dataclass(frozen=True)
class NodeModelFile:
    """One readable file of node models.

    Attributes:
        file: POSIX path relative to the directory.
    """

    file: str
    model: RosModel


@dataclass(frozen=True)
class SystemFile:
    """One readable ``.rossystem``.

    Attributes:
        file: relative to the directory of models if it lies there, else as it was given.
    """

    file: str
    system: System


@dataclass(frozen=True)
class Models:
    """What a directory of models holds.

    Attributes:
        files: in the order of their paths.
        systems: for sub-systems; in the order of their paths.
        skipped: files that could not be read.
        problems: of the files, which may be readable all the same.
    """

    files: tuple[NodeModelFile, ...]
    systems: tuple[SystemFile, ...] = ()
    skipped: tuple[str, ...] = ()
    problems: tuple[Problem, ...] = ()

    @cached_property
    def definitions(self) -> Definitions:
        """The interfaces of all files by name."""
        return Definitions(self.files, self.skipped)


@dataclass(frozen=True)
class NodeModel:
    """One node as a file defines it."""

    file: str
    package: str
    artifact: str
    node: RosNode


@dataclass(frozen=True)
class Definition:
    """One interface of one node as a file defines it."""

    of: NodeModel
    interface: Interface


@dataclass(frozen=True)
class InterfaceReference:
    """What a system declares about where an interface is defined.

    Attributes:
        package: empty in the form ``artifact::interface``, as is ``node``.
    """

    package: str
    artifact: str
    node: str
    interface: str

    @classmethod
    def parse(cls, text: str) -> InterfaceReference | None:
        """Parse ``artifact::interface`` or ``package.artifact.node.interface``."""
        artifact, colons, interface = text.partition("::")
        if colons and artifact and interface:
            return cls("", artifact, "", interface)
        parts = text.split(".", 3)
        return cls(*parts) if len(parts) == 4 and all(parts) else None

    def names(self, model: NodeModel) -> bool:
        """Return whether a node is the one meant."""
        if not self.package:
            return self.artifact == model.artifact
        own = (self.package, self.artifact, self.node)
        return own == (model.package, model.artifact, model.node.name)


class Definitions:
    """All nodes and interfaces of some files, found by name."""

    def __init__(self, files: Iterable[NodeModelFile], skipped: Sequence[str] = ()) -> None:
        self._skipped = skipped
        self._nodes: dict[tuple[str, str], list[NodeModel]] = defaultdict(list)
        self._by_artifact: dict[str, list[NodeModel]] = defaultdict(list)
        for file in files:
            for package in file.model.packages:
                for artifact in package.artifacts:
                    if artifact.node is not None:
                        node = NodeModel(file.file, package.name, artifact.name, artifact.node)
                        self._nodes[package.name, artifact.node.name].append(node)
                        self._by_artifact[artifact.name].append(node)

    def nodes(self, package: str, node: str) -> Sequence[NodeModel]:
        """Return the models of a node, in reading order."""
        return self._nodes.get((package, node), ())

    def find(self, reference: InterfaceReference, kind: InterfaceKind) -> list[Definition]:
        """Return the definitions that a reference can mean, in reading order."""
        return [
            Definition(model, interface)
            for model in self._by_artifact.get(reference.artifact, ())
            if reference.names(model)
            for interface in model.node.interfaces
            if interface.kind == kind and interface.name == reference.interface
        ]

    def reason(self, reference: InterfaceReference, kind: InterfaceKind) -> tuple[str, str | None]:
        """Explain why a reference finds nothing: message and hint."""
        named = [
            model
            for model in self._by_artifact.get(reference.artifact, ())
            if reference.names(model)
        ]
        if not named:
            return self._no_node(reference)
        same = [interface for model in named for interface in model.node.interfaces]
        others = sorted({one.kind for one in same if one.name == reference.interface})
        where = f"{named[0].artifact} ({named[0].file})"
        if others:
            what = " and ".join(WORDS[other] for other in others)
            return f"{reference.interface!r} of {where} is {what}, not {WORDS[kind]}", None
        names = sorted({one.name for one in same if one.kind == kind})
        hint = did_you_mean(reference.interface, names)
        if hint is None:
            hint = f"there are: {', '.join(names)}" if names else "there is none at all"
        return f"{where} has no {WORDS[kind].partition(' ')[2]} {reference.interface!r}", hint

    def hint_for_node(self, named: str) -> str | None:
        """Return what helps who named a node in ``from:`` that no file defines."""
        with_artifact = named.count(".") > 1
        known = {
            f"{one.package}.{one.artifact}.{one.node.name}"
            if with_artifact
            else f"{one.package}.{one.node.name}"
            for one in self._every_node()
        }
        return self._hint(named, known)

    def _every_node(self) -> Iterable[NodeModel]:
        return (model for models in self._nodes.values() for model in models)

    def _hint(self, wanted: str, known: Iterable[str]) -> str | None:
        """Return the nearest name, and the files that could not be read."""
        skipped = f"could not be read: {', '.join(self._skipped)}" if self._skipped else None
        near = did_you_mean(wanted, known)
        return f"{near} ({skipped})" if near and skipped else near or skipped

    def _no_node(self, reference: InterfaceReference) -> tuple[str, str | None]:
        every = self._every_node()
        if reference.package:
            wanted = f"{reference.package}.{reference.artifact}.{reference.node}"
            known = {f"{one.package}.{one.artifact}.{one.node.name}" for one in every}
        else:
            wanted, known = reference.artifact, {one.artifact for one in every}
        what = "node" if reference.package else "artifact"
        return f"no model defines the {what} {wanted!r}", self._hint(wanted, known)


def noticed(notices: tuple[Notice, ...], file: str) -> Iterator[Problem]:
    """Return the notices of a readable file as problems."""
    for notice in notices:
        yield problem(notice.case, Place(file, notice.line, notice.col), **notice.fields)
