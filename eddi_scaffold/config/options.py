"""Options of a configuration for the kind of its model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.config.file import KEY, ConfigFile
from eddi_scaffold.config.model_path import MODEL_KEYS
from eddi_scaffold.config.schema import INPUT_TYPES, ModelSection
from eddi_scaffold.config.violations import hint_for_decimals
from eddi_scaffold.kinds import DeclaredInput, Options, kinds
from eddi_scaffold.problems import NearNames, Place, Problem, error


def options_of(file: ConfigFile | None) -> Options:
    """Return the options of a configuration for the kind of its model."""
    if file is None:
        return Options()
    config, section = file.config, file.config.Model
    values = {**(section.model_extra or {}), "parameters": section.parameters}
    types = {source.id: source.type for source in config.SimulatorOutputs}
    inputs = tuple(
        DeclaredInput(
            id=item.id,
            type=INPUT_TYPES[item.type] if item.type is not None else None,
            unit=item.unit,
            default=item.default,
            place=file.place("EDDIInputs", index),
            messages=tuple(types[name] for name in item.requires),
        )
        for index, item in enumerate(config.EDDIInputs)
    )
    return Options(
        id=section.id,
        values={key: value for key, value in values.items() if value is not None},
        inputs=inputs,
        frequency=section.frequency,
        parts=tuple(output.event for output in config.EDDIOutputs),
        place=lambda *path: file.place("Model", *path),
        read=file.read,
    )


def _options_for(section: object) -> set[str]:
    """Return the keys that the kind of this section understands; of all kinds if it is unknown."""
    name = section.get("type") if isinstance(section, Mapping) else None
    wanted = name.casefold() if isinstance(name, str) else None
    fitting = [
        kind for kind in kinds().values() if wanted in {t.casefold() for t in kind.config_types}
    ]
    return {key for kind in fitting or kinds().values() for key in kind.options}


def unknown_options(
    section: object, places: Mapping[tuple[str | int, ...], Place], file: str
) -> Iterable[Problem]:
    """Find keys of the section ``Model`` that the kind of its model does not understand (K004)."""
    if not isinstance(section, Mapping):
        return
    known = {*ModelSection.model_fields, *_options_for(section)}
    near = NearNames(sorted(known), "known keys")
    for key in section:
        if key not in known:
            place = places.get(("Model", key, KEY), Place(file))
            hint = hint_for_decimals(key) or near.hint(key)
            if key in MODEL_KEYS and isinstance(section[key], str):
                hint = (
                    f"the file of the model is named so: `parameters: [{{{key}: {section[key]}}}]`"
                )
            yield error("K004", f"unknown key {key!r}", place, hint)
