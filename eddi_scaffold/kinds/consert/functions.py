"""What is done with ConSerts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from eddi_scaffold.common.claims import Element
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, has_errors, in_order
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.kinds import Functions, ReadResult, with_status
from eddi_scaffold.kinds.consert.checks import check_consert
from eddi_scaffold.kinds.consert.claims import MEANINGS, claims, unfulfilled
from eddi_scaffold.kinds.consert.compile import compile_consert
from eddi_scaffold.kinds.consert.default_guarantees import with_default_guarantees
from eddi_scaffold.kinds.consert.inputs import inputs
from eddi_scaffold.kinds.consert.model import NAME, ConSert, ConSertModel
from eddi_scaffold.kinds.consert.names import published_class
from eddi_scaffold.kinds.consert.options import acceptances, configure, published_ids
from eddi_scaffold.kinds.consert.read_eddi import read_eddi
from eddi_scaffold.kinds.consert.read_yaml import read_draft
from eddi_scaffold.kinds.consert.show import counts, diagram, outline
from eddi_scaffold.kinds.consert.static_checks import static_checks
from eddi_scaffold.kinds.consert.write_yaml import to_yaml


def _read_eddi(document: EddiDocument, source: Source, marks: Sequence[str]) -> ReadResult:
    conserts, problems = read_eddi(document, source, marks)
    return _reading(conserts, problems, source, ())


def _read_file(source: Source, marks: Sequence[str]) -> ReadResult:
    draft, problems = read_draft(source)
    reading = _reading(() if draft is None else (draft,), problems, source, marks)
    if has_errors(problems):  # the draft was only good for finding more
        return ReadResult((), reading.problems)
    return reading


def _reading(
    conserts: Sequence[ConSert], problems: Sequence[Problem], source: Source, marks: Sequence[str]
) -> ReadResult:
    marked, found = (
        (conserts, []) if not marks else with_default_guarantees(conserts, marks, source.name)
    )
    models: list[ConSertModel] = []
    all_problems = [*problems, *(found if conserts else ())]
    for consert in marked:
        checked, more = check_consert(consert)
        all_problems += more
        if checked is not None:
            models.append(ConSertModel(NAME, checked.name, checked, source, checked.place))
    return ReadResult(tuple(models), tuple(in_order(all_problems)))


def _check(model: ConSertModel) -> Sequence[Problem]:
    return static_checks(model.data)


def _export(model: ConSertModel) -> Mapping[str, str]:
    safe = re.sub(r"[^\w.-]", "_", model.name).lstrip(".") or NAME
    return {f"{safe}.yml": to_yaml(model.data)}


def elements(model: ConSertModel) -> Sequence[Element]:
    """Return what has a place, then the services."""
    consert = model.data
    nodes = [
        *(("demand", demand.id, demand.place) for demand in consert.demands),
        *(("evidence", evidence.id, evidence.place) for evidence in consert.evidence),
        *(("gate", gate.id, gate.place) for gate in consert.gates),
    ]
    return [
        *(Element(name, id_, None, place.line, place.path) for name, id_, place in nodes),
        *(
            Element("guarantee", of.id, published_class(of.id), of.place.line, of.place.path)
            for of in consert.guarantees
        ),
        *(Element("provided service", service.id) for service in consert.provided_services),
        *(Element("required service", service.id) for service in consert.required_services),
    ]


FUNCTIONS = Functions(
    read_eddi=_read_eddi,
    read_file=_read_file,
    check=_check,
    counts=lambda model: counts(model.data),
    outline=lambda model: outline(model.data),
    export=_export,
    inputs=lambda model: inputs(model.data),
    beside=with_status("ConSertStatus"),
    configure=configure,
    diagram=lambda model: diagram(model.data),
    ids=lambda model: {"guarantees": [*published_ids(model)]},
    elements=elements,
    compile=compile_consert,
    claims=claims,
    acceptances=acceptances,
    field_meanings=lambda _claims: MEANINGS,
    unfulfilled=lambda provider, output, user, item: unfulfilled(
        provider.data, published_ids(provider).get(output, output), user.data, item
    ),
)
