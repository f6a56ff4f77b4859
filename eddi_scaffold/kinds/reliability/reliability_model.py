"""Systems of chains and trees as models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import ClassVar

from eddi_scaffold import kinds
from eddi_scaffold.common.claims import Claim, Element
from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, in_order, problem
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document, recognises
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds.reliability import KEYS, show
from eddi_scaffold.kinds.reliability.checks import check_system
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.read_eddi import read_eddi
from eddi_scaffold.kinds.reliability.read_open_psa import read_open_psa
from eddi_scaffold.kinds.reliability.read_yaml import read_system
from eddi_scaffold.kinds.reliability.system import NAME, Chain, FaultTree, ReliabilitySystem
from eddi_scaffold.kinds.reliability.values import KEY, Values
from eddi_scaffold.kinds.reliability.vectors import system_vectors
from eddi_scaffold.kinds.reliability.verify import verify
from eddi_scaffold.kinds.reliability.write import to_open_psa, to_yaml
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, read_map, value_11

_MOST_NAMES = 12


@dataclass(frozen=True)
class ReliabilityModel(kinds.Model):
    """A system of chains and trees; the configuration's keys go into the system itself."""

    kind: ClassVar[str] = NAME
    data: ReliabilitySystem = field(kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> kinds.ReadResult:
        """Read ``reliability_config.yml`` and the EDDI that it may name, or an Open-PSA file."""
        if not source.name.lower().endswith((".yml", ".yaml")):
            element, problems = load(source.data, source.name)
            if element is None:
                return kinds.ReadResult((), tuple(problems))
            systems, more = read_open_psa(element, source.name, source.stem)
            return cls._result(systems, source, in_order([*problems, *more]))
        root, problems = read_map(source, "R001")
        if root is None or has_errors(problems):
            return kinds.ReadResult((), tuple(in_order(problems)))
        values = Values(value_11(root), partial(_place, root), problems=problems)
        system, problems = read_system(values, _library(values, source), None)
        models = () if system is None else (cls(source.stem, source, root.place, data=system),)
        return kinds.ReadResult(models, tuple(in_order(problems)))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> kinds.ReadResult:
        systems, problems = read_eddi(document, source)
        return cls._result([] if has_errors(problems) else systems, source, problems)

    @classmethod
    def _result(
        cls, systems: Sequence[ReliabilitySystem], source: Source, problems: Sequence[Problem]
    ) -> kinds.ReadResult:
        models = (cls(system.top, source, system.place, data=system) for system in systems)
        return kinds.ReadResult(tuple(models), tuple(problems))

    def check(self) -> Sequence[Problem]:
        problems = check_system(self.data)
        return problems if has_errors(problems) else [*problems, *_undecided(self.data)]

    def counts(self) -> Mapping[str, int]:
        return self.data.counts()

    def outline(self) -> Sequence[str]:
        return show.outline(self.data)

    def write(self) -> Mapping[str, str]:
        return {f"{self.safe_name}.yml": to_yaml(self.data)}

    def export(self) -> Mapping[str, str]:
        tree = to_open_psa(self.data)
        return {**self.write(), **({f"{self.safe_name}.opsa.xml": tree} if tree else {})}

    def diagram(self) -> Diagram:
        return show.picture(self.name, self.data)

    def draft(self, options: kinds.Options) -> kinds.ModelDraft:
        """Return what a model of an EDDI leaves open; a reliability_config.yml says it itself."""
        configured, _ = self.configure(replace(options, values=_decided(options.values)))
        inputs = () if configured is None else configured.inputs()
        if not recognises(self.source):
            return kinds.ModelDraft(inputs)
        models: dict[str, kinds.JsonValue] = {}
        notes: dict[tuple[str, ...], str] = {("horizon",): "how far ahead, for instance 30 min"}
        for name, component in self.data.without_unused().components.items():
            content = component.content
            if isinstance(content, Chain) and not content.observe:
                states = ", ".join(f"{state}: INPUT" for state in content.states[:_MOST_NAMES])
                key, note = "observe", f"{{{states}}}, or `not INPUT`: false excludes the state"
            elif isinstance(content, FaultTree) and not any(
                event.observed for event in content.events.values()
            ):
                names = ", ".join([*content.events][:_MOST_NAMES])
                key, note = "events", f"{{EVENT: {{observed: true}}}} of {names}; {{}} for none"
            else:
                continue
            models[name], notes["models", name, key] = {key: TODO}, note
        values: dict[str, kinds.JsonValue] = {"horizon": TODO}
        return kinds.ModelDraft(inputs, values | ({"models": models} if models else {}), notes)

    def configure(self, options: kinds.Options) -> tuple[ReliabilityModel | None, list[Problem]]:
        """Take the keys of ``Model:`` into the system: horizon, thresholds, what is observed."""
        system: ReliabilitySystem | None = self.data
        chosen = {key: value for key, value in options.values.items() if key in KEYS}
        problems: list[Problem] = []
        if chosen:
            system, problems = read_system(Values(chosen, options.place), {}, system)
        if system is None:
            return None, problems
        if not has_errors(check_system(system)):
            quantum = 1.0 / options.frequency if options.frequency else system.quantum
            system = replace(system, quantum=quantum).without_unused()
        before = set(self.check())  # what was in the file before is reported by check
        new = [p for p in check_system(system) if p.level == "error" or p not in before]
        problems += new
        if has_errors(problems):
            return None, problems
        problems += [problem for problem in _undecided(system) if problem not in before]
        if system.max_gap is not None and system.max_gap < system.quantum:
            gap, period = system.max_gap, system.quantum
            problems.append(problem("R014.max_gap", system.place, max_gap=gap, period=period))
        return replace(self, data=system, name=options.id or self.name), problems

    def inputs(self) -> Sequence[kinds.ModelInput]:
        return self.data.without_unused().inputs()

    def own_topics(self) -> Sequence[kinds.ModelOutput]:
        return [
            kinds.ModelOutput(t.id, t.topic, ("evidence", ("id", t.id), "active"), t.place)
            for t in self.data.thresholds
            if t.topic is not None
        ]

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {"evidence": [threshold.id for threshold in self.data.thresholds]}

    def readme(self) -> Sequence[str]:
        return show.readme(self.data)

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_system(self.data, declaration)

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        return system_vectors(self.data, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        return verify(self.data, emitted)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return the thresholds: every input counts in the probability of failure."""
        ids = frozenset(input_.id for input_ in inputs)
        # by the worst case of what is unknown they need not go away
        holds = tuple((id_, None) for id_ in sorted(ids if self.data.worst_case else ()))
        return [Claim(threshold.id, ids, holds=holds) for threshold in self.data.thresholds]

    def elements(self) -> Sequence[Element]:
        models = [(model.name, model.place) for model in self.data.used_models()]
        return [
            *(Element("component", name, None, place.line, place.path) for name, place in models),
            *(Element("threshold", threshold.id) for threshold in self.data.thresholds),
        ]


def _decided(values: Mapping[str, kinds.JsonValue]) -> dict[str, kinds.JsonValue]:
    """Return options without what is still to be decided."""
    return {
        key: _decided(value) if isinstance(value, Mapping) else value
        for key, value in values.items()
        if value != TODO
    }


def _place(root: Node, *path: str | int) -> Place:
    node = root
    for i, step in enumerate(path):
        below: Node | None = None
        if isinstance(node, Map):
            if path[i + 1 :] == (KEY,):
                return next((key.place for key, _ in node.entries if key.text == step), node.place)
            below = node.get(str(step))
        elif isinstance(node, Items) and isinstance(step, int):
            below = next(iter(node.items[step : step + 1]), None)
        node = below or node
    return node.place


def _library(values: Values, source: Source) -> Mapping[str, ReliabilitySystem]:
    name = values.text("file")
    if name is None:
        return {}
    try:
        eddi = read_source(next_to(source.name, name))
    except EddiError as failure:
        values.report("R001.file", "file", name=name, reasons=failure)
        return {}
    document, problems = read_document(eddi)
    systems, more = read_eddi(document, eddi) if document is not None else ([], [])
    values.problems += [*problems, *more]
    return {system.top: system for system in systems}


def _undecided(system: ReliabilitySystem) -> Iterator[Problem]:
    """Warn of each threshold that decides nothing at the start (R014)."""
    if not system.thresholds:
        return
    best, worst = show.at_start(system).p_fail, show.at_start(system, known=False).p_fail_high
    for t in system.thresholds:
        if best > t.activate and not system.mission_end:  # which may be near
            yield problem(
                "R014.never_met", t.place, threshold=t.id, p_fail=best, activate=t.activate
            )
        elif worst <= t.activate and system.inputs():
            yield problem("R014.always_met", t.place, threshold=t.id, p_fail_high=worst)
