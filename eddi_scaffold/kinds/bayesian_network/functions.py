"""What is done with Bayesian networks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath

from eddi_scaffold.common.claims import Element
from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, in_order, problem
from eddi_scaffold.compiling.monitor import CompiledMonitor, Declaration
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.eddi_xml.reading import recognises as is_xml
from eddi_scaffold.kinds import (
    EditableModule,
    Functions,
    ModelInput,
    ModelOutput,
    ReadResult,
)
from eddi_scaffold.kinds.bayesian_network.claims import (
    MEANINGS,
    acceptances,
    claims,
)
from eddi_scaffold.kinds.bayesian_network.compile import compile_network
from eddi_scaffold.kinds.bayesian_network.cross_check import cross_check
from eddi_scaffold.kinds.bayesian_network.lint import is_config_module, lint
from eddi_scaffold.kinds.bayesian_network.method_module import config_module, skeleton
from eddi_scaffold.kinds.bayesian_network.network import (
    Network,
    in_digits,
)
from eddi_scaffold.kinds.bayesian_network.options import NetworkModel, configure, settings_of
from eddi_scaffold.kinds.bayesian_network.read_bif import read_bif
from eddi_scaffold.kinds.bayesian_network.read_eddi import read_eddi as eddi_networks
from eddi_scaffold.kinds.bayesian_network.read_xdsl import read_xdsl
from eddi_scaffold.kinds.bayesian_network.read_xmlbif import read_xmlbif, without_doctype
from eddi_scaffold.kinds.bayesian_network.show import diagram
from eddi_scaffold.kinds.bayesian_network.thresholds import Threshold
from eddi_scaffold.kinds.bayesian_network.write import changed_ids, to_xdsl, to_xmlbif

NAME = "bayesian_network"


def read_eddi(document: EddiDocument, source: Source, _marks: Sequence[str]) -> ReadResult:
    """Read the networks of an EDDI."""
    networks, problems = eddi_networks(document, source)
    return _reading(networks, problems, source)


def read_file(source: Source, _marks: Sequence[str]) -> ReadResult:
    """Read a network by itself, or look at a module of hand-written methods."""
    if is_config_module(source.name):
        return ReadResult((), tuple(in_order(lint(source))))
    suffix = PurePath(source.name).suffix.lower()
    if suffix == ".bif" and not is_xml(source):
        network, problems = read_bif(source)
    else:
        network, problems = _read_xml(source, suffix)
    reading = _reading([network] if network is not None else [], problems, source)
    # GeNIe calls every network the same, until somebody changes that
    named = (replace(model, file_stem=source.stem) for model in reading.models)
    return replace(reading, models=tuple(named))


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


def _reading(
    networks: Sequence[Network], problems: Sequence[Problem], source: Source
) -> ReadResult:
    models = [
        NetworkModel(NAME, network.name, network, source, network.place) for network in networks
    ]
    return ReadResult(tuple(models), tuple(in_order(problems)))


def check(model: NetworkModel) -> Sequence[Problem]:
    """Return what the readers do not see: names that an export must change."""
    changed = changed_ids(model.data)
    if not changed:
        return ()
    shown = ", ".join(f"{old!r} -> {new}" for old, new in changed[:4])
    more = ", ..." if len(changed) > 4 else ""
    return (problem("B210", model.place, changed=len(changed), shown=shown, rest=more),)


def counts(model: NetworkModel) -> Mapping[str, int]:
    """Return what ``show`` counts."""
    network = model.data
    return {
        "nodes": len(network.nodes),
        "edges": sum(len(node.parents) for node in network.nodes),
        "states": sum(len(node.states) for node in network.nodes),
        "parameters": sum(len(node.table) for node in network.nodes),
    }


def outline(model: NetworkModel) -> Sequence[str]:
    """Return the nodes with states and parents, then what inference costs."""
    network = model.data
    settings = settings_of(model)
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
        f"largest table of the inference, all nodes observable: {in_digits(width.largest)} entries"
    )
    lines += [f"evidence {threshold.id}: {threshold.text()}" for threshold in settings.thresholds]
    return lines


def export(model: NetworkModel) -> Mapping[str, str]:
    """Return the network as XDSL and as XMLBIF."""
    stem = re.sub(r"[^\w.-]", "_", model.name).lstrip(".") or NAME
    return {f"{stem}.xdsl": to_xdsl(model.data), f"{stem}.xmlbif": to_xmlbif(model.data)}


def inputs(model: NetworkModel) -> Sequence[ModelInput]:
    """Return what the monitor reads."""
    return settings_of(model).inputs


def elements(model: NetworkModel) -> Sequence[Element]:
    """Return the nodes, then the thresholds."""
    return [
        *(
            Element("node", node.id, None, node.place.line, node.place.path)
            for node in model.data.nodes
        ),
        *(Element("threshold", threshold.id) for threshold in settings_of(model).thresholds),
    ]


def beside(model: NetworkModel) -> Mapping[str, str]:
    """Return the messages that the monitor publishes in addition to its output."""
    evidence = {"evidence": "BayesianNetworkEvidence"} if settings_of(model).thresholds else {}
    return {"status": "BayesianNetworkStatus", **evidence}


def outputs(model: NetworkModel) -> Sequence[ModelOutput]:
    """Return the topics of thresholds that have one."""
    return [
        ModelOutput(
            threshold.id,
            threshold.topic,
            ("evidence", ("id", threshold.id), "active"),
            threshold.place,
            "evidence",
        )
        for threshold in settings_of(model).thresholds
        if threshold.topic is not None
    ]


def ids(model: NetworkModel) -> Mapping[str, Sequence[str]]:
    """Return the thresholds, the titles of the outputs, and the outcomes of each."""
    settings = settings_of(model)
    nodes = {node.id: node for node in model.data.nodes}
    outputs = [nodes[name] for name in settings.outputs]
    return {
        "evidence": [threshold.id for threshold in settings.thresholds],
        "output_nodes": [node.title for node in outputs],
        **{f"output_nodes[{node.title}].outcomes": node.states for node in outputs},
    }


def modules(model: NetworkModel) -> Sequence[EditableModule]:
    """Return the module in which people write."""
    return (config_module(model),)


def readme(model: NetworkModel) -> Sequence[str]:
    """Return the text about the network for the package's README."""
    settings = settings_of(model)
    width = settings.width
    observed = (
        ", ".join(f"`{markdown_code(name)}`" for name in settings.observed)
        or "none (write the methods)"
    )
    outputs = ", ".join(f"`{markdown_code(name)}`" for name in settings.outputs)
    text = (
        f"Outputs: {outputs}. Observed by declaration: {observed}. A missing input leaves its node "
        "unobserved; the posterior is exact for what is known."
    )
    return (
        "## Network",
        "",
        text,
        "",
        f"The largest table of the inference has {in_digits(width.largest)} entries.",
        *_evidence(settings.thresholds),
    )


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


def compile_model(model: NetworkModel, declaration: Declaration) -> CompiledMonitor:
    """Return the compiled monitor."""
    return compile_network(model.data, settings_of(model), declaration)


FUNCTIONS = Functions(
    read_eddi=read_eddi,
    read_file=read_file,
    check=check,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    beside=beside,
    configure=configure,
    modules=modules,
    cross_check=cross_check,
    readme=readme,
    diagram=diagram,
    outputs=outputs,
    ids=ids,
    elements=elements,
    skeleton=skeleton,
    compile=compile_model,
    claims=claims,
    acceptances=acceptances,
    field_meanings=lambda _claims: MEANINGS,
)
