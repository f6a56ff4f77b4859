"""The options that a configuration gives to the kind of its model."""

from __future__ import annotations

from typing import cast

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.kinds import DeclaredInput, InputType, Options


def options_of(file: ConfigFile | None) -> Options:
    """Return the options of a configuration for the kind of its model."""
    if file is None:
        return Options()
    config, section = file.config, file.config.Model
    extra = {**(section.model_extra or {}), "parameters": section.parameters}
    types = {source.id: source.type for source in config.SimulatorOutputs}
    inputs = tuple(
        DeclaredInput(
            id=entry.id,
            type=cast("InputType | None", entry.type),
            unit=entry.unit,
            default=entry.default,
            place=file.place("EDDIInputs", index),
            messages=tuple(types[name] for name in entry.requires),
        )
        for index, entry in enumerate(config.EDDIInputs)
    )
    return Options(
        id=section.id,
        values={key: value for key, value in extra.items() if value is not None},
        inputs=inputs,
        frequency=section.frequency,
        parts=tuple(output.event for output in config.EDDIOutputs),
        place=lambda *path: file.place("Model", *path),
    )
