"""What is done with ConSerts: their inputs, what guarantees rest on, what messages mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from eddi_scaffold.common import units
from eddi_scaffold.common.claims import Acceptance, Claim, Element, Meaning, Meanings, Use
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Problem, has_errors, in_order
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.kinds import InputType, Model, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert import read_eddi, show
from eddi_scaffold.kinds.consert.checks import check_consert
from eddi_scaffold.kinds.consert.compile import compile_consert
from eddi_scaffold.kinds.consert.compose import why_not_fulfilled
from eddi_scaffold.kinds.consert.names import published_class
from eddi_scaffold.kinds.consert.options import (
    ConSertOptions,
    read_options,
    with_default_guarantees,
)
from eddi_scaffold.kinds.consert.read_short import read_consert
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

    kind: ClassVar[str] = model.NAME
    data: model.ConSert = field(kw_only=True)
    options: ConSertOptions = field(default=ConSertOptions(), kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        draft, problems = read_consert(source)
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

    def write(self) -> Mapping[str, str]:
        return {f"{self.safe_name}.yml": to_yaml(self.data)}

    def named(self, name: str) -> ConSertModel:
        return replace(self, name=name, data=replace(self.data, name=name))

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
        return [*map(_input_of, self.data.demands), *map(_input_of, self.data.evidence)]

    def companion_messages(self) -> Mapping[str, str]:
        return {"status": "ConSertStatus"}

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {"guarantees": [*self._published_ids()]}

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_consert(self.data, self.options, declaration)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return each guarantee, by its id in messages, with the leaves that it rests on."""
        sources, leaves = self.data.inputs, frozenset(self.data.leaves)
        return [
            Claim(
                self.options.published(guarantee.id),
                frozenset()
                if guarantee.default
                else frozenset(reached(sources, [guarantee.id]) & leaves),
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
        groups = (consert.demands, consert.evidence, consert.gates, consert.guarantees)
        nodes = [node for group in groups for node in group]
        return [
            *(
                Element(
                    node.kind,
                    node.id,
                    published_class(node.id) if node.kind == "guarantee" else None,
                    node.place.line,
                    node.place.path,
                )
                for node in nodes
            ),
            *(Element(service.kind, service.id) for service in consert.provided_services),
            *(Element(service.kind, service.id) for service in consert.required_services),
        ]

    def why_not_fulfilled(self, output: str, user: Model, item: str) -> str | None:
        if not isinstance(user, ConSertModel):
            return None
        guarantee_id = self._published_ids().get(output, output)
        return why_not_fulfilled(self.data, guarantee_id, user.data, item)

    def _published_ids(self) -> dict[str, str]:
        """Return the ids that guarantees have in messages -> their ids in the model."""
        return {self.options.published(g.id): g.id for g in self.data.guarantees}


def _models(
    conserts: Sequence[model.ConSert],
    problems: Sequence[Problem],
    source: Source,
    marks: Sequence[str],
) -> ReadResult:
    marked, unclear = with_default_guarantees(conserts, marks if conserts else (), source.name)
    models: list[ConSertModel] = []
    all_problems = [*problems, *unclear]
    for consert in marked:
        checked, more = check_consert(consert)
        all_problems += more
        if checked is not None:
            models.append(ConSertModel(checked.name, source, checked.place, data=checked))
    return ReadResult(tuple(models), tuple(in_order(all_problems)))


def _input_of(node: model.Demand | model.Evidence) -> ModelInput:
    """Return an input, whose value is good where a dimension covers it; a demand has to hold."""
    dimension = node.dimension if isinstance(node, model.Evidence) else model.BinaryDimension("")
    number: dict[str, Any] = {}
    type_: InputType = "bool" if isinstance(dimension, model.BinaryDimension) else "str"
    if isinstance(dimension, model.NumericDimension):
        type_ = "float"
        number = {
            "unit": dimension.uom or "",
            "units": units.convertible(dimension.uom),
            "starts": tuple(covered.start.value for covered in dimension.covered),
        }
    return ModelInput(
        node.id,
        type_,
        description=node.description,
        covered="; ".join(dimension.text for dimension in node.dimensions),
        is_good=dimension.covers,
        is_demand=isinstance(node, model.Demand),
        uses=(Use(dimension.covers),),
        **number,
    )
