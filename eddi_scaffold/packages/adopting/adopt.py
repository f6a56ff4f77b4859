"""``adopt`` as a function: an old package becomes bodies, a configuration and a model."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import attribute, package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.kinds import DeclaredInput, JsonValue, Kind, Model, Options, kinds
from eddi_scaffold.monitors.loading import checked_models, is_config, read_models, select_models
from eddi_scaffold.packages.adopting.old_package import (
    Body,
    OldPackage,
    ParsedModule,
    read_old_package,
    whole_body,
)
from eddi_scaffold.packages.adopting.proposals import BodyUse, foreign, use_of
from eddi_scaffold.packages.adopting.wiring import (
    OldInput,
    Wiring,
    compared_texts,
    published_ids,
    read_wiring,
)
from eddi_scaffold.regions.choosing import Body as SavedBody
from eddi_scaffold.regions.marked_file import Region
from eddi_scaffold.regions.markers import Digests, begin_marker, end_marker

_BY_CLASS: Mapping[str, JsonValue] = {"guarantee_ids": "class"}


@dataclass(frozen=True)
class Adoption:
    """What was found in an old package.

    Attributes:
        id: the ``Model: id`` of the recovered configuration, which names the package.
        model: the model.
        model_file: the file that it was read from.
        model_name: the name that this file gets.
        bodies: hand-written bodies by region.
        fitting: the regions of those that were written for just these inputs or states.
        headers: module -> the comments above all else in it.
        rejects: module -> text of what a person wrote outside of the places for it.
        notes: what the user must know, one line each.
    """

    old: OldPackage
    id: str
    model: Model
    kind: Kind
    model_file: Path
    model_name: str
    wiring: Wiring
    bodies: tuple[SavedBody, ...]
    fitting: frozenset[str]
    rejects: dict[str, str]
    notes: tuple[str, ...]

    def config(self) -> str:
        """Return the text of the recovered configuration."""
        return self.wiring.as_yaml(self.id, self.kind.config_types[0], self.model_name)


def adopt(folder: Path, model_file: Path | None, name: str | None) -> Adoption:
    """Read an old package; nothing is executed, nothing is changed.

    Args:
        folder: the old package.
        model_file: the model to use in place of the one in the package.
        name: of the new package in place of the old one's, and which model of a file with several.

    Raises:
        EddiError: the package or the model cannot be used (A001, A002).
    """
    old = read_old_package(folder)
    wanted = name or old.name
    file, models = _models(old, model_file)
    model = _chosen(models, wanted)
    # networks of several packages have one name, GeNIe's, but files of their own
    wanted = wanted or model.file_stem or model.name
    id_ = model.name if package_name(wanted) == package_name(model.name) else wanted
    own = model_file is None and model.file_stem
    renamed = own and package_name(own) != package_name(id_)
    model_name = f"{package_name(id_)}{file.suffix}" if renamed else file.name
    kind = kinds()[model.kind]
    wiring = _of_the_model(read_wiring(old.node, old.eddi_input, old.config), model)
    published = published_ids(old.monitor)
    by_class = _options(published, model)
    uses = _uses(old.config, {input_.id for input_ in wiring.inputs if input_.known_type == "bool"})
    nodes = _nodes(model)
    observed = [nodes[name] for name, use in uses.items() if use.observed and name in nodes]
    options = {**by_class, **({"observed": observed} if observed else {})}
    wiring = replace(wiring, options=options)
    notes: list[str] = []
    bodies: list[SavedBody] = []
    rejects: dict[str, str] = {}
    for module, prefix in ((old.eddi_input, "process_"), (old.config, "node_")):
        if module is None:
            continue
        bodies += _bodies(module, prefix)
        if module.header.strip():
            bodies.append(_saved(f"{module.path.stem}.module", module, "", module.header))
        text = "\n\n".join(
            f"# line {getattr(one, 'lineno', 0)}\n{module.commented(one)}"
            for one in foreign(module, prefix)
        )
        if text:
            rejects[module.path.name] = text + "\n"
            notes.append(f"{module.path}: lines outside of the regions are kept in .eddi/kept")
        notes += [
            f"{module.path}: this import is not carried over: {module.segment(import_)}"
            for import_ in module.imports
            if not _is_frame_import(import_)
        ]
    fitting = {*_fitting_inputs(old.eddi_input, wiring), *_fitting_nodes(old.config, model)}
    notes += [f"not recovered: {what}" for what in wiring.lost]
    if by_class:
        shown = ", ".join(f"{key}: {value}" for key, value in by_class.items())
        notes.append(f"{shown}: the old monitor publishes {', '.join(sorted(published))}")
    notes += _by_class(compared_texts(old.eddi_input), models)
    notes += [_report(name, use) for name, use in uses.items()]
    return Adoption(
        old=old,
        id=id_,
        model=model,
        kind=kind,
        model_file=file,
        model_name=model_name,
        wiring=wiring,
        bodies=tuple(bodies),
        fitting=frozenset(fitting),
        rejects=rejects,
        notes=tuple(notes),
    )


def _options(published: frozenset[str], model: Model) -> Mapping[str, JsonValue]:
    """Return what the configuration must say for the monitor to publish the ids of the old one."""
    choices: Sequence[Mapping[str, JsonValue]] = ({}, _BY_CLASS)
    return next((choice for choice in choices if published <= _guarantees(model, choice)), {})


def _guarantees(model: Model, options: Mapping[str, JsonValue]) -> set[str]:
    """Return the ids of guarantees that a monitor publishes."""
    configured, _ = model.configure(Options(values=options))
    return {*(configured or model).element_keys().get("guarantees", ())}


def _by_class(texts: Collection[str], models: Sequence[Model]) -> Iterator[str]:
    """Report class names with which hand-written code compares the ids of other monitors."""
    for model in models:
        names = _guarantees(model, _BY_CLASS) - _guarantees(model, {})
        if found := names & {*texts}:
            shown = ", ".join(sorted(found))
            yield f"{shown}: {model.name} publishes this with `guarantee_ids: class` only"


def _fitting_inputs(module: ParsedModule | None, wiring: Wiring) -> Iterator[str]:
    """Yield the regions of inputs whose messages the methods get by the same names as before."""
    for input_ in wiring.inputs:
        method = module.methods.get(f"process_{input_.id}") if module is not None else None
        if method is not None and method.arguments == input_.requires:
            yield f"process_{attribute(input_.id)}"


def _fitting_nodes(module: ParsedModule | None, model: Model) -> Iterator[str]:
    """Yield the regions of nodes whose methods have the outcomes that they had before."""
    for new in (one for each in model.editable_modules() for one in each.methods):
        method = module.methods.get(new.name) if module is not None else None
        if method is not None and {*_outcomes(method.tree), "dra_data"} == {*new.uses}:
            yield new.name


def _models(old: OldPackage, given: Path | None) -> tuple[Path, Sequence[Model]]:
    if given is not None:
        return given, checked_models(given).models
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
    """Return the only model of a file, or the one that is called as the package.

    Raises:
        EddiError: none is called so (F005), or there is no name to choose by (G005).
    """
    if len(models) > 1 and name is None:
        names = ", ".join(model.name for model in models)
        raise EddiError(problem("G005.several", Place(models[0].source.name), names=names))
    return models[0] if len(models) == 1 else select_models(models, name)[0]


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
        item = known.get(input_.id)
        if item is None:
            lost.append(f"the input {input_.id!r}, which the model does not have")
        elif (
            input_.default is not None and item.is_good is not None and item.is_good(input_.default)
        ):
            lost.append(
                f"the default {input_.default!r} of {input_.id!r}: it counted as good evidence"
            )
            inputs.append(replace(input_, default=None))
        else:
            inputs.append(input_)
    if not wiring.inputs:
        lost += [f"the input {name!r}: there is no method process_{name}" for name in known]
    return replace(wiring, inputs=tuple(inputs), lost=tuple(lost))


def _nodes(model: Model) -> dict[str, str]:
    """Return name in Python -> id of each node."""
    methods = [method for module in model.editable_modules() for method in module.methods]
    return {method.name.removeprefix("node_"): method.about for method in methods}


def _bodies(module: ParsedModule, prefix: str) -> Iterator[SavedBody]:
    for method in module.methods.values():
        if not method.name.startswith(prefix):
            continue
        body: Body | None = method.body
        if body is None and prefix == "process_":
            body = whole_body(method, module)
        if body is not None and body.text.strip():
            yield _saved(method.name, module, body.indent, body.text)


def _saved(region: str, module: ParsedModule, indent: str, text: str) -> SavedBody:
    """Return a body as it would have been saved from a package of ours."""
    begin, end = f"{indent}{begin_marker(region)}", f"{indent}{end_marker(region)}"
    text = text if text.endswith("\n") else f"{text}\n"
    made = Region(region, Digests(), (), None, 1, begin, text, end)
    return SavedBody(made, module.path.name, kept=True)


def _uses(config: ParsedModule | None, truths: Collection[str]) -> dict[str, BodyUse]:
    """Return what the body of each node's method does, by the node's name in Python."""
    methods = config.methods.values() if config is not None else ()
    return {
        (name := method.name.removeprefix("node_")): use_of(
            name, method.body, _outcomes(method.tree), truths
        )
        for method in methods
        if method.name.startswith("node_") and method.body is not None
    }


def _report(name: str, use: BodyUse) -> str:
    """Return what the body of a node does, and what could be declared instead."""
    words = [
        word
        for word, holds in (("observed by code", use.observed), ("an output", use.output))
        if holds
    ]
    line = f"{name}: {' and '.join(words) or 'unused'}"
    return f"{line}; could be declared: {use.proposal}" if use.proposal else line


def _outcomes(tree: ast.FunctionDef) -> dict[str, str]:
    """Return variable -> state, from the dictionary that the method returns."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and isinstance(value, ast.Name):
                    found[value.id] = str(key.value)
    return found


def _is_frame_import(node: ast.stmt) -> bool:
    """Return whether the old generator wrote an import."""
    names = [alias.name for alias in getattr(node, "names", ())]
    module = getattr(node, "module", None) or ""
    return module in {"typing", "__future__"} or module.endswith(".msg") or names == ["rospy"]


def leftover(old: OldPackage, taken: Sequence[Path]) -> list[str]:
    """Return the files of the old package that are not needed any more, as one would list them."""
    return [str(old.folder / file) for file in old.files if old.folder / file not in taken]
