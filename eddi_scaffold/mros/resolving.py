"""Which interfaces of which nodes run in a system: its components joined with the node models."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem, shortened_list
from eddi_scaffold.mros.model import (
    SECTIONS,
    Artifact,
    Component,
    Interface,
    InterfaceKind,
    RosModel,
    System,
    SystemInterface,
)

LOST_TOPICS = ("M007.listed_only", "M023.missing")
"""After which a system may have topics that are not known."""


@dataclass(frozen=True)
class NodeModel:
    """One node as a file defines it."""

    file: str
    package: str
    artifact: Artifact

    @property
    def name(self) -> tuple[str, str]:
        """Its package and its own name, by which systems refer to it."""
        return self.package, self.artifact.node or ""


@dataclass(frozen=True)
class InterfaceReference:
    """What a system declares about where an interface is defined."""

    package: str  # empty in the form `artifact::interface`, as is `node`
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


@dataclass
class Models:
    """What a directory of models holds, in the order of the POSIX paths relative to it."""

    files: list[RosModel] = field(default_factory=list)
    systems: list[System] = field(default_factory=list)  # for sub-systems
    skipped: list[str] = field(default_factory=list)  # files that could not be read
    problems: list[Problem] = field(default_factory=list)  # of the files, readable or not

    @cached_property
    def nodes(self) -> Sequence[NodeModel]:
        """The nodes of all files, in reading order."""
        return [
            NodeModel(file.file, package.name, artifact)
            for file in self.files
            for package in file.packages
            for artifact in package.artifacts
            if artifact.node is not None
        ]

    @cached_property
    def by_name(self) -> Mapping[tuple[str, str], Sequence[NodeModel]]:
        """Package and name of a node -> its models."""
        names: dict[tuple[str, str], list[NodeModel]] = {}
        for node in self.nodes:
            names.setdefault(node.name, []).append(node)
        return names

    @cached_property
    def _by_artifact(self) -> Mapping[str, Sequence[NodeModel]]:
        artifacts: dict[str, list[NodeModel]] = {}
        for node in self.nodes:
            artifacts.setdefault(node.artifact.name, []).append(node)
        return artifacts

    def nodes_of(self, reference: InterfaceReference) -> list[NodeModel]:
        """Return the models of the node that a reference leads to, in reading order."""
        return [
            model
            for model in self._by_artifact.get(reference.artifact, ())
            if not reference.package or (reference.package, reference.node) == model.name
        ]

    def undefined(self, reference: InterfaceReference, listed: SystemInterface) -> Problem:
        """Explain why the reference of an interface leads nowhere."""
        models = self.nodes_of(reference)
        if not models:
            name = listed.ref.removesuffix(f".{reference.interface}").partition("::")[0]
            reason = f"no model defines {name!r}"
            return problem("M009.undefined", listed.place, hint=self.hint(name), reason=reason)
        names = sorted({
            interface.name
            for model in models
            for interface in model.artifact.interfaces
            if interface.kind == listed.kind
        })  # fmt: skip
        title = SECTIONS[listed.kind].title.partition(" ")[2]
        where = f"{models[0].artifact.name} ({models[0].file})"
        reason = f"{where} has no {title} {reference.interface!r}"
        hint = did_you_mean(reference.interface, names) or f"there are: {shortened_list(names)}"
        return problem("M009.undefined", listed.place, hint=hint, reason=reason)

    def hint(self, name: str) -> str | None:
        """Return which node or artifact is most like a name, and which files could not be read."""
        known = {*self._by_artifact, *map(".".join, self.by_name)}
        known |= {
            f"{node.package}.{node.artifact.name}.{node.artifact.node}" for node in self.nodes
        }
        skipped = f"could not be read: {', '.join(self.skipped)}" if self.skipped else None
        return "; ".join(filter(None, (did_you_mean(name, known), skipped))) or None


@dataclass(frozen=True)
class ResolvedInterface:
    """One interface of one running node, with its definition."""

    system: System
    component: Component
    listed: SystemInterface | None  # as the system names it; `None` where only the model does
    model: NodeModel  # of its node
    interface: Interface  # as the model names it

    @property
    def end(self) -> str:
        """How connections name it: its label, or ``component.interface``; empty for not at all."""
        if self.listed is None:
            return ""
        is_label = self.system.dialect == "indent"
        return self.listed.name if is_label else f"{self.component.name}.{self.listed.name}"

    @property
    def name(self) -> str:
        """The name in the system, else in the model."""
        return self.listed.name if self.listed is not None else self.interface.name

    @property
    def namespace(self) -> str | None:
        """The namespace that holds for this interface."""
        ns = self.listed.ns if self.listed is not None else None
        return ns if ns is not None else self.component.namespace

    @property
    def place(self) -> Place:
        """Where the system names it, else its component."""
        return (self.listed or self.component).place


class Resolver:
    """Finds the definitions of the interfaces of components.

    In the brace dialect exactly the listed interfaces run. In the indentation dialect all
    interfaces of the node model run that ``from:`` names; a listed one is renamed.
    """

    def __init__(
        self, models: Models, systems: Sequence[System], kinds: Collection[InterfaceKind]
    ) -> None:
        self.interfaces: list[ResolvedInterface] = []  # in the order of the system
        self.problems: list[Problem] = []  # what does not resolve; the rest does all the same
        self._known, self._kinds = models, kinds
        for system in systems:
            self._add(system)

    def _add(self, system: System) -> None:
        for component in system.components:
            models: Sequence[NodeModel] = ()
            if system.dialect == "indent":
                models = self._models(component)
            renamed = {
                self._listed(system, component, listed, models) for listed in component.interfaces
            }
            for interface in models[0].artifact.interfaces if models else ():
                if (interface.kind, interface.name) not in renamed:
                    model = models[0]
                    self._take(ResolvedInterface(system, component, None, model, interface))

    def _models(self, component: Component) -> Sequence[NodeModel]:
        """Return the models of ``from:``, which is ``package.node`` or, in 2022, three parts."""
        node = component.from_node or ""
        package, dot, name = node.partition(".")
        models = self._known.by_name.get((package, name.rpartition(".")[2]), ()) if dot else ()
        if not models:
            reason = f"there is no model of the node {component.name!r}, from: {node!r}"
            if not node:
                reason = f"the node {component.name!r} has no 'from:', so its model is not known"
            case = "M007.listed_only" if component.interfaces else "M007.nothing_listed"
            hint = self._known.hint(node)
            self.problems.append(problem(case, component.place, hint=hint, reason=reason))
        elif len({_interfaces(model) for model in models}) > 1:
            files = ", ".join(dict.fromkeys(model.file for model in models))
            place = component.place
            self.problems.append(problem("M007.several_models", place, node=node, files=files))
        return models

    def _listed(
        self,
        system: System,
        component: Component,
        listed: SystemInterface,
        models: Sequence[NodeModel],
    ) -> tuple[InterfaceKind, str]:
        """Resolve what a system lists; return kind and name in the model."""
        reference = InterfaceReference.parse(listed.ref)
        name = (listed.kind, reference.interface if reference is not None else "")
        if listed.kind not in self._kinds:
            return name
        place = listed.place
        if "?" in listed.name or "?" in listed.ref:
            self.problems.append(problem("M009.question_mark", place, name=listed.name))
            return name
        if reference is None:
            self.problems.append(problem("M009.short", place, ref=listed.ref))
            return name
        every = [
            (model, interface)
            for model in self._known.nodes_of(reference)
            for interface in model.artifact.interfaces
            if (interface.kind, interface.name) == name
        ]
        own = {model.name for model in models}
        definitions = [pair for pair in every if pair[0].name in own] or every
        if not definitions:
            self.problems.append(self._known.undefined(reference, listed))
            return name
        interfaces = [interface for _, interface in definitions]
        if len({interface.ros_type or interface.type for interface in interfaces}) > 1:
            types = ", ".join(dict.fromkeys(interface.type for interface in interfaces))
            fields = {"reference": listed.ref, "types": types}
            self.problems.append(problem("M012.several_types", place, **fields))
        self._take(ResolvedInterface(system, component, listed, *definitions[0]))
        return name

    def _take(self, resolved: ResolvedInterface) -> None:
        interface = resolved.interface
        if interface.kind not in self._kinds:
            return
        if "?" in interface.name:
            place = resolved.place
            self.problems.append(problem("M009.question_mark", place, name=interface.name))
        elif interface.ros_type is None:
            place = interface.type_place
            fields = {"type": interface.type, "interface": interface.name}
            self.problems.append(problem("M012.type", place, **fields))
        else:
            self.interfaces.append(resolved)


def _interfaces(model: NodeModel) -> frozenset[tuple[str, str, str]]:
    interfaces = model.artifact.interfaces
    return frozenset((interface.kind, interface.name, interface.type) for interface in interfaces)


def flattened(system: System, known: Sequence[System]) -> tuple[list[System], list[Problem]]:
    """Return a system behind its sub-systems, each once, and problems in the files of these.

    A sub-system is found by the name inside its file. One that is not there is a warning, a
    system that is part of itself an error.
    """
    by_name = {other.name: other for other in reversed(known)}
    systems: list[System] = []
    problems: list[Problem] = []

    def add(system: System, path: tuple[str, ...]) -> None:
        for part in system.subsystems:
            place, name = part.place, part.name
            if name in path:
                circle = " -> ".join((*path[path.index(name) :], name))
                problems.append(problem("M023.part_of_itself", place, system=name, circle=circle))
            elif name not in by_name:
                hint = did_you_mean(name, by_name)
                problems.append(problem("M023.missing", place, hint=hint, system=name))
            elif by_name[name] not in systems:
                problems.extend(by_name[name].problems)
                add(by_name[name], (*path, name))
        systems.append(system)

    add(system, (system.name,))
    return systems, problems
