"""The text of ``config/model.json``: the model as the runtime reads it."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_runtime import ModelError as NotRunning
from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.compiling.document import ModelError, canonical, digest_of, parse_model
from eddi_scaffold.compiling.execution import build
from eddi_scaffold.kinds import JsonValue, Kind, Model


def model_document(
    model: Model,
    kind: Kind[Model],
    inputs: Sequence[dict[str, JsonValue]],
    place: Place,
) -> str:
    """Return canonical JSON with its own digest, after it has been compiled once.

    Args:
        model: what is monitored, configured.
        kind: its kind.
        inputs: ``id``, ``attribute``, ``requires``, ``max_age``, ``factor``, ``default`` of each.
        place: place of the configuration, for errors.

    Raises:
        EddiError: the model or the settings cannot be compiled (K028).
    """
    data: dict[str, JsonValue] = {
        "format": 1,
        "kind": kind.name,
        "id": model.name,
        "source": {
            "file": model.source.file_name,
            "sha256": model.source.sha256,
            "path": model.place.path,
        },
        "inputs": list(inputs),
        "model": kind.functions.runtime_model(model),
        "settings": kind.functions.settings(model),
    }
    if model.links:
        data["links"] = {path: link.as_json() for path, link in model.links.items()}
    data["sha256"] = digest_of(data)
    text = canonical(data).rstrip("\n")
    try:
        monitor = build(parse_model(text, "the model", kind.functions.data_files(model)))
        EDDIInputBase().bind(monitor.inputs)
    except (ModelError, NotRunning) as refused:  # what will run it has the last word
        raise EddiError(problem("K028.refused", place, reason=refused.reason)) from None
    return text
