"""The class ``Monitor`` of a Bayesian network, and before it the tables and steps of its parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence

from eddi_scaffold.kinds.bayesian_network.clique_tree import EVIDENCE, TABLE
from eddi_scaffold.kinds.bayesian_network.inference_plan import (
    WIDE,
    Part,
    Program,
    everything,
    foreseen,
)
from eddi_scaffold.kinds.bayesian_network.joint_tables import JointTable, priors_of
from eddi_scaffold.kinds.bayesian_network.message_passing import Plan
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
from eddi_scaffold.kinds.bayesian_network.steps import Steps
from eddi_scaffold.kinds.bayesian_network.structure import NumberedNetwork, bits, numbered
from eddi_scaffold.kinds.bayesian_network.table_text import look_up_lines, sum_lines, total_lines
from eddi_scaffold.kinds.bayesian_network.thresholds import Threshold
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)
from eddi_scaffold.program.python_text import (
    Group,
    Item,
    assignment,
    call,
    comment,
    literal,
    number,
    numbers,
    returned,
    text_literal,
    tuple_of,
    unpacked,
)
from eddi_scaffold.program.python_text import Part as Text

FORMAT = 3
MODULES = (
    "claims", "direct", "explain", "memory", "patterns", "readers", "schedule", "tables",
    "threshold_monitor",
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
    number_of = {name: k for k, name in enumerate(network.names())}
    outputs = [number_of[node] for node in options.inferred]
    observed = [number_of[node] for node in options.observable]
    program = foreseen(numbered(network), outputs, observed)
    return CompiledMonitor(FORMAT, monitor_lines(network, options, declaration, program), MODULES)


def monitor_lines(
    network: Network, options: NetworkOptions, declaration: Declaration, program: Program
) -> list[str]:
    """Return the lines of the class, and of what it uses, for a program."""
    by_number = numbered(network)
    module = _Module(by_number)
    main = module.program(program, "", loop=False)
    for_any_node = everything(by_number, program)
    general = None if for_any_node is None else module.program(for_any_node, "all_", loop=True)
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["threshold_monitor.ThresholdMonitor"] if options.thresholds else []
    specs = []
    for k, (node, attribute) in enumerate(zip(network.nodes, by_number.attributes, strict=True)):
        fields = [text_literal(node.id), literal(node.states), text_literal(attribute)]
        above = f"{k} {comment(node.place.path or '')}".rstrip()
        specs.append(Item(call(f"{_ROOM}.NodeSpec", fields), above=above))
    given = tuple(k for k, name in enumerate(network.names()) if name in options.outputs)
    lines = [
        *module.lines(),
        *head_lines(", ".join(bases) or f"{_ROOM}.BayesianNetworkMonitor", declaration, {}),
        *assignment("nodes", tuple_of(specs), 4),
        *assignment("given", literal(given), 4),
        *assignment("foreseen", main, 4),
    ]
    if general is not None:
        lines += ["    # For nodes that only a person's method observes, or makes an output."]
        lines += assignment("everything", general, 4)
    if options.thresholds:
        thresholds = [_threshold(threshold, network) for threshold in options.thresholds]
        lines += assignment("thresholds", tuple_of(thresholds), 4)
    if not options.virtual:
        lines.append("    virtual = False")
    if options.on_inconsistent != "silent":
        lines.append(f"    on_inconsistent = {text_literal(options.on_inconsistent)}")
    return [*lines, *_source_lines(network, options, declaration)]


def _threshold(threshold: Threshold, network: Network) -> Text:
    states = network.node(threshold.node).states
    sign = -1.0 if threshold.at_least else 1.0
    node = str(network.names().index(threshold.node))
    summed = literal(tuple(states.index(state) for state in threshold.states))
    limits = [number(sign * threshold.limit), number(sign * threshold.release)]
    hold_ns = str(round(threshold.hold * 1e9))
    claim = call("claims.Threshold", [text_literal(threshold.id), *limits, hold_ns])
    return call("claims.StateThreshold", [node, summed, str(threshold.at_least), claim])


def _source_lines(
    network: Network, options: NetworkOptions, declaration: Declaration
) -> Iterator[str]:
    """Yield the lines on the inputs that feed nodes, by node.

    If the configuration names which nodes are observed, the others are left out.
    """
    positions = {input_.id: k for k, input_ in enumerate(declaration.inputs)}
    rows, reads = [], []
    for k, node in enumerate(network.nodes):
        input_id = options.input_of(node.id)
        if input_id is None or node.id not in options.observable:
            continue
        place = f"self.inputs[{positions[input_id]}]"
        entry = next((entry for entry in options.declarations if entry.node == node.id), None)
        reader: Text
        if entry is None:
            reader = call(
                "direct.DirectReader", [literal(node.states)], virtual=str(options.virtual)
            )
        else:
            arguments = entry.reader_arguments(node.states)
            texts = {key: literal(value) for key, value in arguments.items()}
            spec = call("readers.Declaration", [texts.pop("missing")], **texts)
            remembers = arguments.get("hysteresis", 0.0) > 0.0 or arguments.get("policy") == "hold"
            reader = call(
                "memory.Remembering" if remembers else "readers.Discretiser", [spec, place]
            )
        source = call(f"{_ROOM}.Source", [str(k), place, reader])
        rows.append(Item(source, above=comment(f"{node.id} from {input_id}")))
        reads.append(attribute_of("source", declaration.inputs[positions[input_id]].attribute))
    if rows:
        yield from ("", "    def sources(self):", *returned(tuple_of(rows), 8), "")
        yield from ("    def read(self, source):", "        try:")
        yield from returned(tuple_of(reads), 12)
        yield from ("        except Exception:", "            return super().read(source)")


class _Module:
    """What stands before the class: numbered by part, so that nothing of a model is a name."""

    def __init__(self, network: NumberedNetwork) -> None:
        self._network = network
        self._cards, self._names = network.shape.cards, network.shape.names
        self._blocks: list[list[str]] = []
        self._used: set[int] = set()

    def lines(self) -> list[str]:
        """Return the lines, with the tables of the nodes that schedules need before them."""
        blocks = list(self._blocks)
        if self._used:
            rows = tuple(self._node(node) for node in sorted(self._used))
            blocks.insert(0, assignment("nodes", Group("{", rows, "}"), 0))
        return [line for block in blocks for line in [*block, "", ""]]

    def program(self, program: Program, prefix: str, *, loop: bool) -> Text:
        """Return a program; its parts are written before the class."""
        is_short = not loop and program.is_short(self._cards)
        positions = {node: k for k, node in enumerate(program.observable)}
        names: dict[int, str] = {}
        for part in (*program.parts, *program.when_observed):
            if id(part) not in names:
                name = names[id(part)] = f"{prefix}part_{len(names)}"
                self._part(part, name, positions, is_short=is_short, loop=loop)
        further: dict[str, Text] = {}
        if program.when_observed != program.parts:
            further["when_observed"] = tuple_of(names[id(part)] for part in program.when_observed)
        if is_short:
            self._blocks.append(self._cases(program, f"{prefix}cases"))
            further["cases"] = f"{prefix}cases"
        return call(
            f"{_ROOM}.Program",
            [],
            outputs=literal(program.outputs),
            observable=literal(program.observable),
            parts=tuple_of(names[id(part)] for part in program.parts),
            **further,
        )

    def _comment(self, nodes: Iterable[int]) -> str:
        return comment(", ".join(self._names[node] for node in nodes))

    def _case_comment(self, nodes: Sequence[int], states: Sequence[int]) -> str:
        names = ([*self._network.states[node], "not known"] for node in nodes)
        return comment(", ".join(of[k] for of, k in zip(names, states, strict=True)))

    def _node(self, node: int) -> Item:
        card, table = self._cards[node], self._network.tables[node]
        parents = self._network.shape.parents[node]
        rows: Text
        if len(table) > _MANY:
            texts = [*map(number, table)]
            lines = (" ".join(texts[k : k + card]) for k in range(0, len(table), card))
            rows = call("schedule.rows_of", ['"""' + "\n".join(lines) + '"""'])
        else:
            cases = itertools.product(*(range(self._cards[parent]) for parent in parents))
            rows = tuple_of(
                Item(
                    numbers(table[k * card : (k + 1) * card]),
                    behind=self._case_comment(parents, case),
                )
                for k, case in enumerate(cases)
            )
        given = f" given {', '.join(self._names[parent] for parent in parents)}" if parents else ""
        above = comment(f"{self._names[node]}{given}")
        return Item(tuple_of([literal(parents), rows]), prefix=f"{node}: ", above=above)

    def _cases(self, program: Program, name: str) -> list[str]:
        rows = [
            Item(
                literal(posterior),
                prefix=f"({', '.join(map(str, case))}{',' if len(case) == 1 else ''}): ",
                behind=self._case_comment(program.observable, case),
            )
            for case, posterior in program.cases(self._cards)
        ]
        head = f"# Posteriors of {self._comment(program.outputs) or 'no node'}"
        return [head, *assignment(name, Group("{", tuple(rows), "}"), 0)]

    def _part(
        self, part: Part, name: str, positions: Mapping[int, int], *, is_short: bool, loop: bool
    ) -> None:
        component = part.plan.part
        if part.tables is None:
            inference = self._schedule(part, name, positions, loop=loop)
            if part.adapted is not None:
                inference = self._adapted(part.adapted, inference, f"{name}_adapted", positions)
        else:
            is_short = is_short or loop
            inference = self._tables(part.plan, part.tables, name, positions, is_short=is_short)
        fields: dict[str, Text] = {
            "inputs": literal(tuple(positions[node] for node in component.inputs)),
            "outputs": literal(component.outputs),
            "least": str(part.least),
        }
        head = f"# {self._comment(component.outputs) or 'evidence alone'}"
        text = assignment(name, call(f"{_ROOM}.Part", [inference], **fields), 0)
        self._blocks.append([head, *text])

    def _tables(
        self,
        plan: Plan,
        tables: Sequence[JointTable],
        name: str,
        positions: Mapping[int, int],
        *,
        is_short: bool,
    ) -> Text:
        texts, strides_of, above = [], [], []
        for k, table in enumerate(tables):
            own, strides = f"{name}_{k}", table.strides()
            pairs = [(positions[n], by) for n, by in zip(table.inputs, strides, strict=True)]
            output = "evidence alone" if table.output < 0 else self._names[table.output]
            inputs = [self._names[node] for node in table.inputs]
            strides_of.append(pairs)
            above.append(comment(f"{output} by {', '.join(inputs)}" if inputs else output))
            fields: dict[str, Text] = {}
            if not (is_short and table.few()):
                self._blocks.append(self._rows(table, output, f"{own}_rows"))
                fields["rows"] = f"{own}_rows"
            if table.few():
                counts, states = [count - 1 for count in table.counts], [output]
                if table.output >= 0:
                    of_output = self._network.states[table.output]
                    states = [comment(f"{output} = {state}") for state in of_output]
                axes = [*map(comment, inputs)]
                total = total_lines(f"{own}_total", table.rows, counts, strides, axes, states)
                self._blocks.append(total)
                fields["total"] = f"{own}_total"
            texts.append(call("tables.Table", [literal(tuple(pairs))], **fields))
        self._blocks.append(look_up_lines(f"{name}_look_up", strides_of, above))
        priors = tuple(
            Item(numbers(prior), prefix=f"{positions[node]}: ")
            for node, prior in priors_of(self._network, plan).items()
        )
        prior_of = Group("{", priors, "}")
        return call("tables.Tables", [tuple_of(texts), prior_of, f"{name}_look_up"])

    def _rows(self, table: JointTable, output: str, name: str) -> list[str]:
        cases = itertools.product(*map(range, table.counts))
        rows = (
            Item(numbers(row), behind=self._case_comment(table.inputs, case))
            for row, case in zip(table.rows, cases, strict=True)
        )
        return [f"# P({comment(output)}, evidence)", *assignment(name, tuple_of(rows), 0)]

    def _schedule(self, part: Part, name: str, positions: Mapping[int, int], *, loop: bool) -> Text:
        plan, program = part.plan, part.plan.program
        self._messages(plan, name)
        hard: Text = "None"
        if not loop and part.adapted is None:
            steps = Steps(program, self._cards, positions, look_up=True)
            hard = self._steps(steps, f"{name}_hard")
        full: Text = "None"
        if not plan.part.given:
            steps = Steps(program, self._cards, positions)
            full = self._loop(steps, f"{name}_full") if loop else self._steps(steps, f"{name}_full")
        edges = [*program.messages]
        answers = [program.answers[node] for node in plan.part.outputs] or program.evidence
        fields = [literal(tuple(map(edges.index, answers))), hard, full]
        return call("schedule.Schedule", ["nodes", f"{name}_messages", *fields])

    def _adapted(
        self, plan: Plan, otherwise: Text, name: str, positions: Mapping[int, int]
    ) -> Text:
        self._messages(plan, name)
        steps = Steps(plan.program, self._cards, positions, adapting=True)
        inputs = tuple(node for node in plan.part.inputs if node not in plan.part.outputs)
        fields = [f"{name}_messages", self._loop(steps, name), literal(inputs), str(WIDE)]
        return call("patterns.Adapted", [otherwise, *fields])

    def _messages(self, plan: Plan, name: str) -> None:
        """Write the messages of a plan, for which the runtime makes arrays."""
        for node in plan.part.nodes:
            self._used.update(self._network.shape.family(node))
        program, number_of = plan.program, {}
        in_tables = {leaf.node for leaf in plan.tree.leaves if leaf.kind == TABLE}
        rows = []
        for k, (edge, message) in enumerate(program.messages.items()):
            number_of[edge] = k
            parts = tuple(number_of[part] for part in message.parts)
            kind = message.kind or "product"
            if kind in (TABLE, EVIDENCE):
                leaf = plan.tree.leaves[message.leaf]
                if kind == TABLE:
                    parts = (leaf.node,)
                elif leaf.node not in in_tables:
                    kind = "prior"
            is_known = not message.inputs or edge in program.tabulated or not message.parts
            seen = message.inputs & ~message.mask if kind == TABLE else message.inputs
            nodes, inputs = tuple(bits(message.mask)), tuple(bits(seen)) if is_known else ()
            row = literal((kind, parts, nodes, inputs, is_known))
            rows.append(Item(row, behind=f"{k} {self._comment(nodes)}".rstrip()))
        text = assignment(f"{name}_messages", tuple_of(rows), 0)
        self._blocks.append(["# Kind, parts, nodes, inputs, known.", *text])

    def _slots(self, steps: Steps, name: str) -> None:
        pairs = zip(steps.slots, steps.names, strict=True)
        rows = tuple_of(Item(literal(row), behind=slot) for row, slot in pairs)
        self._blocks.append(assignment(f"{name}_slots", rows, 0))

    def _steps(self, steps: Steps, name: str) -> Text:
        self._slots(steps, name)
        functions = dict.fromkeys(operation.function for operation in steps.operations)
        if any("dot(" in row for row in steps.rows):
            functions["dot"] = None
        lines = [f"    {function} = numpy.{function}" for function in functions]
        lines += unpacked(steps.names, "slots", 4)
        lines = [f"def {name}(numpy, slots):", *lines, *([""] if lines else [])]
        lines.append("    def step(s):")
        for case, terms in steps.cases.items():
            lines += sum_lines(case, [f"s[{position}] * {by}" for position, by in terms], 8)
        for operation in steps.operations:
            line = f"        {operation.function}({', '.join(operation.operands)})"
            lines.append(f"{line}  # {self._comment(operation.nodes)}".rstrip(" #"))
        lines += returned(Group("[", tuple(map(Item, steps.rows)), "]"), 8)
        self._blocks.append([*lines, "", "    return step"])
        return call("schedule.Steps", [f"{name}_slots", name])

    def _loop(self, steps: Steps, name: str) -> Text:
        """Write the operations of a step as a table, which the runtime runs through."""
        self._slots(steps, name)
        rows = []
        for operation in steps.operations:
            operands = (int(text[1:]) for text in operation.operands)
            row = literal((operation.message, operation.function, *operands))
            rows.append(Item(row, behind=self._comment(operation.nodes)))
        self._blocks.append(assignment(f"{name}_operations", tuple_of(rows), 0))
        answers = tuple(int(row.partition(".")[0][1:]) for row in steps.rows)
        return call(
            "schedule.Steps",
            [f"{name}_slots"],
            operations=f"{name}_operations",
            answers=literal(answers),
        )
