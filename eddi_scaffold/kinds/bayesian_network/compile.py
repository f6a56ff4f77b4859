"""The class ``Monitor`` of a Bayesian network, and before it the tables and steps of its parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

from eddi_runtime.bayesian_network.readers import Declaration as Declared

from eddi_scaffold.kinds.bayesian_network.clique_tree import TABLE
from eddi_scaffold.kinds.bayesian_network.inference_plan import Part, parts_of
from eddi_scaffold.kinds.bayesian_network.joint_tables import priors_of
from eddi_scaffold.kinds.bayesian_network.message_passing import Edge
from eddi_scaffold.kinds.bayesian_network.network import (
    Network,
    NumberedNetwork,
    bits,
    node_attributes,
    numbered,
)
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)

FORMAT = 4
MODULES = (
    "claims", "direct", "explain", "memory", "readers", "schedule", "tables",
)  # fmt: skip
"""Modules of the runtime's part, of which a package has those that its monitor uses."""
_ROOM = "bayesian_network"
_MANY = 2_000
"""Numbers of a table up to which each row is a tuple with its case behind it.

More would take Python seconds, and hundreds of megabytes, to import.
"""


def compile_network(
    network: Network, options: NetworkOptions, declaration: Declaration
) -> CompiledMonitor:
    """Return the compiled monitor of a network that is not too wide for its options."""
    node_names, by_number = network.names(), numbered(network)
    outputs, observable, given = (
        tuple(k for k, name in enumerate(node_names) if name in group)
        for group in (options.inferred, options.observable, options.outputs)
    )
    module = _Module(by_number, observable)
    parts = {f"part_{k}": of for k, of in enumerate(parts_of(by_number, outputs, observable))}
    for name, part in parts.items():
        module.add(part, name)
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["claims.ThresholdMonitor"] if options.thresholds else []
    specs = []
    attributes = node_attributes(network)
    for k, node in enumerate(network.nodes):
        attribute = py.text_literal(attributes[node.id])
        fields = [py.text_literal(node.id), py.literal(node.states), attribute]
        above = f"{k} {py.comment(node.place.path or '')}".rstrip()
        specs.append(py.Item(py.call(f"{_ROOM}.NodeSpec", fields), above=above))
    program: dict[str, py.Part] = {
        "outputs": py.literal(outputs),
        "observable": py.literal(observable),
        "parts": py.tuple_of(parts),
    }
    lines = [
        *module.lines(),
        *head_lines(", ".join(bases) or f"{_ROOM}.BayesianNetworkMonitor", declaration, {}),
        *py.assignment("nodes", py.tuple_of(specs), 4),
        *py.assignment("given", py.literal(given), 4),
        *py.assignment("foreseen", py.call(f"{_ROOM}.Program", [], **program), 4),
    ]
    if options.thresholds:
        thresholds = []
        for threshold in options.thresholds:
            states = network.node(threshold.node).states
            sign = -1.0 if threshold.at_least else 1.0
            limits = [py.number(sign * limit) for limit in (threshold.limit, threshold.release)]
            hold_ns = str(round(threshold.hold * 1e9))
            claim = py.call("claims.Threshold", [py.text_literal(threshold.id), *limits, hold_ns])
            summed = py.literal(tuple(states.index(state) for state in threshold.states))
            number = str(node_names.index(threshold.node))
            fields = [number, summed, str(threshold.at_least), claim]
            thresholds.append(py.call("claims.StateThreshold", fields))
        lines += py.assignment("thresholds", py.tuple_of(thresholds), 4)
    if not options.virtual:
        lines.append("    virtual = False")
    if options.on_inconsistent != "silent":
        lines.append(f"    on_inconsistent = {py.text_literal(options.on_inconsistent)}")
    lines += _source_lines(network, options, declaration)
    return CompiledMonitor(FORMAT, lines, MODULES)


def _source_lines(
    network: Network, options: NetworkOptions, declaration: Declaration
) -> Iterator[str]:
    """Yield the lines on the inputs that feed nodes, by node."""
    positions = {input_.id: k for k, input_ in enumerate(declaration.inputs)}
    rows, reads = [], []
    for k, node in enumerate(network.nodes):
        input_id = options.input_of(node.id)
        if input_id is None:
            continue
        place = f"self.inputs[{positions[input_id]}]"
        entry = next((entry for entry in options.declarations if entry.node == node.id), None)
        reader: py.Part
        if entry is None:
            reader = py.call(
                "direct.DirectReader", [py.literal(node.states)], virtual=str(options.virtual)
            )
        else:
            usual = Declared(entry.reader.missing)._asdict()
            arguments = entry.reader._asdict().items()
            texts = {key: py.literal(value) for key, value in arguments if value != usual[key]}
            spec = py.call("readers.Declaration", [str(entry.reader.missing)], **texts)
            remembers = entry.reader.hysteresis > 0.0 or entry.reader.policy == "hold"
            reader = py.call(
                "memory.Remembering" if remembers else "readers.Discretiser", [spec, place]
            )
        source = py.call(f"{_ROOM}.Source", [str(k), place, reader])
        rows.append(py.Item(source, above=py.comment(f"{node.id} from {input_id}")))
        reads.append(attribute_of("source", declaration.inputs[positions[input_id]].attribute))
    if rows:
        yield from ("", "    def sources(self):", *py.returned(py.tuple_of(rows), 8), "")
        yield from ("    def read(self, source):", "        try:")
        yield from py.returned(py.tuple_of(reads), 12)
        yield from ("        except Exception:", "            return super().read(source)")


