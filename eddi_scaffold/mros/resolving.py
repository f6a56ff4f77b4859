"""Which interfaces of which nodes run in a system: its components joined with the node models."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.mros.interface_definitions import (
    Definition,
    Definitions,
    InterfaceReference,
    NodeModel,
    SystemFile,
    noticed,
)
from eddi_scaffold.mros.model import Component, Dialect, InterfaceKind, SystemInterface
from eddi_scaffold.mros.topics import type_of

LOST_TOPICS = ("M007.listed_only", "M023.missing")
"""After which a system may have topics that are not found."""


@dataclass(frozen=True)
class ResolvedInterface:
    """One interface of one running node, with its definition.

    Attributes:
        label: its name in the system; ``None`` where only the model names it.
        package: of its type.
        type: without package.
        place: of the interface in the system; of its component where it is not listed.
        dialect: of the system; it decides how connections name an interface.
    """

    kind: InterfaceKind
    component: Component
    label: str | None
    ns: str | None
    definition: Definition
    package: str
    type: str
    place: Place
    dialect: Dialect

    @property
    def end(self) -> str:
        """How connections name it: its label, or ``component.interface``; empty for not at all."""
        if self.label is None:
            return ""
        return self.label if self.dialect == "indent" else f"{self.component.name}.{self.label}"

    @property
    def name(self) -> str:
        """The name in the system, else in the model."""
        return self.label if self.label is not None else self.model_name

    @property
    def model_name(self) -> str:
        """The name in the model."""
        return self.definition.interface.name

    @property
    def namespace(self) -> str | None:
        """The namespace that holds for this interface."""
        return self.ns if self.ns is not None else self.component.namespace


def resolve(
    component: Component,
    dialect: Dialect,
    file: str,
    definitions: Definitions,
    kinds: Collection[InterfaceKind],
) -> tuple[list[ResolvedInterface], list[Problem]]:
    """Find the definitions of a component's interfaces.

    In the brace dialect exactly the listed interfaces run. In the indentation dialect all
    interfaces of the node model run that ``from:`` names; a listed one is renamed.

    Args:
        component: one node of the system.
        dialect: of the system.
        file: of the system, for places.
        definitions: what the node models define.
        kinds: what is asked for; interfaces of other kinds are not looked at.
    """
    join = _Join(component, dialect, file, definitions, kinds)
    if dialect == "indent":
        join.every_interface()
    else:
        join.listed(())
    return join.found, join.problems


class _Join:
    def __init__(
        self,
        component: Component,
        dialect: Dialect,
        file: str,
        definitions: Definitions,
        kinds: Collection[InterfaceKind],
    ) -> None:
        self.component, self.dialect, self.file = component, dialect, file
        self.definitions, self.kinds = definitions, kinds
        self.found: list[ResolvedInterface] = []
        self.problems: list[Problem] = []
        self.here = Place(file, component.line, component.col)

    def every_interface(self) -> None:
        models = self._models()
        renamed = self.listed(models)
        if not models:
            return
        model = models[0]
        if any(_interfaces(other) != _interfaces(model) for other in models[1:]):
            files = ", ".join(dict.fromkeys(other.file for other in models))
            self.problems.append(
                problem(
                    "M007.several_models", self.here, node=self.component.from_node, files=files
                )
            )
        for interface in model.node.interfaces:
            if (interface.kind, interface.name) not in renamed and interface.kind in self.kinds:
                self._take(None, None, [Definition(model, interface)], self.here)

    def _models(self) -> Sequence[NodeModel]:
        """Return the models of ``from:``, which is ``package.node`` or, in 2022, three parts."""
        named = self.component.from_node
        parts = named.split(".") if named else []
        models = self.definitions.nodes(parts[0], parts[-1]) if len(parts) > 1 else ()
        if models:
            return models
        name = self.component.name
        reason = f"there is no model of the node {name!r}, from: {named!r}"
        if not named:
            reason = f"the node {name!r} has no 'from:', so its model is not known"
        hint = self.definitions.hint_for_node(named or "")
        case = "M007.listed_only" if self.component.interfaces else "M007.nothing_listed"
        self.problems.append(problem(case, self.here, hint=hint, reason=reason))
        return ()

    def listed(self, models: Sequence[NodeModel]) -> set[tuple[InterfaceKind, str]]:
        """Resolve what the system lists; return kind and name in the model of each."""
        renamed = set()
        for interface in self.component.interfaces:
            reference = InterfaceReference.parse(interface.ref)
            if reference is not None:
                renamed.add((interface.kind, reference.interface))
            if interface.kind in self.kinds:
                self._listed(interface, reference, models)
        return renamed

    def _listed(
        self,
        interface: SystemInterface,
        reference: InterfaceReference | None,
        models: Sequence[NodeModel],
    ) -> None:
        place = Place(self.file, interface.line, interface.col)
        if "?" in interface.name or "?" in interface.ref:
            self._unresolved_name(interface.name, place)
            return
        if reference is None:
            self.problems.append(problem("M009.short", place, ref=interface.ref))
            return
        found = self.definitions.find(reference, interface.kind)
        own = {(model.package, model.node.name) for model in models}
        nearer = [one for one in found if (one.of.package, one.of.node.name) in own]
        found = nearer or found
        if not found:
            reason, hint = self.definitions.reason(reference, interface.kind)
            self.problems.append(problem("M009.undefined", place, hint=hint, reason=reason))
            return
        if self._are_different(found):
            types = ", ".join(dict.fromkeys(one.interface.type for one in found))
            self.problems.append(
                problem("M012.several_types", place, reference=interface.ref, types=types)
            )
        self._take(interface.name, interface.ns, found, place)

    @staticmethod
    def _are_different(found: Iterable[Definition]) -> bool:
        types = {type_of(one.interface.type) or one.interface.type for one in found}
        return len(types) > 1

    def _unresolved_name(self, name: str, place: Place) -> None:
        self.problems.append(problem("M009.question_mark", place, name=name))

    def _take(
        self, label: str | None, ns: str | None, found: Sequence[Definition], place: Place
    ) -> None:
        first = found[0]
        interface = first.interface
        if "?" in interface.name:
            self._unresolved_name(interface.name, place)
            return
        of = type_of(interface.type)
        if of is None:
            there = Place(first.of.file, interface.type_line, interface.type_col)
            self.problems.append(
                problem("M012.type", there, type=interface.type, interface=interface.name)
            )
            return
        self.found.append(
            ResolvedInterface(
                interface.kind,
                self.component,
                label,
                ns,
                first,
                *of,
                place=place,
                dialect=self.dialect,
            )
        )


def _interfaces(model: NodeModel) -> set[tuple[str, str, str]]:
    return {(interface.kind, interface.name, interface.type) for interface in model.node.interfaces}


@dataclass
class Flat:
    """Systems in the order in which their components come: parts first."""

    systems: list[SystemFile] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


def flattened(system: SystemFile, known: Sequence[SystemFile]) -> Flat:
    """Return a system behind its sub-systems, each once.

    A sub-system is found by the name inside its file. One that is not there is a warning, a
    system that is part of itself an error. Problems in the files of parts are reported as well.
    """
    by_name: dict[str, SystemFile] = {}
    for one in known:
        by_name.setdefault(one.system.name, one)
    flat = Flat()
    _add(system, by_name, (system.system.name,), flat)
    return flat


def _add(system: SystemFile, known: dict[str, SystemFile], path: tuple[str, ...], to: Flat) -> None:
    for part in system.system.subsystems:
        place = Place(system.file, part.line, part.col)
        if part.name in path:
            circle = " -> ".join((*path[path.index(part.name) :], part.name))
            to.problems.append(
                problem("M023.part_of_itself", place, system=part.name, circle=circle)
            )
        elif part.name not in known:
            hint = did_you_mean(part.name, known)
            to.problems.append(problem("M023.missing", place, hint=hint, system=part.name))
        elif known[part.name] not in to.systems:
            found = known[part.name]
            to.problems += noticed(found.system.notices, found.file)
            _add(found, known, (*path, part.name), to)
    to.systems.append(system)
