"""``adopt`` as a function: an old package becomes bodies, a configuration and a model."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.adopting.expected import foreign
from eddi_scaffold.adopting.modules import Body, ParsedModule, whole_body
from eddi_scaffold.adopting.package import OldPackage, read_old_package
from eddi_scaffold.adopting.proposals import use_of
from eddi_scaffold.adopting.wiring import OldInput, Wiring, read_wiring
from eddi_scaffold.kinds import DeclaredInput, Kind, Model, Options, kinds
from eddi_scaffold.monitors.choosing import select
from eddi_scaffold.monitors.loading import checked_models, is_config, read_models
from eddi_scaffold.problems import EddiError, Place, error, has_errors
from eddi_scaffold.regions.result import Orphan
from eddi_scaffold.source import read_source


@dataclass(frozen=True)
class Adoption:
    """What was found in an old package.

    Attributes:
        model: the model, and the file that it was read from.
        config: text of the recovered configuration.
        bodies: hand-written bodies by region.
        rejects: module -> text of what a person wrote outside of the places for it.
        notes: what the user must know, one line each.
    """

    old: OldPackage
    model: Model
    kind: Kind[Model]
    model_file: Path
    wiring: Wiring
    bodies: tuple[Orphan, ...]
    rejects: dict[str, str]
    notes: tuple[str, ...]

    def config(self, model: str) -> str:
        """Return the text of a configuration that names the model by this file."""
        return self.wiring.as_yaml(self.model.name, self.kind.config_types[0], model)


def adopt(folder: Path, model_file: Path | None, name: str | None) -> Adoption:
    """Read an old package; nothing is executed, nothing is changed.

    Args:
        folder: the old package.
        model_file: the model to use in place of the one in the package.
        name: which model of that file.

    Raises:
        EddiError: the package or the model cannot be used (A001 to A004).
    """
    old = read_old_package(folder)
    file, model = _model(old, model_file, name)
    kind = kinds()[model.kind]
    notes: list[str] = []
    bodies: list[Orphan] = []
    rejects: dict[str, str] = {}
    for module, prefix, region in (
        (old.eddi_input, "process_", "input"),
        (old.config, "node_", "node"),
    ):
        if module is None:
            continue
        names = _names(model, kind, region)
        bodies += _bodies(module, prefix, region, names)
        text = "\n\n".join(
            f"# line {getattr(one, 'lineno', 0)}\n{module.segment(one)}"
            for one in foreign(module, prefix)
        )
        if text:
            rejects[module.path.name] = text + "\n"
            notes.append(f"{module.path}: lines outside of the regions are kept in .eddi/rejects")
        notes += [
            f"{module.path}: this import is not carried over: {module.segment(one)}"
            for one in module.imports
            if not _is_frame_import(one)
        ]
    wiring = _fitting(read_wiring(old.node, old.eddi_input), model, kind)
    notes += [f"not recovered: {what}" for what in wiring.lost]
    notes += _uses(old.config)
    return Adoption(old, model, kind, file, wiring, tuple(bodies), rejects, tuple(notes))


def _model(old: OldPackage, given: Path | None, name: str | None) -> tuple[Path, Model]:
    if given is not None:
        found = select(checked_models(given).models, name)
        return given, found[0]
    for path in old.models:
        source = read_source(path)
        if is_config(source):
            continue
        reading = read_models(source)
        if reading.models and not has_errors(reading.problems):
            return path, select(reading.models, name)[0]
    message = "the package contains no model that a monitor can be generated from"
    hint = "name it: -m MODEL (the EDDI, the .xdsl or the ConSert YAML)"
    raise EddiError(error("A004", message, Place(str(old.folder)), hint))


def _fitting(wiring: Wiring, model: Model, kind: Kind[Model]) -> Wiring:
    """Leave out inputs that the model does not have, and defaults that would be good evidence."""
    declared = tuple(
        DeclaredInput(one.id, None, None, one.default, model.place) for one in wiring.inputs
    )
    configured, _ = kind.functions.configure(model, Options(inputs=declared))
    known = {one.id: one for one in kind.functions.inputs(configured or model)}
    inputs: list[OldInput] = []
    lost = list(wiring.lost)
    for one in wiring.inputs:
        item = known.get(one.id)
        if item is None:
            lost.append(f"the input {one.id!r}, which the model does not have")
        elif one.default is not None and item.is_good is not None and item.is_good(one.default):
            lost.append(f"the default {one.default!r} of {one.id!r}: it counted as good evidence")
            inputs.append(replace(one, default=None))
        else:
            inputs.append(one)
    return replace(wiring, inputs=tuple(inputs), lost=tuple(lost))


def _names(model: Model, kind: Kind[Model], region: str) -> dict[str, str]:
    """Return name in Python -> id of the region's element: the name itself, then its identifier."""
    if region == "input":
        return {}
    methods = [method for module in kind.functions.modules(model) for method in module.methods]
    return {
        method.name.removeprefix("node_"): method.region.partition(":")[2] for method in methods
    }


def _bodies(
    module: ParsedModule, prefix: str, region: str, names: dict[str, str]
) -> Iterator[Orphan]:
    for method in module.methods.values():
        if not method.name.startswith(prefix):
            continue
        name = method.name.removeprefix(prefix)
        body: Body | None = method.body
        if body is None and prefix == "process_":
            body = whole_body(method, module)
        if body is not None and body.text.strip():
            yield Orphan(
                f"{region}:{names.get(name, name)}", module.path.name, None, body.indent, body.text
            )


def _uses(config: ParsedModule | None) -> list[str]:
    """Report for each node of a network what its body does, and what could be declared instead."""
    found = []
    for method in config.methods.values() if config is not None else ():
        if not method.name.startswith("node_") or method.body is None:
            continue
        name = method.name.removeprefix("node_")
        use = use_of(name, method.body, _outcomes(method.tree))
        what = [
            word
            for word, holds in (("observed by code", use.observed), ("an output", use.output))
            if holds
        ]
        line = f"{name}: {' and '.join(what) or 'unused'}"
        found.append(f"{line}; could be declared: {use.proposal}" if use.proposal else line)
    return found


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