class _Module:
    """What stands before the class: numbered by part, so that nothing of a model is a name."""

    def __init__(self, network: NumberedNetwork, observable: Sequence[int]) -> None:
        self._network, self._positions = network, {node: k for k, node in enumerate(observable)}
        self._blocks: list[list[str]] = []
        self._used: set[int] = set()

    def lines(self) -> list[str]:
        """Return the lines, with the tables of the nodes of schedules before them."""
        blocks = list(self._blocks)
        if self._used:
            rows = tuple(self._node(node) for node in sorted(self._used))
            blocks.insert(0, py.assignment("nodes", py.Group("{", rows, "}"), 0))
        return [line for block in blocks for line in [*block, "", ""]]

    def add(self, part: Part, name: str) -> None:
        """Add a part: its tables, or its messages."""
        component = part.plan.part
        made = self._tables(part, name) if part.tables is not None else self._schedule(part, name)
        fields: dict[str, py.Part] = {
            "inputs": py.literal(tuple(self._positions[node] for node in component.inputs)),
            "outputs": py.literal(component.outputs),
            "least": str(part.least),
        }
        head = self._comment(component.outputs)
        self._write(head, name, py.call(f"{_ROOM}.Part", [made], **fields))

    def _write(self, head: str, name: str, part: py.Part) -> None:
        self._blocks.append([f"# {head}", *py.assignment(name, part, 0)])

    def _comment(self, nodes: Iterable[int]) -> str:
        return py.comment(", ".join(self._network.shape.names[node] for node in nodes))

    def _case_comment(self, nodes: Sequence[int], states: Sequence[int]) -> str:
        names = ([*self._network.states[node], "not known"] for node in nodes)
        return py.comment(", ".join(of[k] for of, k in zip(names, states, strict=True)))

    def _node(self, node: int) -> py.Item:
        card, table = self._network.shape.cards[node], self._network.tables[node]
        parents = self._network.shape.parents[node]
        starts = range(0, len(table), card)
        rows: py.Part
        if len(table) > _MANY:
            texts = [*map(py.number, table)]
            lines = (" ".join(texts[k : k + card]) for k in starts)
            rows = py.call("schedule.rows_of", ['"""' + "\n".join(lines) + '"""'])
        else:
            cases = itertools.product(*(range(self._network.shape.cards[of]) for of in parents))
            rows = py.tuple_of(
                py.Item(py.numbers(table[k : k + card]), behind=self._case_comment(parents, case))
                for k, case in zip(starts, cases, strict=True)
            )
        given = f" given {self._comment(parents)}" if parents else ""
        above = py.comment(f"{self._comment([node])}{given}")
        return py.Item(py.tuple_of([py.literal(parents), rows]), prefix=f"{node}: ", above=above)

    def _tables(self, part: Part, name: str) -> py.Part:
        texts = []
        for k, table in enumerate(part.tables or ()):
            cases = itertools.product(*map(range, table.counts))
            rows = py.tuple_of(
                py.Item(py.numbers(row), behind=self._case_comment(table.inputs, case))
                for row, case in zip(table.rows, cases, strict=True)
            )
            by = f" by {self._comment(table.inputs)}" if table.inputs else ""
            head = py.comment(f"P({self._comment([table.output])}, evidence){by}")
            self._write(head, f"{name}_{k}", rows)
            positions = tuple(self._positions[node] for node in table.inputs)
            texts.append(py.call("tables.Table", [py.literal(positions), f"{name}_{k}"]))
        priors = tuple(
            py.Item(py.numbers(prior), prefix=f"{self._positions[node]}: ")
            for node, prior in priors_of(self._network, part.plan).items()
        )
        return py.call("tables.Tables", [py.tuple_of(texts), py.Group("{", priors, "}")])

    def _schedule(self, part: Part, name: str) -> py.Part:
        """Write the messages of a part, for which the runtime makes arrays and operations."""
        plan = part.plan
        self._used.update(plan.part.nodes)
        number_of: dict[Edge, int] = {}
        rows: list[py.Item] = []
        for edge, message in plan.program.messages.items():
            if (same := plan.program.alias_of(message)) is not None:
                number_of[edge] = number_of[same]
                continue
            parts = tuple(sorted(number_of[of] for of in message.parts))
            parts = (message.node,) if message.kind == TABLE else parts
            is_known = not message.inputs or edge in plan.program.tabulated
            nodes, inputs = tuple(bits(message.mask)), tuple(bits(message.inputs))
            row = py.literal((message.kind, parts, nodes, inputs if is_known else (), is_known))
            number_of[edge] = len(rows)
            rows.append(py.Item(row, behind=f"{len(rows)} {self._comment(nodes)}"))
        self._write("Kind, parts, nodes, inputs, known.", f"{name}_messages", py.tuple_of(rows))
        answers = tuple(number_of[plan.program.answers[node]] for node in plan.part.outputs)
        return py.call("schedule.Schedule", ["nodes", f"{name}_messages", py.literal(answers)])
