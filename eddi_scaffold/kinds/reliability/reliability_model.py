"""Systems of chains and trees as models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from eddi_scaffold.common.claims import Claim, Element, Meanings
from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, in_order, problem
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.eddi_xml.reading import read_document
from eddi_scaffold.kinds import Model, ModelDraft, ModelInput, ModelOutput, Options, ReadResult
from eddi_scaffold.kinds.reliability import read_eddi as from_eddi
from eddi_scaffold.kinds.reliability import show
from eddi_scaffold.kinds.reliability.checks import check_system
from eddi_scaffold.kinds.reliability.claims import MEANINGS
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.draft import decided, drafted
from eddi_scaffold.kinds.reliability.inputs import inputs_of
from eddi_scaffold.kinds.reliability.lowering import used
from eddi_scaffold.kinds.reliability.read_open_psa import read_mef
from eddi_scaffold.kinds.reliability.read_yaml import KEYS, read_system, with_rate
from eddi_scaffold.kinds.reliability.system import NAME, ReliabilitySystem, order
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.kinds.reliability.values import KEY, Values
from eddi_scaffold.kinds.reliability.write import to_mef, to_yaml
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, read_map, value_11


@dataclass(frozen=True)
class ReliabilityModel(Model):
    """A system of chains and trees; the configuration's keys go into the system itself."""

    kind: ClassVar[str] = NAME
    data: ReliabilitySystem = field(kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        """Read ``reliability_config.yml`` and the EDDI that it may name, or an Open-PSA file."""
        if not source.name.lower().endswith((".yml", ".yaml")):
            with source.open() as stream:
                tree, problems = load(stream, source.name)
            if tree is None:
                return ReadResult((), tuple(problems))
            systems, more = read_mef(tree.document, source.name, source.stem)
            return cls._reading(systems, source, in_order([*problems, *more]))
        root, problems = read_map(source, "R001")
        if root is None or has_errors(problems):
            return ReadResult((), tuple(in_order(problems)))
        values = Values(value_11(root), _finder(root), problems=problems)
        system, problems = read_system(values, _library(values, source), None)
        if system is None:
            return ReadResult((), tuple(in_order(problems)))
        model = cls(source.stem, source, root.place, data=system)
        return ReadResult((model,), tuple(in_order(problems)))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        """Read the chains and the top events of an EDDI, a model each."""
        systems, problems = from_eddi.read_eddi(document, source)
        return cls._reading([] if has_errors(problems) else systems, source, problems)

    @classmethod
    def _reading(
        cls, systems: Sequence[ReliabilitySystem], source: Source, problems: Sequence[Problem]
    ) -> ReadResult:
        models = (cls(system.top, source, system.place, data=system) for system in systems)
        return ReadResult(tuple(models), tuple(problems))

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:
        return MEANINGS

    def check(self) -> Sequence[Problem]:
        problems = check_system(self.data)
        return problems if has_errors(problems) else [*problems, *_never(self.data)]

    def counts(self) -> Mapping[str, int]:
        return show.counts(self.data)

    def outline(self) -> Sequence[str]:
        return show.outline(self.data)

    def export(self) -> Mapping[str, str]:
        """Return the whole system as a readable file, and its tree as Open-PSA if possible."""
        name = "".join(c if c.isalnum() or c in "._-" else "_" for c in self.name)
        tree = to_mef(self.data)
        opsa = {f"{name}.opsa.xml": tree} if tree is not None else {}
        return {f"{name}.yml": to_yaml(self.data), **opsa}

    def diagram(self) -> Diagram:
        return show.picture(self.name, self.data)

    def draft(self, options: Options) -> ModelDraft:
        configured, _ = self.configure(replace(options, values=decided(options.values)))
        return drafted(self.source, self.data, None if configured is None else configured.data)

    def configure(self, options: Options) -> tuple[ReliabilityModel | None, list[Problem]]:
        """Take the keys of ``Model:`` into the system: horizon, thresholds, what is observed."""
        system: ReliabilitySystem | None = self.data
        chosen = {key: value for key, value in options.values.items() if key in KEYS}
        problems: list[Problem] = []
        if chosen:
            system, problems = read_system(Values(chosen, options.place), {}, system)
        if system is None:
            return None, problems
        if not has_errors(check_system(system)):
            system = used(with_rate(system, options.frequency))
        before = set(self.check())  # what was in the file before is reported by check
        problems += [
            problem
            for problem in check_system(system)
            if problem.level == "error" or problem not in before
        ]
        if has_errors(problems):
            return None, problems
        problems += [problem for problem in _never(system) if problem not in before]
        problems += _always_late(system)
        return replace(self, data=system, name=options.id or self.name), problems

    def inputs(self) -> Sequence[ModelInput]:
        return inputs_of(used(self.data))

    def own_topics(self) -> Sequence[ModelOutput]:
        """Return the topics of thresholds that have one."""
        return [
            ModelOutput(
                threshold.id,
                threshold.topic,
                ("evidence", ("id", threshold.id), "active"),
                threshold.place,
            )
            for threshold in self.data.thresholds
            if threshold.topic is not None
        ]

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        return {"evidence": [threshold.id for threshold in self.data.thresholds]}

    def readme(self) -> Sequence[str]:
        return show.readme(self.data)

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_system(self.data, declaration)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return the thresholds: every input counts in the probability of failure."""
        ids = frozenset(input_.id for input_ in inputs)
        return [Claim(threshold.id, ids) for threshold in self.data.thresholds]

    def elements(self) -> Sequence[Element]:
        """Return what the top uses, each behind what it needs, then the thresholds."""
        components = self.data.components
        below = {name: component.below for name, component in components.items()}
        names = (name for name in order(self.data.top, below)[0] if name in components)
        places = [(name, components[name].place) for name in names]
        return [
            *(Element("component", name, None, place.line, place.path) for name, place in places),
            *(Element("threshold", threshold.id) for threshold in self.data.thresholds),
        ]


def _finder(root: Node) -> Callable[..., Place]:
    def find(*path: str | int) -> Place:
        node = root
        for i, step in enumerate(path):
            below: Node | None = None
            if isinstance(node, Map):
                below = node.get(str(step))
                if path[i + 1 :] == (KEY,):
                    return next((k.place for k, _ in node.entries if k.text == step), node.place)
            elif isinstance(node, Items) and isinstance(step, int) and step < len(node.items):
                below = node.items[step]
            if below is None:
                break
            node = below
        return node.place

    return find


def _library(values: Values, source: Source) -> Mapping[str, ReliabilitySystem]:
    """Read the EDDI that the key ``file`` names, relative to the configuration."""
    name = values.text("file")
    if name is None:
        return {}
    try:
        eddi = read_source(next_to(source.name, name))
    except EddiError as failure:
        reasons = "; ".join(problem.message for problem in failure.problems)
        values.report("R001.file", "file", name=name, reasons=reasons)
        return {}
    document, problems = read_document(eddi)
    values.problems += problems
    if document is None:
        return {}
    systems, problems = from_eddi.read_eddi(document, eddi)
    values.problems += problems
    return {system.top: system for system in systems}


def _always_late(system: ReliabilitySystem) -> list[Problem]:
    """Return a warning when every step comes later than is usual (R014)."""
    if system.max_gap is None or system.max_gap >= system.quantum:
        return []
    return [problem("R014.max_gap", system.place, max_gap=system.max_gap, period=system.quantum)]


def _never(system: ReliabilitySystem) -> list[Problem]:
    """Return a warning for each threshold that decides nothing at the start (R014).

    Where the mission's end is an input, the best is that it comes at once.
    """
    if not system.thresholds:
        return []
    best = at_start(system, seconds_left=0.0 if system.mission_end else None)
    worst = at_start(system, known=False)
    when = "at mission start" + (", however near the end is" if system.mission_end else "")
    found = []
    for threshold in system.thresholds:
        if best.p_fail > threshold.activate:
            found.append(
                problem(
                    "R014.never_met",
                    threshold.place,
                    threshold=threshold.id,
                    when=when,
                    p_fail=best.p_fail,
                    activate=threshold.activate,
                )
            )
        elif worst.p_fail_high <= threshold.activate and inputs_of(system):
            found.append(
                problem(
                    "R014.always_met",
                    threshold.place,
                    threshold=threshold.id,
                    p_fail_high=worst.p_fail_high,
                )
            )
    return found
