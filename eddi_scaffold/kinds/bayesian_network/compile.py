"""The class ``Monitor`` of a Bayesian network, and before it the tables and steps of its parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from eddi_scaffold.kinds.bayesian_network.inference_plan import (
    Part,
    Program,
    cases_of,
    everything,
    few,
    foreseen,
)
from eddi_scaffold.kinds.bayesian_network.joint_tables import JointTable, priors_of
from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
from eddi_scaffold.kinds.bayesian_network.steps import Steps, answers_of, message_rows, steps_of
from eddi_scaffold.kinds.bayesian_network.structure import NumberedNetwork, numbered
from eddi_scaffold.kinds.bayesian_network.table_text import (
    look_up_lines,
    sum_lines,
    total_lines,
)
from eddi_scaffold.kinds.bayesian_network.thresholds import Threshold
from eddi_scaffold.kinds.bayesian_network.width import WIDE, Plan
from eddi_scaffold.program.input_expressions import BoundInput
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
    "claims",
    "direct",
    "explain",
    "memory",
    "patterns",
    "readers",
    "schedule",
    "tables",
    "threshold_monitor",
)
"""Modules of the runtime's part, of which a package has those that its monitor uses."""
_ROOM = "bayesian_network"
_MANY = 2_000
"""Numbers of a table up to which each row is a tuple with its case behind it.

More would take Python seconds, and hundreds of megabytes, to import.
"""


class Source(NamedTuple):
    """An input that feeds a node; without arguments of a reader it holds the state itself."""

    node: int
    position: int
    input: BoundInput
    arguments: Mapping[str, Any] | None


def compile_network(
    network: Network, options: NetworkOptions, declaration: Declaration
) -> CompiledMonitor:
    """Return the compiled monitor of a network that is not too wide for its options."""
    number_of = {name: k for k, name in enumerate(network.names())}
    outputs = [number_of[node] for node in options.inferred]
    observed = [number_of[node] for node in options.observable]
    program = foreseen(numbered(network), outputs, observed)
    lines = monitor_lines(network, options, declaration, program)
    return CompiledMonitor(FORMAT, lines, MODULES)


def monitor_lines(
    network: Network, options: NetworkOptions, declaration: Declaration, program: Program
) -> list[str]:
    """Return the lines of the class, and of what it uses, for a program."""
    numbers_of_network = numbered(network)
    number_of = {name: k for k, name in enumerate(network.names())}
    module = _Module(numbers_of_network)
    main = module.program(program, "", loop=False)
    further = everything(numbers_of_network, program)
    rest = None if further is None else module.program(further, "all_", loop=True)
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["threshold_monitor.ThresholdMonitor"] if options.thresholds else []
    rows = (
        Item(
            call(
                f"{_ROOM}.NodeSpec",
                [text_literal(node.id), literal(node.states), text_literal(attribute)],
            ),
            above=f"{k} {comment(node.place.path or '')}".rstrip(),
        )
        for k, (node, attribute) in enumerate(
            zip(network.nodes, numbers_of_network.attributes, strict=True)
        )
    )
    given = tuple(sorted({number_of[node] for node in options.outputs}))
    lines = [
        *module.lines(),
        *head_lines(", ".join(bases) or f"{_ROOM}.BayesianNetworkMonitor", declaration, {}),
        *assignment("nodes", tuple_of(rows), 4),
        *assignment("given", literal(given), 4),
        *assignment("foreseen", main, 4),
    ]
    if rest is not None:
        lines += ["    # For nodes that only a person's method observes, or makes an output."]
        lines += assignment("everything", rest, 4)
    if options.thresholds:
        thresholds = (_threshold(threshold, network) for threshold in options.thresholds)
        lines += assignment("thresholds", tuple_of(thresholds), 4)
    if not options.virtual:
        lines.append("    virtual = False")
    if options.on_inconsistent != "silent":
        lines.append(f"    on_inconsistent = {text_literal(options.on_inconsistent)}")
    sources = _sources(network, options, declaration)
    return [*lines, "", *_source_lines(network, options, sources)] if sources else lines


