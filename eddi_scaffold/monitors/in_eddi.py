"""Write models that are no part of the metamodel into an EDDI."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.problems import EddiError, Place, error, has_errors
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.insertion import with_map
from eddi_scaffold.source import Source


def written_into(source: Source, at: str, models: Sequence[Model]) -> bytes:
    """Return the bytes of an EDDI with models on one of its elements.

    Args:
        source: the EDDI.
        at: fragment path of the element.
        models: events, or SafeML settings.

    Raises:
        EddiError: a model is of another kind (X036), there is no such element (X008), or the EDDI
            has errors, now or with the models.
    """
    data = source.data
    for model in models:
        in_map = kinds()[model.kind].functions.in_map
        if in_map is None:
            title = kinds()[model.kind].title
            message = f"a model of this kind ({title}) is not written into an EDDI"
            hint = "events and SafeML settings are; a ConSert has elements of its own"
            raise EddiError(error("X036", message, model.place, hint))
        document, problems = read_document(Source(source.name, data))
        if document is None:
            raise EddiError(*problems)
        element = document.at(at)
        if element is None:
            message = f"--at {at!r} points at nothing"
            hint = "`show --json` has the paths of packages and models"
            raise EddiError(error("X008", message, Place(source.name), hint))
        key, values = in_map(model)
        data = with_map(data, document, element, key, values)
    reading = read_models(Source(source.name, data))
    if has_errors(reading.problems):
        raise EddiError(*reading.problems)
    return data
