"""Which models are in a file, whatever its format: the one way from a path to typed models."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.config.fleet.reading import is_fleet
from eddi_scaffold.config.model_path import named_model_path
from eddi_scaffold.config.reading import read_config
from eddi_scaffold.kinds import Kind, Model, Options, Reading, kinds
from eddi_scaffold.positioned_yaml.nodes import read_map
from eddi_scaffold.problems import EddiError, Place, Problem, error, has_errors, listed, nearest
from eddi_scaffold.readers.document import EddiDocument
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.eddi import sniff as is_xml
from eddi_scaffold.readers.extensions import check_maps
from eddi_scaffold.readers.links import links_in, links_of
from eddi_scaffold.readers.monitored_by import observed
from eddi_scaffold.readers.unread import (
    check_features,
    event_monitors,
    foreign,
    unread,
    unused_design,
)
from eddi_scaffold.readers.xmi import select
from eddi_scaffold.source import Source, read_source

YAML_SUFFIXES = (".yml", ".yaml")
_HEAD = 4096
_CONFIG_SECTIONS = {"Model", "SimulatorOutputs", "SimulatorOutput", "EDDIInputs"}
_YAML_KEYS = {
    "a ConSert": ("guarantees", "demands", "evidence", "gates", "tree_propagations"),
    "a configuration": ("Model", "SimulatorOutputs", "EDDIInputs", "EDDIOutputs"),
    "a deployment file": ("Robots", "Bindings", "Station"),
}
"""Kind of file -> keys of its top level that tell it."""
_CONFIG_LINE = re.compile(rb"^(Model|SimulatorOutputs?|EDDIInputs)[ \t]*:", re.MULTILINE)


def is_config(source: Source) -> bool:
    """Return whether a file is an eddi_config.yml, which no reader of models understands."""
    if is_xml(source):
        return False
    node, _ = read_map(source, "K001")
    if node is None:  # no YAML, or damaged: what it is meant to be still shows
        return _CONFIG_LINE.search(source.data) is not None
    return not _CONFIG_SECTIONS.isdisjoint(node.keys())


def is_mros(source: Source) -> bool:
    """Return by its name whether a file describes a robot (``.rossystem``, ``.ros``, ...)."""
    return named_like_mros(source.name)


def named_like_mros(name: str) -> bool:
    """Return whether a file name is that of a ``.rossystem``, ``.ros``, ``.ros1`` or ``.ros2``."""
    from eddi_scaffold.mros import MODEL_SUFFIXES, SYSTEM_SUFFIX  # noqa: PLC0415 - with its readers

    return name.endswith((SYSTEM_SUFFIX, *MODEL_SUFFIXES))


def read_models(source: Source, default_guarantees: Sequence[str] = ()) -> Reading:
    """Read every model of every kind in one file, with all problems."""
    for kind in kinds().values():
        if kind.sniff(source):
            return kind.functions.read_file(source, default_guarantees)
    with source.open() as stream:
        head = stream.read(_HEAD)
    if len(head) < _HEAD and not head.strip():
        return Reading((), (error("F003", "this file is empty", Place(source.name)),))
    if is_xml(source):
        return _read_eddi(source, default_guarantees)
    if is_config(source):
        hint = "name the EDDI XML or ConSert YAML that it belongs to"
        with suppress(EddiError):  # told where the configuration is read
            config, _ = read_config(source)
            named = named_model_path(config) if config is not None else None
            hint = f"name its model: {named}" if named is not None else hint
        message = "this is an eddi_config.yml, not a model"
        return Reading((), (error("F008", message, Place(source.name), hint),))
    if is_fleet(source):
        hint = "`check`, `generate` and `diagram` read it"
        message = "this is a deployment file, not a model"
        return Reading((), (error("F008", message, Place(source.name), hint),))
    if is_mros(source):
        message = "this describes the robot's nodes, it is not a model of its dependability"
        hint = "parse-rossystem, or generate --system with --models, reads it"
        return Reading((), (error("F003", message, Place(source.name), hint),))
    if source.name.lower().endswith(YAML_SUFFIXES):
        stranger = _of_no_kind(source)
        if stranger is not None:
            return Reading((), (stranger,))
        # damaged beyond recognition: this kind best describes what such a file should look like
        return kinds()["consert"].functions.read_file(source, default_guarantees)
    if source.name.lower().endswith(".csv"):
        message = "this is a recording, not a model"
        hint = "`run` takes it with --inputs, beside a model or a configuration"
        return Reading((), (error("F003", message, Place(source.name), hint),))
    known = ", ".join(kind.title for kind in kinds().values())
    if b"\0" in head or not _is_utf8(source.data):
        message = f"this is not text, so it is not a model ({known})"
        return Reading((), (error("F003", message, Place(source.name)),))
    message = f"this is neither an EDDI XML file nor a model of a known kind ({known})"
    return Reading((), (error("F003", message, Place(source.name)),))


def _of_no_kind(source: Source) -> Problem | None:
    """Return the error of a YAML file without a key of ours; ``None``: it may be a ConSert."""
    node, _ = read_map(source, "C001")
    known = {key: of for of, keys in _YAML_KEYS.items() for key in keys}
    consert = {key for key, of in known.items() if of == "a ConSert"}
    keys = [key for key, _ in (node.entries if node else ())]
    if not keys or any(key.text in consert for key in keys):
        return None
    meant = [(key, nearest(key.text, known.keys() - consert)) for key in keys]
    key, near = next((one for one in meant if one[1]), meant[0])
    if near is not None:
        text = f"there is no section {key.text!r}, and no other key tells what this file is"
        return error("F003", text, key.place, f"did you mean {near!r}, of {known[near]}?")
    text = f"this is no file of ours: it has the keys {listed([one.text for one, _ in meant])}"
    hint = ", ".join(f"{of} has `{keys[0]}`" for of, keys in _YAML_KEYS.items())
    return error("F003", text, key.place, hint)


def _read_eddi(source: Source, default_guarantees: Sequence[str]) -> Reading:
    document, problems = read_document(source)
    if document is None:
        return Reading((), tuple(problems))
    problems += check_maps(document)
    models: list[Model] = []
    for kind in kinds().values():
        # to import the functions of a kind takes longer than to look for its models
        read = kind.functions.read_eddi if _is_in(document, kind) else None
        if read is not None:
            reading = read(document, source, default_guarantees)
            models += reading.models
            problems = [*problems, *reading.problems]
    seen = observed(document)
    problems = [*dict.fromkeys([*problems, *check_features(document)]), *seen.problems]
    links = links_of(document, seen) if models else {}
    models = [
        replace(
            model,
            links=links_in(document, model.place, links),
            observes=seen.by_model(document, model.place.path),
        )
        for model in models
    ]
    found = foreign(document) if not models else None
    if found is not None:
        return Reading((), (found,))
    not_read = [one.problem() for one in unread(document)]
    not_read += (*event_monitors(document), *unused_design(document))
    return Reading(tuple(models), tuple(problems), tuple(not_read))


def _is_in(document: EddiDocument, kind: Kind[Model]) -> bool:
    return bool(kind.in_eddi) and any(select(root, kind.in_eddi) for root in document.roots)


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return False
    return True


def checked_models(path: Path, default_guarantees: Sequence[str] = ()) -> Reading:
    """Read the models of a file for a command that needs them whole.

    Raises:
        EddiError: a problem is an error, or there is no model in the file (F004).
    """
    source = read_source(path)
    return whole(source, read_models(source, default_guarantees))


def whole(source: Source, reading: Reading) -> Reading:
    """Return what was read of a file if it is of use.

    Raises:
        EddiError: a problem is an error, or there is no model in the file (F004).
    """
    if has_errors(reading.problems):
        raise EddiError(*reading.problems)
    if not reading.models:
        raise EddiError(no_model(source), *reading.problems, *reading.unread)
    return reading


def no_model(source: Source) -> Problem:
    """Return F004: the file is sound, but of no use for a monitor."""
    message = "this file contains no model that a monitor can be generated from"
    return error("F004", message, Place(source.name))


def unfit(models: Sequence[Model]) -> list[Problem]:
    """Return why no monitor can be made of some models without a configuration, as warnings."""
    found = [kinds()[model.kind].functions.configure(model, Options())[1] for model in models]
    return [
        replace(
            problem, level="warning", place=problem.place if problem.place.file else model.place
        )
        for model, problems in zip(models, found, strict=True)
        for problem in problems
        if problem.level == "error"
    ]