def _threshold(threshold: Threshold, network: Network) -> Text:
    states = network.node(threshold.node).states
    sign = -1.0 if threshold.at_least else 1.0
    limits = [
        text_literal(threshold.id),
        number(sign * threshold.limit),
        number(sign * threshold.release),
        str(round(threshold.hold * 1e9)),
    ]
    return call(
        "claims.StateThreshold",
        [
            str(network.names().index(threshold.node)),
            literal(tuple(states.index(state) for state in threshold.states)),
            str(threshold.at_least),
            call("claims.Threshold", limits),
        ],
    )


def _sources(network: Network, options: NetworkOptions, declaration: Declaration) -> list[Source]:
    """Return the inputs that feed nodes, by node; a discretisation goes before a direct way.

    If the configuration names which nodes are observed, the others are left out.
    """
    inputs = {input_.id: (k, input_) for k, input_ in enumerate(declaration.inputs)}
    entries = {entry.node: entry for entry in options.declarations}
    sources = []
    for k, node in enumerate(network.nodes):
        entry = entries.get(node.id)
        name = options.direct.get(node.id) if entry is None else entry.input
        if name is not None and node.id in options.observable:
            arguments = None if entry is None else entry.reader_arguments(node.states)
            sources.append(Source(k, *inputs[name], arguments))
    return sources


def _source_lines(
    network: Network, options: NetworkOptions, sources: Sequence[Source]
) -> list[str]:
    rows = (
        Item(
            call(
                f"{_ROOM}.Source",
                [
                    str(source.node),
                    f"self.inputs[{source.position}]",
                    _reader(network.nodes[source.node].states, source, virtual=options.virtual),
                ],
            ),
            above=comment(f"{network.nodes[source.node].id} from {source.input.id}"),
        )
        for source in sources
    )
    reads = tuple_of(attribute_of("source", source.input.attribute) for source in sources)
    return [
        "    def sources(self):",
        *returned(tuple_of(rows), 8),
        "",
        "    def read(self, source):",
        "        try:",
        *returned(reads, 12),
        "        except Exception:",
        "            return super().read(source)",
    ]


def _reader(states: Sequence[str], source: Source, *, virtual: bool) -> Text:
    arguments = source.arguments
    if arguments is None:
        return call("direct.DirectReader", [literal(states)], virtual=str(virtual))
    texts = {key: literal(value) for key, value in arguments.items()}
    declaration = call("readers.Declaration", [texts.pop("missing")], **texts)
    remembers = arguments.get("hysteresis", 0.0) > 0.0 or arguments.get("policy") == "hold"
    reader = "memory.Remembering" if remembers else "readers.Discretiser"
    return call(reader, [declaration, f"self.inputs[{source.position}]"])


