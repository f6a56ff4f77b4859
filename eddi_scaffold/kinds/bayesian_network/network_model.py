"""Bayesian networks as models."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Any, ClassVar

from eddi_scaffold.common.claims import Acceptance, Claim, Element, Meanings
from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, in_order, problem
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.eddi_xml.reading import recognises as is_xml
from eddi_scaffold.kinds import (
    CrossCheck,
    EditableModule,
    Model,
    ModelDraft,
    ModelInput,
    ModelOutput,
    Options,
    ReadResult,
)
from eddi_scaffold.kinds.bayesian_network import claims as evidence_claims
from eddi_scaffold.kinds.bayesian_network import cross_check, method_module, read_eddi, show
from eddi_scaffold.kinds.bayesian_network.compile import compile_network
from eddi_scaffold.kinds.bayesian_network.lint import is_config_module, lint
from eddi_scaffold.kinds.bayesian_network.network import (
    Network,
    in_digits,
)
from eddi_scaffold.kinds.bayesian_network.options import (
    NetworkOptions,
    default_options,
    read_options,
)
from eddi_scaffold.kinds.bayesian_network.read_bif import read_bif
from eddi_scaffold.kinds.bayesian_network.read_xdsl import read_xdsl
from eddi_scaffold.kinds.bayesian_network.read_xmlbif import read_xmlbif, without_doctype
from eddi_scaffold.kinds.bayesian_network.thresholds import Threshold
from eddi_scaffold.kinds.bayesian_network.write import changed_ids, to_xdsl, to_xmlbif
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

NAME = "bayesian_network"


@dataclass(frozen=True)
class NetworkModel(Model):
    """A network; its options come from a configuration, ``None`` without one."""

    kind: ClassVar[str] = NAME
    data: Network = field(kw_only=True)
    options: NetworkOptions | None = field(default=None, kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        """Read a network by itself, or look at a module of hand-written methods."""
        if is_config_module(source.name):
            return ReadResult((), tuple(in_order(lint(source))))
        suffix = PurePath(source.name).suffix.lower()
        if suffix == ".bif" and not is_xml(source):
            network, problems = read_bif(source)
        else:
            network, problems = _read_xml(source, suffix)
        # GeNIe calls every network the same, until somebody changes that
        models = (
            [] if network is None else [replace(cls._of(network, source), file_stem=source.stem)]
        )
        return ReadResult(tuple(models), tuple(in_order(problems)))

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        networks, problems = read_eddi.read_eddi(document, source)
        models = tuple(cls._of(network, source) for network in networks)
        return ReadResult(models, tuple(in_order(problems)))

    @classmethod
    def _of(cls, network: Network, source: Source) -> NetworkModel:
        return cls(network.name, source, network.place, data=network)

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:
        return evidence_claims.MEANINGS

    @property
    def settings(self) -> NetworkOptions:
        """The options, by default those without a configuration."""
        return default_options(self.data) if self.options is None else self.options

    def check(self) -> Sequence[Problem]:
        """Return what the readers do not see: names that an export must change."""
        changed = changed_ids(self.data)
        if not changed:
            return ()
        shown = ", ".join(f"{old!r} -> {new}" for old, new in changed[:4])
        more = ", ..." if len(changed) > 4 else ""
        return (problem("B210", self.place, changed=len(changed), shown=shown, rest=more),)

    def counts(self) -> Mapping[str, int]:
        """Return what ``show`` counts."""
        network = self.data
        return {
            "nodes": len(network.nodes),
            "edges": sum(len(node.parents) for node in network.nodes),
            "states": sum(len(node.states) for node in network.nodes),
            "parameters": sum(len(node.table) for node in network.nodes),
        }

    def outline(self) -> Sequence[str]:
        """Return the nodes with states and parents, then what inference costs."""
        network = self.data
        settings = self.settings
        bins = {
            declaration.node: declaration
            for declaration in settings.declarations
            if "bins" in declaration.data
        }
        lines = []
        for node in network.nodes:
            title = f" ({node.title})" if node.title != node.id else ""
            lines.append(f"{node.id}{title}: {', '.join(node.states)}")
            if node.parents:
                lines.append(f"  given {', '.join(node.parents)}")
            if node.id in bins:
                one = bins[node.id]
                edges = [*(f" | {edge:g} | " for edge in one.data["bins"]), ""]
                pairs = zip(one.data.get("order", node.states), edges, strict=True)
                lines.append(f"  from {one.input}: {''.join(map(''.join, pairs))}")
        if network.known:
            known = (f"{node} (event {event})" if event else node for node, event in network.known)
            lines.append(f"known: {', '.join(known)}")
        lines.append(f"outputs: {', '.join(settings.outputs)}")
        width = settings.width
        lines.append(
            "largest table of the inference, all nodes observable: "
            f"{in_digits(width.largest)} entries"
        )
        lines += [
            f"evidence {threshold.id}: {threshold.text()}" for threshold in settings.thresholds
        ]
        return lines

    def export(self) -> Mapping[str, str]:
        """Return the network as XDSL and as XMLBIF."""
        stem = re.sub(r"[^\w.-]", "_", self.name).lstrip(".") or NAME
        return {f"{stem}.xdsl": to_xdsl(self.data), f"{stem}.xmlbif": to_xmlbif(self.data)}

    def diagram(self) -> Diagram:
        return show.diagram(
            self.name, self.data, self.settings, configured=self.options is not None
        )

    def draft(self, options: Options) -> ModelDraft:
        return method_module.draft(self.data, options)

    def configure(self, options: Options) -> tuple[NetworkModel | None, list[Problem]]:
        settings, problems = read_options(self.data, options)
        if settings is None:
            return None, problems
        return replace(self, name=options.id or self.name, options=settings), problems

    def inputs(self) -> Sequence[ModelInput]:
        return self.settings.inputs

    def companion_messages(self) -> Mapping[str, str]:
        """Return the messages that the monitor publishes in addition to its output."""
        evidence = {"evidence": "BayesianNetworkEvidence"} if self.settings.thresholds else {}
        return {"status": "BayesianNetworkStatus", **evidence}

    def own_topics(self) -> Sequence[ModelOutput]:
        """Return the topics of thresholds that have one."""
        return [
            ModelOutput(
                threshold.id,
                threshold.topic,
                ("evidence", ("id", threshold.id), "active"),
                threshold.place,
                "evidence",
            )
            for threshold in self.settings.thresholds
            if threshold.topic is not None
        ]

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        """Return the thresholds, the titles of the outputs, and the outcomes of each."""
        settings = self.settings
        nodes = {node.id: node for node in self.data.nodes}
        outputs = [nodes[name] for name in settings.outputs]
        return {
            "evidence": [threshold.id for threshold in settings.thresholds],
            "output_nodes": [node.title for node in outputs],
            **{f"output_nodes[{node.title}].outcomes": node.states for node in outputs},
        }

    def editable_modules(self) -> Sequence[EditableModule]:
        return (method_module.config_module(self.data, self.settings),)

    def readme(self) -> Sequence[str]:
        """Return the text about the network for the package's README."""
        settings = self.settings
        width = settings.width
        observed = (
            ", ".join(f"`{markdown_code(name)}`" for name in settings.observed)
            or "none (write the methods)"
        )
        outputs = ", ".join(f"`{markdown_code(name)}`" for name in settings.outputs)
        text = (
            f"Outputs: {outputs}. Observed by declaration: {observed}. A missing input leaves its "
            "node unobserved; the posterior is exact for what is known."
        )
        return (
            "## Network",
            "",
            text,
            "",
            f"The largest table of the inference has {in_digits(width.largest)} entries.",
            *_evidence(settings.thresholds),
        )

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_network(self.data, self.settings, declaration)

    def cross_check(self, running: Callable[[], Any]) -> CrossCheck:
        return cross_check.cross_check(self.data, self.settings, running)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        return evidence_claims.claims(self.settings, inputs, frequency)

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        return evidence_claims.acceptances(self.settings, inputs, frequency)

    def elements(self) -> Sequence[Element]:
        """Return the nodes, then the thresholds."""
        return [
            *(
                Element("node", node.id, None, node.place.line, node.place.path)
                for node in self.data.nodes
            ),
            *(Element("threshold", threshold.id) for threshold in self.settings.thresholds),
        ]


def _read_xml(source: Source, suffix: str) -> tuple[Network | None, list[Problem]]:
    is_bif = suffix != ".xdsl" and b"<BIF" in source.data[:65536]
    clean, problems = without_doctype(source) if is_bif else (source, [])
    with clean.open() as stream:
        tree, found = load(stream, source.name)
    problems = problems or found
    if tree is None:
        return None, problems
    is_xmlbif = is_bif or suffix in (".xmlbif", ".bifxml")
    network, more = (read_xmlbif if is_xmlbif else read_xdsl)(
        tree.document, source.name, source.stem
    )
    return network, [*problems, *more]


def _evidence(thresholds: Sequence[Threshold]) -> Sequence[str]:
    """Return the text about the evidence for the package's README."""
    if not thresholds:
        return ()
    text = (
        "Evidence holds for every state that unknown inputs may have; of what is not known, only a "
        "prior that the configuration accepts by name counts. The posteriors themselves are no "
        "evidence. After a step in Python, `EDDIMonitor.monitor.claims()` returns it."
    )
    rows = [f"| `{threshold.id}` | {threshold.text()} |" for threshold in thresholds]
    return ("", text, "", "| evidence | active while |", "|---|---|", *rows)
