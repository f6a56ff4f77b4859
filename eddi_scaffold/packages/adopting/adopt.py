"""``adopt`` as functions: an old package becomes bodies, configuration, model and a new package."""

from __future__ import annotations

import ast
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import attribute, package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.kinds import DeclaredInput, JsonValue, Model, Options, kinds
from eddi_scaffold.monitors.loading import checked_models, is_config, read_models, select_models
from eddi_scaffold.packages.adopting.old_package import (
    OldPackage,
    ParsedModule,
    foreign,
    read_old_package,
)
from eddi_scaffold.packages.adopting.wiring import OldInput, Wiring, published_ids, read_wiring
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import WriteResult, write_packages
from eddi_scaffold.packages.rendering import Template
from eddi_scaffold.packages.transaction import write
from eddi_scaffold.packages.workspace import packages_root
from eddi_scaffold.platforms import Platform
from eddi_scaffold.regions.choosing import Body
from eddi_scaffold.regions.markers import encode_id
from eddi_scaffold.regions.package import KEPT

_BY_CLASS: Mapping[str, JsonValue] = {"guarantee_ids": "class"}


@dataclass(frozen=True)
class Adoption:
    """What was found in an old package."""

    old: OldPackage
    id: str  # the `Model: id` of the recovered configuration, which names the new package
    model: Model
    model_file: Path  # the file that it was read from
    model_name: str  # the name that this file gets
    wiring: Wiring  # the content of the configuration
    bodies: Sequence[Body]  # hand-written bodies by region
    fitting: frozenset[str]  # the regions of those that were written for these inputs or states
    rejects: dict[str, str]  # module -> text of what a person wrote outside of the places for it
    notes: Sequence[str]  # what the user must know, one line each

    def config(self) -> str:
        """Return the text of the recovered configuration."""
        kind = kinds()[self.model.kind]
        return self.wiring.as_yaml(self.id, kind.config_types[0], self.model_name)


def adopt(folder: Path, model_file: Path | None, name: str | None) -> Adoption:
    """Read an old package; nothing is executed, nothing is changed.

    A model file takes the place of that in the package, a name that of the old one; it also tells
    which model of a file with several is meant.

    Raises:
        EddiError: the package or the model cannot be used (A001, A002).
    """
    old = read_old_package(folder)
    name = name or old.name
    file, models = _models(old, model_file)
    model = _chosen(models, name)
    # networks of several packages have one name, GeNIe's, but files of their own
    name = name or model.file_stem or model.name
    id_ = model.name if package_name(name) == package_name(model.name) else name
    own = model.file_stem if model_file is None else None
    renamed = own and package_name(own) != package_name(id_)
    wiring = _of_the_model(read_wiring(old.node, old.eddi_input, old.config), model)
    published = published_ids(old.monitor)
    choices: Sequence[Mapping[str, JsonValue]] = ({}, _BY_CLASS)
    by_class = next((choice for choice in choices if published <= _guarantees(model, choice)), {})
    methods = [method for module in model.editable_modules() for method in module.methods]
    nodes = {method.name.removeprefix("node_"): method.about for method in methods}
    observed = [nodes[node] for node in _observed(old.config) if node in nodes]
    options = {**by_class, **({"observed": observed} if observed else {})}
    notes: list[str] = []
    bodies: list[Body] = []
    rejects: dict[str, str] = {}
    for module, prefix in ((old.eddi_input, "process_"), (old.config, "node_")):
        if module is None:
            continue
        bodies += _bodies(module, prefix)
        statements = [f"# line {s.lineno}\n{module.text_of(s)}" for s in foreign(module, prefix)]
        if statements:
            rejects[module.path.name] = "\n\n".join(statements) + "\n"
            notes.append(f"{module.path}: lines outside of the regions are kept in .eddi/kept")
    # methods that get the messages, and have the states, that they had before
    old_inputs = old.eddi_input.methods if old.eddi_input is not None else {}
    old_nodes = old.config.methods if old.config is not None else {}
    fitting = {
        f"process_{attribute(input_.id)}"
        for input_ in wiring.inputs
        if (method := old_inputs.get(f"process_{input_.id}"))
        and method.arguments == input_.requires
    }
    fitting |= {
        new.name
        for new in methods
        if (method := old_nodes.get(new.name))
        and {*_outcomes(method.tree), "dra_data"} == {*new.uses}
    }
    notes += [f"not recovered: {what}" for what in wiring.lost]
    if by_class:
        shown = ", ".join(f"{key}: {value}" for key, value in by_class.items())
        notes.append(f"{shown}: the old monitor publishes {', '.join(sorted(published))}")
    return Adoption(
        old=old,
        id=id_,
        model=model,
        model_file=file,
        model_name=f"{package_name(id_)}{file.suffix}" if renamed else file.name,
        wiring=replace(wiring, options=options),
        bodies=bodies,
        fitting=frozenset(fitting),
        rejects=rejects,
        notes=notes,
    )


def _guarantees(model: Model, options: Mapping[str, JsonValue]) -> set[str]:
    configured, _ = model.configure(Options(values=options))
    return {*(configured or model).element_keys().get("guarantees", ())}


def _models(old: OldPackage, named: Path | None) -> tuple[Path, Sequence[Model]]:
    if named is not None:
        return named, checked_models(named).models
    damage: list[Problem] = []
    for path in old.models:
        source = read_source(path)
        if is_config(source):
            continue
        reading = read_models(source)
        if reading.models and not has_errors(reading.problems):
            return path, reading.models
        damage += [problem for problem in reading.problems if problem.level == "error"][:1]
    raise EddiError(*damage, problem("A002.no_model", Place(str(old.folder))))


