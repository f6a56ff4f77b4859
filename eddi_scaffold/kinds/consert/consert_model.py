"""What is done with ConSerts: their inputs, what guarantees rest on, what messages mean."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, ClassVar

from eddi_scaffold.common import units
from eddi_scaffold.common.claims import Acceptance, Claim, Element, Meaning, Meanings, Use
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Problem, has_errors, in_order
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.kinds import InputType, Model, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.consert import read_eddi, show
from eddi_scaffold.kinds.consert.checks import check_consert
from eddi_scaffold.kinds.consert.compile import compile_consert
from eddi_scaffold.kinds.consert.compose import mismatch
from eddi_scaffold.kinds.consert.default_guarantees import with_default_guarantees
from eddi_scaffold.kinds.consert.graph import constants, inputs_of, leaves_of
from eddi_scaffold.kinds.consert.model import (
    NAME,
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    ConSertOptions,
    Dimension,
    Evidence,
)
from eddi_scaffold.kinds.consert.names import published_class
from eddi_scaffold.kinds.consert.options import read_options
from eddi_scaffold.kinds.consert.read_yaml import read_draft
from eddi_scaffold.kinds.consert.show import covered_text
from eddi_scaffold.kinds.consert.static_checks import static_checks
from eddi_scaffold.kinds.consert.write_yaml import to_yaml
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

_ACTIVE = Meaning(
    (False,),
    refused="`active` of a guarantee is false also when it is unknown",
    instead="`guarantees[ID].verdict == 0` of its ConSertStatus: known to be false",
)

MEANINGS: Meanings = {
    "ConSertOutput": {"guarantees[].active": _ACTIVE},
    "RobotGuarantees": {"guarantees[].active": replace(_ACTIVE, instead=None)},
    "ConSertStatus": {
        "guarantees[].verdict": Meaning(
            (1,),
            refused="the verdict is 1 when it is unknown",
            instead="`verdict == 2`, known to be true, or `verdict == 0`, known to be false",
            known=(0, 2),
        )
    },
}
"""Message -> field -> its meaning."""


@dataclass(frozen=True)
class ConSertModel(Model):
    """A ConSert, and what its configuration chooses."""

    kind: ClassVar[str] = NAME
    data: ConSert = field(kw_only=True)
    options: ConSertOptions = field(default=ConSertOptions(), kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        draft, problems = read_draft(source)
        reading = _models(() if draft is None else (draft,), problems, source, default_guarantees)
        if has_errors(problems):  # the draft was only good for finding more
            return ReadResult((), reading.problems)
        return reading

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        conserts, problems = read_eddi.read_eddi(document, source, default_guarantees)
        return _models(conserts, problems, source, ())

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:
        return MEANINGS

    def check(self) -> Sequence[Problem]:
        return static_checks(self.data)

    def counts(self) -> Mapping[str, int]:
        return show.counts(self.data)

    def outline(self) -> Sequence[str]:
        return show.outline(self.data)

    def export(self) -> Mapping[str, str]:
        safe = re.sub(r"[^\w.-]", "_", self.name).lstrip(".") or NAME
        return {f"{safe}.yml": to_yaml(self.data)}

    def diagram(self) -> Diagram:
        return show.diagram(self.data)

    def configure(self, options: Options) -> tuple[ConSertModel | None, list[Problem]]:
        chosen, problems = read_options(options)
        return None if chosen is None else replace(self, options=chosen), problems

    def inputs(self) -> Sequence[ModelInput]:
        """Return demands, then evidence, each in file order (the order of SESAME D7.2 Fig 44).

        A demand is a Boolean at run time, whatever its dimensions: that it fits has been decided
        when the ConSerts were composed.
        """
        demands = (
            ModelInput(
                demand.id,
                "bool",
                description=demand.description,
                covered="; ".join(covered_text(dimension) for dimension in demand.dimensions),
                is_good=_is_true,
                is_demand=True,
                uses=(Use(_is_true),),
            )
            for demand in self.data.demands
        )
        return (*demands, *(_evidence_input(evidence) for evidence in self.data.evidence))

    def companion_messages(self) -> Mapping[str, str]:
        return {"status": "ConSertStatus"}

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {"guarantees": [*self._published_ids()]}

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_consert(self.data, self.options, declaration)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return each guarantee, by its id in messages, with the leaves that it rests on."""
        sources, leaves = inputs_of(self.data), frozenset(leaves_of(self.data))
        return [
            Claim(
                self.options.published(guarantee.id),
                frozenset() if guarantee.default else leaves & reached(sources, [guarantee.id]),
                self.options.hold_s(frequency),
            )
            for guarantee in self.data.guarantees
        ]

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return what a filter by majority accepts: the majority of old steps."""
        seconds = self.options.hold_s(frequency)
        if not seconds:
            return ()
        key, what = "filter: majority", "the majority of old steps"
        return [Acceptance(key, what, f"for {seconds:g} s", seconds, path=("Model", "filter"))]

    def elements(self) -> Sequence[Element]:
        """Return what has a place, then the services."""
        consert = self.data
        nodes = [
            *(("demand", demand.id, demand.place) for demand in consert.demands),
            *(("evidence", evidence.id, evidence.place) for evidence in consert.evidence),
            *(("gate", gate.id, gate.place) for gate in consert.gates),
        ]
        return [
            *(Element(name, id_, None, place.line, place.path) for name, id_, place in nodes),
            *(
                Element("guarantee", g.id, published_class(g.id), g.place.line, g.place.path)
                for g in consert.guarantees
            ),
            *(Element("provided service", service.id) for service in consert.provided_services),
            *(Element("required service", service.id) for service in consert.required_services),
        ]

    def why_not_fulfilled(self, output: str, user: Model, item: str) -> str | None:
        if not isinstance(user, ConSertModel):
            return None
        guarantee_id = self._published_ids().get(output, output)
        return _why_not_fulfilled(self.data, guarantee_id, user.data, item)

    def _published_ids(self) -> dict[str, str]:
        """Return the ids that guarantees have in messages -> their ids in the model."""
        return {self.options.published(g.id): g.id for g in self.data.guarantees}


def _models(
    conserts: Sequence[ConSert], problems: Sequence[Problem], source: Source, marks: Sequence[str]
) -> ReadResult:
    marked, unclear = (
        (conserts, []) if not marks else with_default_guarantees(conserts, marks, source.name)
    )
    models: list[ConSertModel] = []
    all_problems = [*problems, *(unclear if conserts else ())]
    for consert in marked:
        checked, more = check_consert(consert)
        all_problems += more
        if checked is not None:
            models.append(ConSertModel(checked.name, source, checked.place, data=checked))
    return ReadResult(tuple(models), tuple(in_order(all_problems)))


def _evidence_input(evidence: Evidence) -> ModelInput:
    dimension = evidence.dimension
    covered, good = covered_text(dimension), partial(_is_covered, dimension)
    if isinstance(dimension, BinaryDimension | CategoricalDimension):
        type_: InputType = "bool" if isinstance(dimension, BinaryDimension) else "str"
        return ModelInput(
            evidence.id,
            type_,
            description=evidence.description,
            covered=covered,
            is_good=good,
            uses=(Use(good),),
        )
    return ModelInput(
        evidence.id,
        "float",
        unit=dimension.uom or "",
        units=units.convertible(dimension.uom),
        description=evidence.description,
        covered=covered,
        is_good=good,
        starts=tuple(range_.start.value for range_ in dimension.covered),
        uses=(Use(good),),
    )


def _is_true(value: object) -> bool:
    return value is True


def _is_covered(dimension: Dimension, value: object) -> bool:
    if isinstance(dimension, BinaryDimension):
        return value is dimension.value
    if isinstance(dimension, CategoricalDimension):
        return value in dimension.covered
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return any(
        range_.start.value < value < range_.end.value
        or (range_.inclusive and value == range_.end.value)
        or (range_.start_inclusive and value == range_.start.value)
        for range_ in dimension.covered
    )


def _why_not_fulfilled(
    provider: ConSert, guarantee_id: str, user: ConSert, demand_id: str
) -> str | None:
    """Return why a guarantee does not fulfil a demand that it is wired to, ``None`` if it does.

    Evidence asks for nothing that a guarantee could fulfil; it is not judged.
    """
    demand = next((demand for demand in user.demands if demand.id == demand_id), None)
    guarantee = next((known for known in provider.guarantees if known.id == guarantee_id), None)
    if demand is None or guarantee is None:
        return None
    name = f"{provider.name}/{guarantee_id}"
    required = _services(user.required_services, "demands", demand_id)
    provided = _services(provider.provided_services, "guarantees", guarantee_id)
    if required and not required & provided:
        kinds = " or ".join(sorted(required))
        return f"{name} is not in a service of type {kinds}, which {demand_id} requires"
    if constants(provider)[guarantee_id] is False:
        return f"{name} can never be active"
    difference = mismatch(guarantee, demand, name)
    return None if difference is None else difference.text


def _services(services: Any, members: str, id_: str) -> set[str]:
    return {
        service.functional_service_type for service in services if id_ in getattr(service, members)
    }
