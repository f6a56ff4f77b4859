"""Bayesian networks as models: what is read, shown, claimed and accepted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import PurePath
from typing import Any, ClassVar

from eddi_scaffold import kinds
from eddi_scaffold.common.claims import Acceptance, Claim, Element
from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, in_order
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.document import recognises as is_xml
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds.bayesian_network import cross_check, method_module, read_xml_formats
from eddi_scaffold.kinds.bayesian_network.compile import compile_network
from eddi_scaffold.kinds.bayesian_network.network import Network, in_digits
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions, Threshold, read_options
from eddi_scaffold.kinds.bayesian_network.read_eddi import read_networks
from eddi_scaffold.kinds.bayesian_network.read_text_formats import read_bif
from eddi_scaffold.kinds.bayesian_network.write import to_xdsl, to_xmlbif
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

NAME = "bayesian_network"
_MOST_CASES = 4096  # of all nodes, whose probabilities are summed
_POLICIES = {"prior": "the prior", "default": "the state of the default", "hold": "the last state"}
_BEYOND = (
    ("clamp", "out_of_range", "clamp", "the nearest value in range"),
    ("allow_inf", "allow_inf", "true", "the outermost bin"),
)
"""Field of the runtime's declaration, key and value in a configuration, what is accepted."""
_LEGEND = (
    LegendEntry("output", "table", "output"),
    LegendEntry("observed", "table", "input"),
    LegendEntry("neither", "table", "neutral"),
)
_SHOWN = 6
_NONE = "none (write the methods)"
_ON_EVIDENCE = (
    "Evidence holds for every state that unknown inputs may have; of what is not known, only a "
    "prior that the configuration accepts by name counts. The posteriors themselves are no "
    "evidence. After a step in Python, `EDDIMonitor.monitor.claims()` returns it."
)