class _Module:
    """What stands before the class: numbered by part, so that nothing of a model is a name."""

    def __init__(self, network: NumberedNetwork) -> None:
        self._network = network
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
        written = not loop and few(self._network.shape.cards, program)
        names: dict[int, str] = {}
        for part in (*program.parts, *program.when_observed):
            if id(part) not in names:
                names[id(part)] = f"{prefix}part_{len(names)}"
                self._part(part, program, names[id(part)], few=written, loop=loop)
        named: dict[str, Text] = {}
        if program.when_observed != program.parts:
            named["when_observed"] = tuple_of(names[id(part)] for part in program.when_observed)
        if written:
            self._blocks.append(self._cases(program, f"{prefix}cases"))
            named["cases"] = f"{prefix}cases"
        return call(
            f"{_ROOM}.Program",
            [],
            outputs=literal(program.outputs),
            observable=literal(program.observable),
            parts=tuple_of(names[id(part)] for part in program.parts),
            **named,
        )

    def _node(self, node: int) -> Item:
        network = self._network
        names, parents = network.shape.names, network.shape.parents[node]
        card, table = network.shape.cards[node], network.tables[node]
        cases = itertools.product(*(network.states[parent] for parent in parents))
        rows: Text
        if len(table) > _MANY:
            texts = [*map(number, table)]
            lines = (" ".join(texts[k : k + card]) for k in range(0, len(table), card))
            rows = call("schedule.rows_of", ['"""' + "\n".join(lines) + '"""'])
        else:
            rows = tuple_of(
                Item(numbers(table[k * card : (k + 1) * card]), behind=comment(", ".join(case)))
                for k, case in enumerate(cases)
            )
        given = f" given {', '.join(names[parent] for parent in parents)}" if parents else ""
        about = comment(f"{names[node]}{given}")
        return Item(tuple_of([literal(parents), rows]), prefix=f"{node}: ", above=about)

    def _cases(self, program: Program, name: str) -> list[str]:
        about = [self._state_names(node) for node in program.observable]
        rows = []
        for case, posterior in cases_of(self._network.shape.cards, program):
            part = literal(posterior)
            shown = ", ".join(names[state] for names, state in zip(about, case, strict=True))
            rows.append(
                Item(
                    part,
                    prefix=f"({', '.join(map(str, case))}{',' if len(case) == 1 else ''}): ",
                    behind=comment(shown),
                )
            )
        head = [f"# Posteriors of {comment(', '.join(self._names(program.outputs)) or 'no node')}"]
        return [*head, *assignment(name, Group("{", tuple(rows), "}"), 0)]

    def _names(self, nodes: Iterable[int]) -> list[str]:
        return [self._network.shape.names[node] for node in nodes]

    def _state_names(self, node: int) -> list[str]:
        return [*self._network.states[node], "not known"]

    def _part(self, part: Part, program: Program, name: str, *, few: bool, loop: bool) -> None:
        positions = {node: k for k, node in enumerate(program.observable)}
        component = part.plan.part
        if part.tables is None:
            made = self._schedule(part, name, positions, loop=loop)
            if part.adapted is not None:
                made = self._adapted(part.adapted, made, f"{name}_adapted", positions)
        else:
            made = self._tables(part, part.tables, name, positions, few=few or loop)
        inputs = tuple(positions[node] for node in component.inputs)
        named: dict[str, Text] = {
            "inputs": literal(inputs),
            "outputs": literal(component.outputs),
            "least": str(part.least),
        }
        about = [f"# {comment(', '.join(self._names(component.outputs)) or 'evidence alone')}"]
        self._blocks.append([*about, *assignment(name, call(f"{_ROOM}.Part", [made], **named), 0)])

    def _tables(
        self,
        part: Part,
        tables: Sequence[JointTable],
        name: str,
        positions: Mapping[int, int],
        *,
        few: bool,
    ) -> Text:
        found = []
        strides_of: list[list[tuple[int, int]]] = []
        for k, table in enumerate(tables):
            strides = table.strides()
            pairs = [(positions[n], by) for n, by in zip(table.inputs, strides, strict=True)]
            named: dict[str, Text] = {}
            own = f"{name}_{k}"
            strides_of.append(pairs)
            if not (few and table.few()):
                self._blocks.append(self._rows(table, f"{own}_rows"))
                named["rows"] = f"{own}_rows"
            if table.few():
                counts = [count - 1 for count in table.counts]
                axes = [comment(one) for one in self._names(table.inputs)]
                states = self._shown_states(table.output)
                self._blocks.append(
                    total_lines(f"{own}_total", table.rows, counts, strides, axes, states)
                )
                named["total"] = f"{own}_total"
            found.append(call("tables.Table", [literal(tuple(pairs))], **named))
        priors = priors_of(self._network, part.plan)
        rows = (
            Item(numbers(prior), prefix=f"{positions[node]}: ") for node, prior in priors.items()
        )
        about = [comment(self._shown(table)) for table in tables]
        self._blocks.append(look_up_lines(f"{name}_look_up", strides_of, about))
        prior_of = Group("{", tuple(rows), "}")
        return call("tables.Tables", [tuple_of(found), prior_of, f"{name}_look_up"])

    def _shown(self, table: JointTable) -> str:
        given = ", ".join(self._names(table.inputs))
        what = self._network.shape.names[table.output] if table.output >= 0 else "evidence alone"
        return f"{what} by {given}" if given else what

    def _shown_states(self, output: int) -> list[str]:
        if output < 0:
            return ["evidence alone"]
        name = self._network.shape.names[output]
        return [comment(f"{name} = {state}") for state in self._network.states[output]]

    def _rows(self, table: JointTable, name: str) -> list[str]:
        about = [self._state_names(node) for node in table.inputs]
        cases = itertools.product(*map(range, table.counts))
        rows = (
            Item(
                numbers(row),
                behind=comment(", ".join(of[k] for of, k in zip(about, case, strict=True))),
            )
            for row, case in zip(table.rows, cases, strict=True)
        )
        what = self._network.shape.names[table.output] if table.output >= 0 else "evidence alone"
        given = f"# P({comment(what)}, evidence)"
        return [given, *assignment(name, tuple_of(rows), 0)]

    def _messages(self, plan: Plan, name: str) -> None:
        for node in plan.part.nodes:
            self._used.update((node, *self._network.shape.parents[node]))
        rows = message_rows(plan)
        messages = (
            Item(
                literal(tuple(row)),
                behind=f"{k} {comment(', '.join(self._names(row.nodes)))}".rstrip(),
            )
            for k, row in enumerate(rows)
        )
        self._blocks.append(
            [
                "# Kind, parts, nodes, inputs, known.",
                *assignment(f"{name}_messages", tuple_of(messages), 0),
            ]
        )

    def _schedule(self, part: Part, name: str, positions: Mapping[int, int], *, loop: bool) -> Text:
        plan, cards = part.plan, self._network.shape.cards
        self._messages(plan, name)
        hard: Text = "None"
        if not loop and part.adapted is None:
            steps = steps_of(plan.program, cards, positions, look_up=True)
            hard = self._steps(steps, f"{name}_hard")
        full: Text = "None"
        if not plan.part.given:
            steps = steps_of(plan.program, cards, positions)
            full = self._loop(steps, f"{name}_full") if loop else self._steps(steps, f"{name}_full")
        fields = [literal(answers_of(plan)), hard, full]
        return call("schedule.Schedule", ["nodes", f"{name}_messages", *fields])

    def _adapted(
        self, plan: Plan, otherwise: Text, name: str, positions: Mapping[int, int]
    ) -> Text:
        self._messages(plan, name)
        steps = steps_of(plan.program, self._network.shape.cards, positions, adapting=True)
        inputs = tuple(node for node in plan.part.inputs if node not in plan.part.outputs)
        fields = [f"{name}_messages", self._loop(steps, name), literal(inputs), str(WIDE)]
        return call("patterns.Adapted", [otherwise, *fields])

    def _slots(self, steps: Steps, name: str) -> None:
        rows = (
            Item(literal(row), behind=of) for row, of in zip(steps.slots, steps.names, strict=True)
        )
        self._blocks.append(assignment(f"{name}_slots", tuple_of(rows), 0))

    def _steps(self, steps: Steps, name: str) -> Text:
        self._slots(steps, name)
        lines = [f"def {name}(numpy, slots):"]
        used = dict.fromkeys(operation.function for operation in steps.operations)
        if any("dot(" in row for row in steps.rows):
            used["dot"] = None
        lines += [f"    {function} = numpy.{function}" for function in used]
        lines += unpacked(steps.names, "slots", 4)
        if len(lines) > 1:
            lines.append("")
        lines.append("    def step(s):")
        for case, terms in steps.cases.items():
            lines += sum_lines(case, [f"s[{position}] * {by}" for position, by in terms], 8)
        for operation in steps.operations:
            line = f"        {operation.function}({', '.join(operation.operands)})"
            lines.append(
                f"{line}  # {comment(', '.join(self._names(operation.nodes)))}".rstrip(" #")
            )
        lines += returned(Group("[", tuple(map(Item, steps.rows)), "]"), 8)
        self._blocks.append([*lines, "", "    return step"])
        return call("schedule.Steps", [f"{name}_slots", name])

    def _loop(self, steps: Steps, name: str) -> Text:
        self._slots(steps, name)
        rows = (
            Item(
                literal(
                    (
                        operation.message,
                        operation.function,
                        *(int(text[1:]) for text in operation.operands),
                    )
                ),
                behind=comment(", ".join(self._names(operation.nodes))),
            )
            for operation in steps.operations
        )
        self._blocks.append(assignment(f"{name}_operations", tuple_of(rows), 0))
        answers = tuple(int(row.partition(".")[0][1:]) for row in steps.rows)
        named = {"operations": f"{name}_operations", "answers": literal(answers)}
        return call("schedule.Steps", [f"{name}_slots"], **named)
