"""Which models are in a file, whatever its format, and which of them is asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    did_you_mean,
    has_errors,
    problem,
    shortened_list,
)
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.config.file import ConfigFile, has_section, named_model, named_model_path
from eddi_scaffold.eddi_xml import survey
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.document import recognises as is_xml
from eddi_scaffold.eddi_xml.extensions import Observed, check_maps
from eddi_scaffold.eddi_xml.hazard_analysis import hazard_analysis
from eddi_scaffold.eddi_xml.links import links_in, links_of
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.kinds import Kind, Model, Options, ReadResult, kinds
from eddi_scaffold.monitors.spellings import kinds_of_type
from eddi_scaffold.yaml_text.nodes import read_map

YAML_SUFFIXES = (".yml", ".yaml")
_CONSERT_KEYS = {"guarantees", "demands", "evidence", "gates", "tree_propagations"}


def is_config(source: Source) -> bool:
    """Return whether a file is an eddi_config.yml, which no reader of models understands."""
    return has_section(source, {"Model", "SimulatorOutputs", "SimulatorOutput", "EDDIInputs"})


def named_like_mros(name: str) -> bool:
    """Return whether a file name is that of a ``.rossystem``, ``.ros``, ``.ros1`` or ``.ros2``."""
    from eddi_scaffold.mros import MODEL_SUFFIXES, SYSTEM_SUFFIX  # noqa: PLC0415 - with its readers

    return name.endswith((SYSTEM_SUFFIX, *MODEL_SUFFIXES))


def read_models(source: Source, default_guarantees: Sequence[str] = ()) -> ReadResult:
    """Read every model of every kind in one file, with all problems."""
    place, name = Place(source.name), source.name.lower()
    for kind in kinds().values():
        if kind.recognises(source):
            return kind.model_class.read_file(source, default_guarantees)
    if not source.data.strip():
        return ReadResult((), (problem("F003.empty", place),))
    if is_xml(source):
        return _read_eddi(source, default_guarantees)
    if is_config(source):
        return ReadResult((), (problem("F003.configuration", place),))
    if is_fleet(source):
        return ReadResult((), (problem("F003.deployment", place),))
    if named_like_mros(source.name):
        return ReadResult((), (problem("F003.nodes", place),))
    if name.endswith(YAML_SUFFIXES):
        node, _ = read_map(source, "C001")
        if (
            node is not None and node.entries and _CONSERT_KEYS.isdisjoint(node.keys())
        ):  # of no kind
            key, names = node.entries[0][0], shortened_list(node.keys())
            return ReadResult((), (problem("F003.keys", key.place, keys=names),))
        # damaged beyond recognition: this kind best describes what such a file should look like
        return kinds()["consert"].model_class.read_file(source, default_guarantees)
    if name.endswith(".csv"):
        return ReadResult((), (problem("F003.recording", place),))
    titles = ", ".join(kind.title for kind in kinds().values())
    case = "F003.binary" if b"\0" in source.data else "F003.unknown"
    try:
        source.data.decode("utf-8-sig")
    except UnicodeDecodeError:
        case = "F003.binary"
    return ReadResult((), (problem(case, place, known=titles),))


def _read_eddi(source: Source, default_guarantees: Sequence[str]) -> ReadResult:
    document, problems = read_document(source)
    if document is None:
        return ReadResult((), tuple(problems))
    problems += check_maps(document)
    models: list[Model] = []
    for kind in kinds().values():
        # to import what a kind does takes longer than to look for its models
        if kind.in_eddi and any(select(root, kind.in_eddi) for root in document.roots):
            reading = kind.model_class.read_eddi(document, source, default_guarantees)
            models += reading.models
            problems = [*problems, *reading.problems]
    seen = Observed(document)
    problems = [*dict.fromkeys([*problems, *survey.check_features(document)]), *seen.problems]
    links = links_of(document, seen) if models else {}
    models = [
        replace(
            model,
            links=links_in(document, model.place, links),
            observes=seen.by_model(model.place.path),
        )
        for model in models
    ]
    if not models and (stranger := survey.foreign(document)) is not None:
        return ReadResult((), (stranger,))
    not_read = tuple(
        problem("X021.ignored", document.place(first), number=1 + len(more), class_name=name)
        for name, (first, *more) in survey.unread(document).items()
    )
    return ReadResult(tuple(models), tuple(problems), not_read, hazard_analysis(document))


def checked_models(path: Path, default_guarantees: Sequence[str] = ()) -> ReadResult:
    """Read the models of a file for a command that needs them whole: :func:`complete_reading`."""
    source = read_source(path)
    return complete_reading(source, read_models(source, default_guarantees))


def complete_reading(source: Source, reading: ReadResult) -> ReadResult:
    """Return what was read of a file if it is of use, else raise an EddiError (F004: no model)."""
    if has_errors(reading.problems):
        raise EddiError(*reading.problems)
    if not reading.models:
        raise EddiError(
            problem("F004.no_model", Place(source.name)), *reading.problems, *reading.unread
        )
    return reading


def unfit(models: Sequence[Model]) -> list[Problem]:
    """Return why no monitor can be made of some models without a configuration, as warnings."""
    return [
        replace(error, level="warning", place=error.place if error.place.file else model.place)
        for model in models
        for error in model.configure(Options())[1]
        if error.level == "error"
    ]


def select_models(
    models: Sequence[Model], name: str | None, kind: Kind | None = None
) -> Sequence[Model]:
    """Select the models called ``name`` (without case) and of ``kind``; EddiError F005 for none."""
    selected = [model for model in models if kind is None or model.kind == kind.name]
    if name is not None:
        exact = [model for model in selected if model.name == name]
        selected = exact or [
            model for model in selected if model.name.casefold() == name.casefold()
        ]
    if not selected:
        names = [model.name for model in models]
        subject = f"no model {name!r}" if name is not None else "no such model"
        hint = (did_you_mean(name, names) if name else None) or (
            f"there are: {', '.join(names) or 'none that a monitor can be made of'}"
        )
        place = Place(models[0].source.name) if models else Place()
        raise EddiError(problem("F005", place, hint=hint, kind=subject))
    return selected


def model_for(config: ConfigFile, models: Sequence[Model]) -> Model:
    """Return the model of a configuration (EddiError K010: no such kind, K026: no such model)."""
    section = config.config.Model
    of_type = {kind.name for kind in kinds_of_type(config.config.Model.type)}
    if not of_type:
        known = ", ".join(kind.config_types[0] for kind in kinds().values())
        place = config.place("Model", "type")
        raise EddiError(problem("K010.unknown_kind", place, type=section.type, known=known))
    fitting = [model for model in models if model.kind in of_type]
    package = package_name(section.id)
    chosen = [model for model in fitting if package_name(model.name) == package]
    if not chosen and (named_file := named_model(config)) is not None:
        named = Path(config.path(named_file[0])).resolve()
        chosen = [model for model in fitting if Path(model.source.name).resolve() == named]
        chosen = chosen if len(chosen) == 1 else []  # an EDDI may hold several
    if not chosen and len(fitting) == 1 and len(models) == 1:
        chosen = fitting  # the id of the only configuration names the package
    if chosen:
        return chosen[0]
    names = [f"{kinds()[model.kind].config_types[0]} {model.name!r}" for model in models]
    hint, place = f"there are: {shortened_list(names)}", config.place("Model", "id")
    raise EddiError(problem("K026.no_model", place, hint=hint, kind=section.type, id=section.id))


def candidates(
    config: ConfigFile, models: Sequence[Model], read: Callable[[Path], ReadResult]
) -> ReadResult:
    """Return the models among which a configuration chooses: those given, else what it names."""
    fitting = {kind.name for kind in kinds_of_type(config.config.Model.type)}
    if any(model.kind in fitting for model in models):
        return ReadResult(tuple(models), ())
    path = named_model_path(config)
    if path is not None:
        return read(path)
    if not models:
        raise EddiError(problem("G015.unnamed", config.place("Model")))
    return ReadResult(tuple(models), ())
