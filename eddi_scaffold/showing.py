"""The survey of ``show --json``: every model of a file, also of kinds without a monitor."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.kinds import JsonValue, Model, kinds
from eddi_scaffold.models import read_models
from eddi_scaffold.problems import Problem
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.eddi import sniff as is_xml
from eddi_scaffold.readers.survey import survey
from eddi_scaffold.source import Source


def survey_of(source: Source) -> tuple[dict[str, JsonValue], list[Problem]]:
    """Return models, elements and references of a file, and what makes it unreadable."""
    if is_xml(source):
        document, problems = read_document(source)
        return (survey(document).as_json() if document is not None else {"models": []}), problems
    reading = read_models(source)
    models = [
        {
            "kind": model.kind,
            "name": model.name,
            "path": model.place.path,
            "line": model.place.line,
            "counts": dict(kinds()[model.kind].counts(model)),
        }
        for model in reading.models
    ]
    return {"models": models}, []


def only(survey: dict[str, JsonValue], chosen: Sequence[Model]) -> dict[str, JsonValue]:
    """Return a survey with no more than the chosen models; the facts of the file stay."""
    names = {(model.kind, model.name) for model in chosen}
    return {
        **survey,
        "models": [found for found in survey["models"] if (found["kind"], found["name"]) in names],
    }
