"""The kind ``consert``: conditional safety certificates, evaluated while the system runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eddi_scaffold.kinds import Kind, Model, Reading, with_status
from eddi_scaffold.kinds.consert.check.model import check_consert
from eddi_scaffold.kinds.consert.check.static import static_checks
from eddi_scaffold.kinds.consert.claims import MEANINGS, support, unfulfilled
from eddi_scaffold.kinds.consert.default_guarantees import mark_defaults
from eddi_scaffold.kinds.consert.inputs import inputs
from eddi_scaffold.kinds.consert.messages import MESSAGES
from eddi_scaffold.kinds.consert.options import KEYS, accepted, configure, lag, settings
from eddi_scaffold.kinds.consert.outline import counts, outline
from eddi_scaffold.kinds.consert.picture import diagram
from eddi_scaffold.kinds.consert.runtime_model import runtime_model
from eddi_scaffold.kinds.consert.yaml.reading import read_draft
from eddi_scaffold.kinds.consert.yaml.writing import to_yaml
from eddi_scaffold.problems import has_errors, in_order

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from eddi_scaffold.kinds.consert.model import ConSert
    from eddi_scaffold.problems import Problem
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.source import Source

NAME = "consert"
_SUFFIXES = (".yml", ".yaml", ".json")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:guarantees|tree_propagations|(?:provided|required)_services)"""
    rb"""["']?\s*:"""
)


def _read_eddi(document: EddiDocument, source: Source, marks: Sequence[str]) -> Reading:
    from eddi_scaffold.kinds.consert.eddi.reading import read_eddi  # noqa: PLC0415 - needs lxml

    conserts, problems = read_eddi(document, source, marks)
    return _reading(conserts, problems, source, ())


def _read_file(source: Source, marks: Sequence[str]) -> Reading:
    draft, problems = read_draft(source)
    reading = _reading(() if draft is None else (draft,), problems, source, marks)
    if has_errors(problems):  # the draft was only good for finding more
        return Reading((), reading.problems)
    return reading


def _reading(
    conserts: Sequence[ConSert], problems: Sequence[Problem], source: Source, marks: Sequence[str]
) -> Reading:
    marked, found = (conserts, []) if not marks else mark_defaults(conserts, marks, source.name)
    models: list[Model] = []
    all_problems = [*problems, *(found if conserts else ())]
    for consert in marked:
        checked, more = check_consert(consert)
        all_problems += more
        if checked is not None:
            models.append(Model(NAME, checked.name, checked, source, checked.place))
    return Reading(tuple(models), tuple(in_order(all_problems)))


def _sniff(source: Source) -> bool:
    return source.name.lower().endswith(_SUFFIXES) and _OWN_KEY.search(source.data) is not None


def _consert(model: Model) -> ConSert:
    consert: ConSert = model.data
    return consert


def _check(model: Model) -> Sequence[Problem]:
    return static_checks(_consert(model))


def _export(model: Model) -> Mapping[str, str]:
    safe = re.sub(r"[^\w.-]", "_", model.name).lstrip(".") or NAME
    return {f"{safe}.yml": to_yaml(_consert(model))}


KIND = Kind(
    name=NAME,
    title="ConSert",
    config_types=("ConSert", "ConSerts"),
    read_eddi=_read_eddi,
    sniff=_sniff,
    read_file=_read_file,
    check=_check,
    counts=lambda model: counts(_consert(model)),
    outline=lambda model: outline(_consert(model)),
    export=_export,
    inputs=lambda model: inputs(_consert(model)),
    runtime_model=lambda model: runtime_model(_consert(model)),
    messages=MESSAGES,
    output_message="ConSertOutput",
    beside=with_status("ConSertStatus"),
    options=KEYS,
    configure=configure,
    without_input="no guarantee that needs it becomes active",
    settings=settings,
    diagram=lambda model: diagram(_consert(model)),
    ids=lambda model: {"guarantees": [one.id for one in _consert(model).guarantees]},
    meanings=lambda _document, _part: MEANINGS,
    accepted=accepted,
    lag=lag,
    support=support,
    unfulfilled=lambda provider, output, user, item: unfulfilled(
        _consert(provider), output, _consert(user), item
    ),
)
"""What the generator knows of ConSerts."""
