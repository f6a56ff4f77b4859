"""Models written elsewhere: into an EDDI, as pictures, as monitors without a runtime."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.conditions.c_vectors import vectors_of_conditions, vectors_of_consert
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.insertion import with_map
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models, read_models, select_models, unfit
from eddi_scaffold.program.c_files import c_files
from eddi_scaffold.program.standalone import StandaloneMonitor, Target, named


def written_into(source: Source, at: str, models: Sequence[Model]) -> bytes:
    """Return the bytes of an EDDI with events or SafeML settings on the element at a path.

    Raises:
        EddiError: a model is of another kind (X036), there is no such element (X007), or the EDDI
            has errors, now or with the models.
    """
    data = source.data
    for model in models:
        eddi_map = model.as_eddi_map()
        if eddi_map is None:
            title = kinds()[model.kind].title
            raise EddiError(problem("X036.kind", model.place, kind=title))
        document, problems = read_document(Source(source.name, data))
        if document is None:
            raise EddiError(*problems)
        if document.origins:
            raise EddiError(problem("X036.editor", Place(source.name)))
        element = document.references.at(at)
        if element is None:
            raise EddiError(problem("X007.at", Place(source.name), path=at))
        data = with_map(data, document, element, *eddi_map)
    reading = read_models(Source(source.name, data))
    if has_errors(reading.problems):
        raise EddiError(*reading.problems)
    return data


def standalone(monitor: BoundMonitor, target: Target, name: str) -> StandaloneMonitor:
    """Return a model as a standalone monitor (EddiError E026: there is none).

    A name begins files and functions.
    """
    model, kind = monitor.model, monitor.kind
    program = monitor.compiled.program if target == "c" else None
    if program is None:
        fields = {"target": target, "title": kind.title, "model": model.name}
        raise EddiError(problem("E026.kind", model.place, **fields))
    source = (f"{kind.title} {model.name}", f"{model.source.file_name} {model.place.path or ''}")
    return named(program, name, source, kind=kind.name)


def in_c(monitor: BoundMonitor, printed: StandaloneMonitor) -> dict[str, str]:
    """Return file name -> text of a standalone monitor in C99, with its vectors."""
    if printed.kind != "consert":
        return c_files(printed) | vectors_of_conditions(printed)
    text = monitor.model.vectors(monitor.bound, {})
    return c_files(printed) | (vectors_of_consert(printed, json.loads(text)) if text else {})


def without_limits(monitor: BoundMonitor) -> list[Problem]:
    """Report the inputs of a model without a configuration: no value of theirs gets old (K017)."""
    names = [binding.model.id for binding in monitor.inputs if binding.max_age is None]
    if monitor.config is not None or not names:
        return []
    return [problem("K017.remembered", monitor.model.place, inputs=", ".join(names))]


def pictures(
    path: Path, name: str | None, default_guarantees: Sequence[str], *, single: bool
) -> tuple[dict[str, str], list[Problem]]:
    """Return file name -> SVG of each model, and why no monitor can be made of one as it is.

    Raises:
        EddiError: the file cannot be used, no model in it can be drawn (G018), or one picture is
            asked for and there are several models (G005).
    """
    every = checked_models(path, default_guarantees).models
    models = select_models(every, name) if name is not None else every
    svgs: dict[str, str] = {}
    stems: set[str] = set()
    for model in models:
        picture = model.diagram()
        if picture is not None:
            stem = free_name(model.safe_name, stems)
            stems.add(stem)
            svgs[f"{stem}.svg"] = drawn(picture)
    if not svgs:
        names = ", ".join(kinds()[model.kind].title for model in models)
        raise EddiError(problem("G018", Place(str(path)), kinds=names))
    if single and len(svgs) > 1:
        names = ", ".join(model.name for model in models)
        raise EddiError(problem("G005.several_files", Place(str(path)), names=names))
    return svgs, unfit(models)
