"""What is done with ConSerts: their inputs, what guarantees rest on, what messages mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from eddi_scaffold.common import units
from eddi_scaffold.common.claims import Acceptance, Claim, Element, Use
from eddi_scaffold.common.escaping import markdown_code, markdown_text
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Problem, has_errors, in_order
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Shape, Tone
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds import InputType, Model, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert import published_class
from eddi_scaffold.kinds.consert.checks import check_consert, static_checks
from eddi_scaffold.kinds.consert.compile import compile_consert
from eddi_scaffold.kinds.consert.compose import why_not_fulfilled
from eddi_scaffold.kinds.consert.graph import constants
from eddi_scaffold.kinds.consert.options import (
    ConSertOptions,
    read_options,
    with_default_guarantees,
)
from eddi_scaffold.kinds.consert.read_eddi import read_eddi
from eddi_scaffold.kinds.consert.read_short import read_consert
from eddi_scaffold.kinds.consert.vectors import consert_vectors
from eddi_scaffold.kinds.consert.verify import Proof
from eddi_scaffold.kinds.consert.write_yaml import to_yaml
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

DEEPEST = 30
"""Levels that are printed; what lies deeper is counted as "..." (a line grows with its level)."""
_LEVELS, _TERMS = 3, 10  # of the gates in an expression that is still read
_GROUPS = (
    *("guarantees", "demands", "evidence", "gates"),
    *("tree_propagations", "required_services", "provided_services"),
)
_LOOKS: dict[str, tuple[Shape, Tone, str]] = {
    "guarantee": ("rounded", "output", "guarantee"),
    "And": ("and", "gate", "And"),
    "Or": ("or", "gate", "Or"),
    "evidence": ("ellipse", "input", "runtime evidence"),
    "demand": ("hexagon", "demand", "demand on another system"),
}


@dataclass(frozen=True)
class ConSertModel(Model):
    """A ConSert, and what its configuration chooses."""

    kind: ClassVar[str] = "consert"
    data: model.ConSert = field(kw_only=True)
    options: ConSertOptions = field(default=ConSertOptions(), kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        consert, problems = read_consert(source)
        conserts = [] if consert is None else [consert]
        return _models(conserts, problems, source, default_guarantees)

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        return _models(*read_eddi(document, source), source, default_guarantees)

    def check(self) -> Sequence[Problem]:
        return [*static_checks(self.data)]

    def counts(self) -> Mapping[str, int]:
        return {group: len(getattr(self.data, group)) for group in _GROUPS}

    def outline(self) -> Sequence[str]:
        """Return the guarantees with their support, then services.

        A gate or guarantee that several others use is written out once and named after that.
        """
        consert, shown = self.data, set[str]()
        labels = {node.id: _label(node) for node in consert.nodes}
        lines = [f"of the system {consert.system}"] if consert.system else []
        for guarantee in consert.guarantees:
            lines += _tree(guarantee.id, labels, consert.inputs, shown)
        for service in consert.services:
            verb = "requires" if service.member_kind == "demand" else "provides"
            members = ", ".join(service.members)
            lines.append(f"{verb} {service.id} ({service.functional_service_type}): {members}")
        return lines

    def write(self) -> Mapping[str, str]:
        return {f"{self.safe_name}.yml": to_yaml(self.data)}

    def named(self, name: str) -> ConSertModel:
        return replace(self, name=name, data=replace(self.data, name=name))

    def diagram(self) -> Diagram:
        """Return the picture, as SESAME D7.2 Fig 4 draws it."""
        inputs, counts = self.data.inputs, self.counts()
        groups = ("guarantees", "gates", "evidence", "demands")
        counted = ", ".join(f"{counts[group]} {group}" for group in groups)
        edges = (DiagramEdge(of, target) for target, sources in inputs.items() for of in sources)
        nodes = []
        for node in (node for group in groups for node in getattr(self.data, group)):
            is_gate = isinstance(node, model.Gate)
            shape, tone, _ = _LOOKS[node.function if is_gate else node.kind]
            texts = () if is_gate else (dimension.text for dimension in node.dimensions)
            lines = (node.function.upper(),) if is_gate else (node.id, *texts)
            about = node.id if is_gate else node.description or ""
            nodes.append(DiagramNode(node.id, lines, shape, tone, about))
        return Diagram(
            f"ConSert {self.data.name}",
            tuple(nodes),
            tuple(edges),
            "up",
            tuple(LegendEntry(title, shape, tone) for shape, tone, title in _LOOKS.values()),
            f"{counted}; support leads upwards",
        )

    def configure(self, options: Options) -> tuple[ConSertModel | None, list[Problem]]:
        chosen, problems = read_options(options)
        return None if chosen is None else replace(self, options=chosen), problems

    def inputs(self) -> Sequence[ModelInput]:
        """Return demands, then evidence, each in file order (the order of SESAME D7.2 Fig 44).

        A demand is a Boolean at run time, whatever its dimensions: that it fits has been decided
        when the ConSerts were composed.
        """
        return [*map(_input_of, self.data.demands), *map(_input_of, self.data.evidence)]

    def readme(self) -> Sequence[str]:
        """Return the guarantees, each with its type and what it needs."""
        gates = {gate.id: gate for gate in self.data.gates}
        lines = ["| guarantee | type | active while |", "|---|---|---|"]
        for guarantee in self.data.guarantees:
            id_ = markdown_code(self.options.published(guarantee.id))
            type_ = markdown_text("; ".join(dimension.text for dimension in guarantee.dimensions))
            needs = _expression(guarantee.id, "AND", self.data.inputs, gates)
            needs = "always" if guarantee.default else f"`{markdown_code(needs)}`"
            lines.append(f"| `{id_}` | {type_} | {needs} |")
        if self.options.guarantee_ids == "class":
            lines += ["", "Ids of guarantees are published as SESAME D7.2 names its classes."]
        return lines

    def companion_messages(self) -> Mapping[str, str]:
        return {"status": "ConSertStatus"}

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {"guarantees": [*self._published_ids()]}

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_consert(self.data, self.options, declaration)

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        return consert_vectors(self.data, self.options, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        return Proof(self.data, self.options, emitted).proved()

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return each guarantee, by its id in messages, with the leaves that it rests on."""
        fixed, hold_s = constants(self.data), self.options.hold_s(frequency)
        claims = []
        for guarantee in self.data.guarantees:
            is_fixed = fixed[guarantee.id] is not None
            below = set() if is_fixed else reached(self.data.inputs, [guarantee.id])
            leaves = frozenset(leaf for leaf in self.data.leaves if leaf in below)
            gates = tuple(gate.id for gate in self.data.gates if gate.id in below)
            id_ = self.options.published(guarantee.id)
            claims.append(Claim(id_, leaves, hold_s, gates=gates))
        return claims

    def lag(self, output: str, input_: str) -> float:
        return 0.0

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return what a filter by majority accepts: the majority of old steps."""
        seconds = self.options.hold_s(frequency)
        if not seconds:
            return ()
        key, what = "filter: majority", "the majority of old steps"
        return [Acceptance(key, what, f"for {seconds:g} s", seconds, path=("Model", "filter"))]

    def elements(self) -> Sequence[Element]:
        """Return what has a place, then the services."""
        of = self.data
        elements = []
        nodes: Sequence[model.Node] = (*of.demands, *of.evidence, *of.gates, *of.guarantees)
        for node in nodes:
            class_name = published_class(node.id) if isinstance(node, model.Guarantee) else None
            place = node.place
            elements.append(Element(node.kind, node.id, class_name, place.line, place.path))
        services: Sequence[model.Service] = (*of.provided_services, *of.required_services)
        return elements + [Element(service.kind, service.id) for service in services]

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
        faults = [*check_consert(consert)]
        all_problems += faults
        # one of which only something is missing can be shown
        if not has_errors(fault for fault in faults if fault.code not in ("C011", "C014")):
            models.append(ConSertModel(consert.name, source, consert.place, data=consert))
    return ReadResult(tuple(models), tuple(in_order(all_problems)))


def _input_of(node: model.Demand | model.Evidence) -> ModelInput:
    """Return an input, whose value is good where a dimension covers it; a demand has to hold."""
    dimension = node.dimension if isinstance(node, model.Evidence) else model.BinaryDimension("")
    number: dict[str, Any] = {}
    covered = "; ".join(dimension.text for dimension in node.dimensions)
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
        covered="true" if covered == node.id else covered,  # as in the short form
        is_good=dimension.covers,
        is_demand=isinstance(node, model.Demand),
        uses=(Use(dimension.covers),),
        **number,
    )


def _tree(
    root: str, labels: Mapping[str, str], inputs: Mapping[str, Sequence[str]], shown: set[str]
) -> Iterator[str]:
    waiting = [(0, root)]
    while waiting:
        level, id_ = waiting.pop()
        children, line = inputs[id_], "  " * level + labels[id_]
        if id_ in shown and children:
            yield f"{line} (see above)"
        elif level >= DEEPEST and children:
            yield f"{line} ..."
        else:
            shown.add(id_)
            yield line
            waiting += [(level + 1, child) for child in reversed(children)]


def _expression(
    id_: str,
    word: str,
    inputs: Mapping[str, Sequence[str]],
    gates: Mapping[str, model.Gate],
    level: int = 0,
) -> str:
    """Return what a node needs; a gate that is too deep or wide to be read stands as its id."""
    terms = []
    for source in inputs[id_]:
        gate = gates.get(source)
        if gate is None or level == _LEVELS or len(inputs[source]) > _TERMS:
            terms.append(source)
        else:
            own = word if len(inputs[source]) == 1 else gate.function.upper()
            text = _expression(source, own, inputs, gates, level + 1)
            terms.append(text if own == word else f"({text})")
    return f" {word} ".join(terms)


def _label(node: model.Node) -> str:
    if isinstance(node, model.Gate):
        return f"{node.function} {node.id}"
    text = "; ".join(dimension.text for dimension in node.dimensions)
    mark = " (default)" if isinstance(node, model.Guarantee) and node.default else ""
    return f"{node.kind} {node.id}" + (f": {text}" if text else "") + mark