def _chosen(models: Sequence[Model], name: str | None) -> Model:
    """Return the only model of a file, or the one that is called as the package (F005, G005)."""
    if len(models) == 1:
        return models[0]
    if name is None:
        names = ", ".join(model.name for model in models)
        raise EddiError(problem("G005.several", Place(models[0].source.name), names=names))
    return select_models(models, name)[0]


def _of_the_model(wiring: Wiring, model: Model) -> Wiring:
    """Leave out inputs that the model does not have, and defaults that would be good evidence."""
    declared = tuple(
        DeclaredInput(input_.id, None, None, input_.default, model.place)
        for input_ in wiring.inputs
    )
    configured, _ = model.configure(Options(inputs=declared))
    known = {input_.id: input_ for input_ in (configured or model).inputs()}
    inputs: list[OldInput] = []
    lost = list(wiring.lost)
    for input_ in wiring.inputs:
        default, item = input_.default, known.get(input_.id)
        if item is None:
            lost.append(f"the input {input_.id!r}, which the model does not have")
            continue
        if default is not None and item.is_good is not None and item.is_good(default):
            lost.append(f"the default {default!r} of {input_.id!r}: it counted as good evidence")
            default = None
        inputs.append(replace(input_, default=default))
    if not wiring.inputs:
        lost += [f"the input {name!r}: there is no method process_{name}" for name in known]
    return replace(wiring, inputs=inputs, lost=lost)


def _bodies(module: ParsedModule, prefix: str) -> Iterator[Body]:
    """Yield the bodies of a module as if a package of ours had saved them."""
    for method in module.methods.values():
        if method.name.startswith(prefix):
            bare = prefix == "process_" and method.region is None
            region = module.whole_body(method) if bare else method.region
            if region is not None and region.body.strip():
                yield Body(region, module.path.name, kept=True)


def _observed(config: ParsedModule | None) -> Iterator[str]:
    """Yield the nodes, as named in Python, of which the body (not its frame) sets an outcome."""
    for method in config.methods.values() if config is not None else ():
        if method.name.startswith("node_") and method.region is not None:
            inside = (s for s in method.tree.body if s not in method.outside)
            nodes = (node for statement in inside for node in ast.walk(statement))
            names = (node for node in nodes if isinstance(node, ast.Name))
            assigned = {name.id for name in names if isinstance(name.ctx, ast.Store)}
            if not _outcomes(method.tree).isdisjoint(assigned):
                yield method.name.removeprefix("node_")


def _outcomes(tree: ast.FunctionDef) -> set[str]:
    """Return the variables of the states, from the dictionary that the method returns."""
    return {
        value.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Dict)
        for value in node.values
        if isinstance(value, ast.Name)
    }


def write_adopted(
    adoption: Adoption, platform: Platform, place: Path, template: Template, *, dry_run: bool
) -> tuple[WriteResult, Sequence[Problem], Sequence[str]]:
    """Generate the new package with the old bodies in its regions, its configuration and its model.

    Returns:
        What was written, problems, and a report in lines.

    Raises:
        EddiError: the new package, or another file in the place of its model or configuration, is
            there already (G003), the place is in the old package (G006), or it cannot be
            generated.
    """
    if place.resolve().is_relative_to(adoption.old.folder.resolve()):
        raise EddiError(problem("G006.old_package", Place(str(place))))
    root = packages_root(platform, place)
    package = package_name(adoption.id)
    if os.path.lexists(root / package):
        raise EddiError(problem("G003.package_exists", Place(str(root / package))))
    config_name = f"{package}_config.yml"
    model = read_source(adoption.model_file).data
    files = {config_name: adoption.config().encode(), adoption.model_name: model}
    new: dict[str, bytes] = {}
    for name, data in files.items():
        if not os.path.lexists(place / name):
            new[name] = data
        elif read_source(place / name).data != data:
            raise EddiError(problem("G003.file_exists", Place(str(place / name))))
    with tempfile.TemporaryDirectory(prefix="eddi-scaffold-") as scratch:
        for name, data in files.items():
            Path(scratch, name).write_bytes(data)
        try:
            monitors, problems = monitors_of(None, [Path(scratch, config_name)])
            plan = assemble(monitors, platform, root, problems)
        except EddiError as failed:
            raise EddiError(*(_at_place(problem, place) for problem in failed.problems)) from None
    rejects = {f"{name}.adopted": text.encode() for name, text in adoption.rejects.items()}
    bodies = [body._replace(fits=body.region.id in adoption.fitting) for body in adoption.bodies]
    packages = [
        replace(new, saved=bodies, adopted=rejects) if new.folder == package else new
        for new in plan.packages
    ]
    outcome = write_packages(root, packages, template, dry_run=dry_run)
    look = outcome.attention or bool(adoption.rejects or adoption.wiring.lost)
    problems = [_at_place(problem, place) for problem in plan.problems]
    report: list[str] = []
    if not dry_run:
        write(place, new)
        report = [f"written: {place / name}" for name in files]
        kept = {f"{package}/{KEPT}/{encode_id(body.region.id)}.region": body for body in bodies}
        report += [
            f"{body.region.id}: the body is in its region"
            for path, body in kept.items()
            if path not in outcome.changes
        ]
        report.append("the old files were left as they are")
    return replace(outcome, attention=look), problems, report


def _at_place(problem: Problem, folder: Path) -> Problem:
    """Name a file by its final path, not by that of the trial."""
    place = problem.place
    moved = replace(place, file=str(folder / Path(place.file).name)) if place.file else place
    return replace(problem, place=moved)