@dataclass(frozen=True)
class NetworkModel(kinds.Model):
    """A network; its options come from a configuration, ``None`` without one."""

    kind: ClassVar[str] = NAME
    data: Network = field(kw_only=True)
    options: NetworkOptions | None = field(default=None, kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> kinds.ReadResult:
        suffix = PurePath(source.name).suffix.lower()
        if suffix == ".bif" and not is_xml(source):
            network, problems = read_bif(source)
        else:
            is_bif = suffix != ".xdsl" and b"<BIF" in source.data[:65536]
            clean, problems = read_xml_formats.without_doctype(source) if is_bif else (source, [])
            root, faults = load(clean.data, source.name)
            network, problems = None, problems or faults
            if root is not None:
                is_xmlbif = is_bif or suffix in (".xmlbif", ".bifxml")
                read = read_xml_formats.read_xmlbif if is_xmlbif else read_xml_formats.read_xdsl
                network, faults = read(root, source.name, source.stem)
                problems = [*problems, *faults]
        models = []
        if network is not None:  # GeNIe calls every network the same, until somebody changes that
            place, stem = network.place, source.stem
            models = [cls(network.name, source, place, data=network, file_stem=stem)]
        return kinds.ReadResult(tuple(models), tuple(in_order(problems)))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> kinds.ReadResult:
        networks, problems = read_networks(document, source)
        models = tuple(cls(of.name, source, of.place, data=of) for of in networks)
        return kinds.ReadResult(models, tuple(in_order(problems)))

    @cached_property
    def settings(self) -> NetworkOptions:
        """The options, by default those without a configuration."""
        settings = self.options or read_options(self.data, None)[0]
        assert settings is not None, "a checked network needs no configuration"
        return settings

    def counts(self) -> Mapping[str, int]:
        nodes = self.data.nodes
        return {
            "nodes": len(nodes),
            "edges": sum(len(node.parents) for node in nodes),
            "states": sum(len(node.states) for node in nodes),
            "parameters": sum(len(node.table) for node in nodes),
        }

    def outline(self) -> Sequence[str]:
        """Return the nodes with states and parents, then what inference costs."""
        options, lines = self.settings, list[str]()
        for node in self.data.nodes:
            title = f" ({node.title})" if node.title != node.id else ""
            lines.append(f"{node.id}{title}: {', '.join(node.states)}")
            if node.parents:
                lines.append(f"  given {', '.join(node.parents)}")
        if self.data.known:
            known = (
                f"{name} (event {event})" if event else name for name, event in self.data.known
            )
            lines.append(f"known: {', '.join(known)}")
        lines.append(f"outputs: {', '.join(options.outputs)}")
        largest = in_digits(options.width.largest)
        lines.append(f"largest table of the inference, all nodes observable: {largest} entries")
        return [*lines, *(f"evidence {entry.id}: {entry.text()}" for entry in options.thresholds)]

    def write(self) -> Mapping[str, str]:
        return {f"{self.safe_name}.xmlbif": to_xmlbif(self.data)}

    def export(self) -> Mapping[str, str]:
        """Return the network as XMLBIF, and as XDSL for GeNIe."""
        return {**self.write(), f"{self.safe_name}.xdsl": to_xdsl(self.data)}

    def diagram(self) -> Diagram:
        """Return the picture: parents above their children, each with its states."""
        observed = () if self.options is None else self.options.observed
        nodes, edges = [], []
        for node in self.data.nodes:
            edges += [DiagramEdge(parent, node.id) for parent in node.parents]
            tone: Tone = "input" if node.id in observed else "neutral"
            if node.id in self.settings.outputs:
                tone = "output"
            states = [*node.states[:_SHOWN], *(("...",) if len(node.states) > _SHOWN else ())]
            title = node.id if node.title == node.id else f"{node.title} ({node.id})"
            nodes.append(DiagramNode(node.id, (title, *states), "table", tone, node.id))
        text = f"{len(nodes)} nodes, {len(edges)} edges; parents are above their children"
        title = f"Bayesian network {self.name}"
        return Diagram(title, tuple(nodes), tuple(edges), "down", _LEGEND, text)

    def draft(self, options: kinds.Options) -> kinds.ModelDraft:
        return method_module.draft(self.data, options)

    def configure(self, options: kinds.Options) -> tuple[NetworkModel | None, list[Problem]]:
        settings, problems = read_options(self.data, options)
        if settings is None:
            return None, problems
        return replace(self, name=options.id or self.name, options=settings), problems

    def inputs(self) -> Sequence[kinds.ModelInput]:
        return self.settings.inputs

    def companion_messages(self) -> Mapping[str, str]:
        evidence = {"evidence": "BayesianNetworkEvidence"} if self.settings.thresholds else {}
        return {"status": "BayesianNetworkStatus", **evidence}

    def own_topics(self) -> Sequence[kinds.ModelOutput]:
        """Return the topics of thresholds that have one."""
        return [
            kinds.ModelOutput(
                entry.id,
                entry.topic,
                ("evidence", ("id", entry.id), "active"),
                entry.place,
                "evidence",
            )
            for entry in self.settings.thresholds
            if entry.topic is not None
        ]

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        """Return the thresholds, the titles of the outputs, and the outcomes of each."""
        outputs = [self.data.node(name) for name in self.settings.outputs]
        return {
            "evidence": [threshold.id for threshold in self.settings.thresholds],
            "output_nodes": [node.title for node in outputs],
            **{f"output_nodes[{node.title}].outcomes": node.states for node in outputs},
        }

    def editable_modules(self) -> Sequence[kinds.EditableModule]:
        return (method_module.config_module(self.data, self.settings),)

    def readme(self) -> Sequence[str]:
        options = self.settings
        outputs, observed = (
            ", ".join(f"`{markdown_code(name)}`" for name in names)
            for names in (options.outputs, options.observed)
        )
        text = (
            f"Outputs: {outputs}. Observed by declaration: {observed or _NONE}. "
            "A missing input leaves its node unobserved; the posterior is exact for what is known."
        )
        lines = [
            "## Network",
            "",
            text,
            "",
            f"The largest table of the inference has {in_digits(options.width.largest)} entries.",
        ]
        if not options.thresholds:
            return lines
        rows = [f"| `{entry.id}` | {entry.text()} |" for entry in options.thresholds]
        return [*lines, "", _ON_EVIDENCE, "", "| evidence | active while |", "|---|---|", *rows]

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_network(self.data, self.settings, declaration)

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        from eddi_scaffold.kinds.bayesian_network.vectors import (  # noqa: PLC0415 - needs numpy
            network_vectors,
        )

        return network_vectors(self.data, self.settings, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        from eddi_scaffold.kinds.bayesian_network.verify import (  # noqa: PLC0415 - needs numpy
            verify,
        )

        return verify(self.data, self.settings, emitted)

    def cross_check(self, running: Callable[[], Any]) -> kinds.CrossCheck:
        return cross_check.cross_check(self.data, self.settings, running)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return the thresholds: they rest on every input; raw posteriors claim nothing.

        They may outlive their inputs for as long as a state is held.
        """
        acceptances = self.acceptances(inputs, frequency)
        hold_s = max([entry.seconds or 0.0 for entry in acceptances], default=0.0)
        rests_on = frozenset(input_.id for input_ in inputs)
        accepted = {of.input for of in acceptances if of.seconds is None}
        return [
            Claim(
                of.id,
                rests_on,
                hold_s,
                holds=tuple(
                    (id_, None) for id_ in sorted(rests_on if self._may_stay(of) else accepted)
                ),
            )
            for of in self.settings.thresholds
        ]

    def lag(self, output: str, input_: str) -> float:
        (threshold,) = (of for of in self.settings.thresholds if of.id == output)
        return math.inf if self._may_stay(threshold) else 0.0

    def _may_stay(self, threshold: Threshold) -> bool:
        """Return whether a threshold may stay as it is, between limits, whatever is observed.

        An unknown state counts as the worst one: the probabilities are those of known states.
        """
        readers = {of.node: of.reader for of in self.settings.declarations}
        given, limits = self.settings.observable, (threshold.limit, threshold.release)
        if any(of.hysteresis for of in readers.values()):
            return True
        if limits[0] == limits[1]:
            return False
        sizes = math.prod(len(node.states) for node in self.data.nodes)
        priors = any(of.policy == "prior" for of in readers.values())
        if priors or not readers.keys() >= {*given} or sizes > _MOST_CASES:
            return True
        from eddi_scaffold.kinds.bayesian_network.elimination import (  # noqa: PLC0415 - needs numpy
            factors_of,
            summed,
        )

        names = self.data.names()
        joint = summed(factors_of(self.data), [*map(names.index, [*given, threshold.node])])
        states = self.data.node(threshold.node).states
        part = joint[..., [*map(states.index, threshold.states)]].sum(-1)
        possible = (whole := joint.sum(-1)) > 0.0
        attained = (part[possible] / whole[possible]).tolist()
        return any(min(limits) <= p <= max(limits) and p != threshold.limit for p in attained)

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return what the declarations of the nodes accept in place of a known state."""
        input_of = {input_.id: input_ for input_ in inputs}
        accepted = []
        for entry in self.settings.declarations:
            path = ("Model", "discretisation", entry.node)
            policy, source = entry.reader.policy, input_of[entry.input]
            if policy in _POLICIES and (policy != "default" or source.default is not None):
                lasts, seconds = "while it is unknown", None
                if policy == "hold" and isinstance(source.max_age, float):
                    seconds = source.max_age + 1 / frequency
                    lasts = f"for {seconds:g} s"
                text, key = f"{_POLICIES[policy]} of {entry.node}", f"missing: {policy}"
                place = (*path, "missing")
                accepted.append(Acceptance(key, text, lasts, seconds, entry.input, place))
            for field_, name, value, what in _BEYOND:
                if getattr(entry.reader, field_):
                    text, key, place = f"{what} of {entry.node}", f"{name}: {value}", (*path, name)
                    lasts = "while it is so"
                    accepted.append(Acceptance(key, text, lasts, None, entry.input, place))
        return accepted

    def elements(self) -> Sequence[Element]:
        """Return the nodes, then the thresholds."""
        nodes = [
            Element("node", node.id, None, node.place.line, node.place.path)
            for node in self.data.nodes
        ]
        return [*nodes, *(Element("threshold", entry.id) for entry in self.settings.thresholds)]
