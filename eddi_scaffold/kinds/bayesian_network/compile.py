"""The class ``Monitor`` of a Bayesian network, and before it the tables and steps of its parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

from eddi_runtime.bayesian_network.readers import Declaration as Declared

from eddi_scaffold.kinds.bayesian_network.clique_tree import EVIDENCE, TABLE
from eddi_scaffold.kinds.bayesian_network.inference_plan import (
    Part,
    Program,
    everything,
    foreseen,
)
from eddi_scaffold.kinds.bayesian_network.joint_tables import (
    JointTable,
    look_up_lines,
    priors_of,
    sum_lines,
    total_lines,
)
from eddi_scaffold.kinds.bayesian_network.message_passing import Plan
from eddi_scaffold.kinds.bayesian_network.network import Network, NumberedNetwork, bits, numbered
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
from eddi_scaffold.kinds.bayesian_network.steps import Steps
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)

FORMAT = 3
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
    main = _ProgramText(module, program, "", loop=False).text
    for_any_node = everything(by_number, program)
    general = None
    if for_any_node is not None:
        general = _ProgramText(module, for_any_node, "all_", loop=True).text
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["claims.ThresholdMonitor"] if options.thresholds else []
    specs = []
    for k, (node, attribute) in enumerate(zip(network.nodes, by_number.attributes, strict=True)):
        fields = [py.text_literal(node.id), py.literal(node.states), py.text_literal(attribute)]
        above = f"{k} {py.comment(node.place.path or '')}".rstrip()
        specs.append(py.Item(py.call(f"{_ROOM}.NodeSpec", fields), above=above))
    outputs = tuple(k for k, name in enumerate(network.names()) if name in options.outputs)
    lines = [
        *module.lines(),
        *head_lines(", ".join(bases) or f"{_ROOM}.BayesianNetworkMonitor", declaration, {}),
        *py.assignment("nodes", py.tuple_of(specs), 4),
        *py.assignment("given", py.literal(outputs), 4),
        *py.assignment("foreseen", main, 4),
    ]
    if general is not None:
        lines += ["    # For nodes that only a person's method observes, or makes an output."]
        lines += py.assignment("everything", general, 4)
    if options.thresholds:
        thresholds = []
        for threshold in options.thresholds:
            states = network.node(threshold.node).states
            sign = -1.0 if threshold.at_least else 1.0
            limits = [py.number(sign * limit) for limit in (threshold.limit, threshold.release)]
            hold_ns = str(round(threshold.hold * 1e9))
            claim = py.call("claims.Threshold", [py.text_literal(threshold.id), *limits, hold_ns])
            summed = py.literal(tuple(states.index(state) for state in threshold.states))
            number = str(network.names().index(threshold.node))
            fields = [number, summed, str(threshold.at_least), claim]
            thresholds.append(py.call("claims.StateThreshold", fields))
        lines += py.assignment("thresholds", py.tuple_of(thresholds), 4)
    if not options.virtual:
        lines.append("    virtual = False")
    if options.on_inconsistent != "silent":
        lines.append(f"    on_inconsistent = {py.text_literal(options.on_inconsistent)}")
    return [*lines, *_source_lines(network, options, declaration)]


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

    def __init__(self, network: NumberedNetwork) -> None:
        self.network, self.cards, self.names = network, network.shape.cards, network.shape.names
        self.blocks: list[list[str]] = []
        self.used: set[int] = set()

    def lines(self) -> list[str]:
        """Return the lines, with the tables of the nodes that schedules need before them."""
        blocks = list(self.blocks)
        if self.used:
            rows = tuple(self._node(node) for node in sorted(self.used))
            blocks.insert(0, py.assignment("nodes", py.Group("{", rows, "}"), 0))
        return [line for block in blocks for line in [*block, "", ""]]

    def comment(self, nodes: Iterable[int]) -> str:
        """Return the names of nodes."""
        return py.comment(", ".join(self.names[node] for node in nodes))

    def case_comment(self, nodes: Sequence[int], states: Sequence[int]) -> str:
        """Return the names of states of nodes."""
        names = ([*self.network.states[node], "not known"] for node in nodes)
        return py.comment(", ".join(of[k] for of, k in zip(names, states, strict=True)))

    def _node(self, node: int) -> py.Item:
        card, table = self.cards[node], self.network.tables[node]
        parents = self.network.shape.parents[node]
        starts = range(0, len(table), card)
        rows: py.Part
        if len(table) > _MANY:
            texts = [*map(py.number, table)]
            lines = (" ".join(texts[k : k + card]) for k in starts)
            rows = py.call("schedule.rows_of", ['"""' + "\n".join(lines) + '"""'])
        else:
            cases = itertools.product(*(range(self.cards[parent]) for parent in parents))
            rows = py.tuple_of(
                py.Item(py.numbers(table[k : k + card]), behind=self.case_comment(parents, case))
                for k, case in zip(starts, cases, strict=True)
            )
        condition = (
            f" given {', '.join(self.names[parent] for parent in parents)}" if parents else ""
        )
        above = py.comment(f"{self.names[node]}{condition}")
        return py.Item(py.tuple_of([py.literal(parents), rows]), prefix=f"{node}: ", above=above)


class _ProgramText:
    """A program as text; its parts, whose names begin with a prefix, are written before the class.

    In a loop, steps are tables that the runtime runs through, not functions.
    """

    def __init__(self, module: _Module, program: Program, prefix: str, *, loop: bool) -> None:
        self._module, self._network, self._cards = module, module.network, module.cards
        self._blocks, self._program, self._loops = module.blocks, program, loop
        self._positions = {node: k for k, node in enumerate(program.observable)}
        is_short = not loop and program.is_short(self._cards)
        self._is_brief = is_short or loop
        names: dict[int, str] = {}
        for part in (*program.parts, *program.when_observed):
            if id(part) not in names:
                name = names[id(part)] = f"{prefix}part_{len(names)}"
                self._part(part, name)
        fields: dict[str, py.Part] = {
            "outputs": py.literal(program.outputs),
            "observable": py.literal(program.observable),
            "parts": py.tuple_of(names[id(part)] for part in program.parts),
        }
        if program.when_observed != program.parts:
            fields["when_observed"] = py.tuple_of(names[id(part)] for part in program.when_observed)
        if is_short:
            self._cases(f"{prefix}cases")
            fields["cases"] = f"{prefix}cases"
        self.text = py.call(f"{_ROOM}.Program", [], **fields)

    def _write(self, head: str, name: str, part: py.Part) -> None:
        self._blocks.append([*([f"# {head}"] if head else []), *py.assignment(name, part, 0)])

    def _cases(self, name: str) -> None:
        program = self._program
        rows = [
            py.Item(
                py.literal(posterior),
                prefix=f"({', '.join(map(str, case))}{',' if len(case) == 1 else ''}): ",
                behind=self._module.case_comment(program.observable, case),
            )
            for case, posterior in program.cases(self._cards)
        ]
        head = f"Posteriors of {self._module.comment(program.outputs) or 'no node'}"
        self._write(head, name, py.Group("{", tuple(rows), "}"))

    def _part(self, part: Part, name: str) -> None:
        component = part.plan.part
        if part.tables is not None:
            inference = self._tables(part.plan, part.tables, name)
        else:
            inference = self._schedule(part.plan, name)
        fields: dict[str, py.Part] = {
            "inputs": py.literal(tuple(self._positions[node] for node in component.inputs)),
            "outputs": py.literal(component.outputs),
            "least": str(part.least),
        }
        head = self._module.comment(component.outputs) or "evidence alone"
        self._write(head, name, py.call(f"{_ROOM}.Part", [inference], **fields))

    def _tables(self, plan: Plan, tables: Sequence[JointTable], name: str) -> py.Part:
        texts, strides_of, above = [], [], []
        for k, table in enumerate(tables):
            own, strides = f"{name}_{k}", table.strides()
            pairs = [(self._positions[n], by) for n, by in zip(table.inputs, strides, strict=True)]
            output = "evidence alone" if table.output < 0 else self._module.names[table.output]
            inputs = [self._module.names[node] for node in table.inputs]
            strides_of.append(pairs)
            above.append(py.comment(f"{output} by {', '.join(inputs)}" if inputs else output))
            fields: dict[str, py.Part] = {}
            if not (self._is_brief and table.few()):
                self._rows(table, output, f"{own}_rows")
                fields["rows"] = f"{own}_rows"
            if table.few():
                counts, states = [count - 1 for count in table.counts], [output]
                if table.output >= 0:
                    of_output = self._network.states[table.output]
                    states = [py.comment(f"{output} = {state}") for state in of_output]
                axes = [*map(py.comment, inputs)]
                total = total_lines(f"{own}_total", table.rows, counts, strides, axes, states)
                self._blocks.append(total)
                fields["total"] = f"{own}_total"
            texts.append(py.call("tables.Table", [py.literal(tuple(pairs))], **fields))
        self._blocks.append(look_up_lines(f"{name}_look_up", strides_of, above))
        priors = tuple(
            py.Item(py.numbers(prior), prefix=f"{self._positions[node]}: ")
            for node, prior in priors_of(self._network, plan).items()
        )
        prior_of = py.Group("{", priors, "}")
        return py.call("tables.Tables", [py.tuple_of(texts), prior_of, f"{name}_look_up"])

    def _rows(self, table: JointTable, output: str, name: str) -> None:
        cases = itertools.product(*map(range, table.counts))
        rows = py.tuple_of(
            py.Item(py.numbers(row), behind=self._module.case_comment(table.inputs, case))
            for row, case in zip(table.rows, cases, strict=True)
        )
        self._write(f"P({py.comment(output)}, evidence)", name, rows)

    def _schedule(self, plan: Plan, name: str) -> py.Part:
        program = plan.program
        self._messages(plan, name)
        hard: py.Part = "None"
        full: py.Part = "None"
        if not self._loops:
            steps = Steps(program, self._cards, self._positions, look_up=True)
            hard = self._steps(steps, f"{name}_hard")
        if not plan.part.always_observed:
            steps = Steps(program, self._cards, self._positions)
            full = (self._loop if self._loops else self._steps)(steps, f"{name}_full")
        edges = [*program.messages]
        answers = [program.answers[node] for node in plan.part.outputs] or program.evidence
        fields = [py.literal(tuple(map(edges.index, answers))), hard, full]
        return py.call("schedule.Schedule", ["nodes", f"{name}_messages", *fields])

    def _messages(self, plan: Plan, name: str) -> None:
        """Write the messages of a plan, for which the runtime makes arrays."""
        for node in plan.part.nodes:
            self._module.used.update(self._network.shape.family(node))
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
            row = py.literal((kind, parts, nodes, inputs, is_known))
            rows.append(py.Item(row, behind=f"{k} {self._module.comment(nodes)}".rstrip()))
        self._write("Kind, parts, nodes, inputs, known.", f"{name}_messages", py.tuple_of(rows))

    def _slots(self, steps: Steps, name: str) -> None:
        pairs = zip(steps.slots, steps.names, strict=True)
        rows = py.tuple_of(py.Item(py.literal(row), behind=slot) for row, slot in pairs)
        self._write("", f"{name}_slots", rows)

    def _steps(self, steps: Steps, name: str) -> py.Part:
        self._slots(steps, name)
        functions = dict.fromkeys(operation.function for operation in steps.operations)
        if any("dot(" in row for row in steps.rows):
            functions["dot"] = None
        lines = [f"    {function} = numpy.{function}" for function in functions]
        lines += py.unpacked(steps.names, "slots", 4)
        lines = [f"def {name}(numpy, slots):", *lines, *([""] if lines else [])]
        lines.append("    def step(s):")
        for case, terms in steps.cases.items():
            lines += sum_lines(case, [f"s[{position}] * {by}" for position, by in terms], 8)
        for operation in steps.operations:
            line = f"        {operation.function}({', '.join(operation.operands)})"
            lines.append(f"{line}  # {self._module.comment(operation.nodes)}".rstrip(" #"))
        lines += py.returned(py.Group("[", tuple(map(py.Item, steps.rows)), "]"), 8)
        self._blocks.append([*lines, "", "    return step"])
        return py.call("schedule.Steps", [f"{name}_slots", name])

    def _loop(self, steps: Steps, name: str) -> py.Part:
        self._slots(steps, name)
        rows = []
        for operation in steps.operations:
            operands = (int(text[1:]) for text in operation.operands)
            row = py.literal((operation.message, operation.function, *operands))
            rows.append(py.Item(row, behind=self._module.comment(operation.nodes)))
        self._write("", f"{name}_operations", py.tuple_of(rows))
        answers = py.literal(tuple(int(row.partition(".")[0][1:]) for row in steps.rows))
        fields = {"operations": f"{name}_operations", "answers": answers}
        return py.call("schedule.Steps", [f"{name}_slots"], **fields)
