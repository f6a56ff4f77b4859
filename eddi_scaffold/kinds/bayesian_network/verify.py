"""Whether the tables of a generated Bayesian network are those of a variable elimination."""

from __future__ import annotations

import ast
import itertools
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eddi_scaffold.evidence.emitted import (
    Call,
    Class,
    Emitted,
    Lines,
    UnprovedError,
    data,
    reading,
    unpacked,
)
from eddi_scaffold.evidence.sums import place, returned, variables
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes
from eddi_scaffold.kinds.bayesian_network.verify_arrays import Group, Schedule, joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

    Array = NDArray[np.float64]
    Factor = tuple[Sequence[int], Array]  # its axes, which are nodes
_ROOM = "bayesian_network"
_CLOSE = 1e-12  # relative difference of two numbers that are equal


def verify(network: Network, options: NetworkOptions, emitted: Emitted) -> Iterator[str]:
    """Compare a text with a network; yield what is proved."""
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["claims.ThresholdMonitor"] if options.thresholds else []
    monitor = emitted.monitor(", ".join(bases) or f"{_ROOM}.BayesianNetworkMonitor")
    number = {name: k for k, name in enumerate(network.names())}
    attributes = node_attributes(network)
    thresholds = []
    for of in options.thresholds:
        sign = -1.0 if of.at_least else 1.0
        limits = (of.id, sign * of.limit, sign * of.release, round(of.hold * 1e9))
        states = tuple(map(network.node(of.node).states.index, of.states))
        fields = (number[of.node], states, of.at_least, Call("claims.Threshold", limits))
        thresholds.append(Call("claims.StateThreshold", fields))
    specs = ((node.id, node.states, attributes[node.id]) for node in network.nodes)
    inconsistent = options.on_inconsistent
    expected = {
        "nodes": tuple(Call(f"{_ROOM}.NodeSpec", fields) for fields in specs),
        "given": tuple(sorted(number[name] for name in options.outputs)),
        "thresholds": tuple(thresholds) or None,
        "virtual": None if options.virtual else False,
        "on_inconsistent": None if inconsistent == "silent" else inconsistent,
    }
    for name, value in expected.items():
        emitted.attribute(monitor, name, value)
    programs = _Programs(emitted, network)
    nodes = tuple(number.values())
    outputs = tuple(sorted(number[name] for name in options.inferred))
    observable = tuple(sorted(number[name] for name in options.observable))
    programs.take(monitor, "foreseen", outputs, observable)
    if "everything" in monitor.attributes or not outputs == observable == nodes:
        programs.take(monitor, "everything", nodes, nodes)
    _sources(emitted, monitor, network, options)
    emitted.end(monitor)
    shown = ", ".join(network.nodes[k].id for k in outputs)
    yield f"{shown} for any evidence of {len(observable)} nodes, to {_CLOSE:g} of each number"


def _sources(emitted: Emitted, monitor: Class, network: Network, options: NetworkOptions) -> None:
    """Take the methods that read the inputs of the nodes."""
    places = {input_.id: k for k, input_ in enumerate(emitted.declared.inputs)}
    rows, reads = [], ""
    for k, node in enumerate(network.nodes):
        input_id = options.input_of(node.id)
        if input_id is None or node.id not in options.observable:
            continue
        place = Call(f"self.inputs[{places[input_id]}]")
        entry = next((of.reader for of in options.declarations if of.node == node.id), None)
        if entry is None:
            reader = Call("direct.DirectReader", (node.states,), {"virtual": options.virtual})
        else:
            usual = type(entry)(entry.missing)._asdict()
            given = {key: of for key, of in entry._asdict().items() if of != usual[key]}
            remembers = entry.hysteresis > 0.0 or entry.policy == "hold"
            name = "memory.Remembering" if remembers else "readers.Discretiser"
            reader = Call(name, (Call("readers.Declaration", (entry.missing,), given), place))
        rows.append(Call(f"{_ROOM}.Source", (k, place, reader)))
        reads += f"{reading(emitted.declared.inputs[places[input_id]].attribute)}, "
    if rows:
        sources = monitor.method("sources", "self")
        emitted.same("sources", sources.take("return V")["V"], tuple(rows))
        sources.end()
        otherwise = "except Exception:\n    return super().read(source)"
        monitor.body("read", "self, source", f"try:\n    return ({reads})\n{otherwise}")


class _Programs:
    """What is inferred: nodes are numbers, and a table has an axis for each."""

    def __init__(self, emitted: Emitted, network: Network) -> None:
        self.emitted = emitted
        number = {name: k for k, name in enumerate(network.names())}
        self.cards = [len(node.states) for node in network.nodes]
        parents = ([number[name] for name in node.parents] for node in network.nodes)
        self.families = [(*of, k) for k, of in enumerate(parents)]
        tables = (np.array(node.table) for node in network.nodes)
        shapes = ([self.cards[axis] for axis in family] for family in self.families)
        self.tables = [table.reshape(of) for table, of in zip(tables, shapes, strict=True)]
        self.factors: dict[int, Factor] = dict(
            enumerate(zip(self.families, self.tables, strict=True))
        )
        self.numbers: Collection[int] = ()  # nodes whose tables are in the text

    def take(
        self, monitor: Class, name: str, outputs: tuple[int, ...], observable: tuple[int, ...]
    ) -> None:
        """Take a program with its parts, each of which is one of the network."""
        node = monitor.attributes.pop(name, None)
        given = {} if node is None else data(node).keywords
        if node is None or "parts" not in given:
            raise UnprovedError(node or monitor.node, f"nothing is inferred for {name}")
        optional = {key: of for key, of in given.items() if key in ("when_observed", "cases")}
        same = {"outputs": outputs, "observable": observable, "parts": given["parts"], **optional}
        self.emitted.same(name, node, Call(f"{_ROOM}.Program", (), same))
        relevant, waiting = set[int](), [*outputs, *observable]
        while waiting:
            if (of := waiting.pop()) not in relevant:
                relevant.add(of)
                waiting += self.families[of]
        rows: dict[int, Factor] = {}
        whole = Group(sorted(relevant), observable, outputs)
        taken = self._parts(node, given["parts"], self._groups(whole), observable, rows)
        if "when_observed" in given:
            names = [of for of in given["when_observed"] if str(of) not in taken]
            kept = {str(of) for of in given["when_observed"]}
            groups = []
            for part, group in taken.items():
                if part not in kept:
                    fixed = tuple(of for of in group.inputs if of not in group.outputs)
                    groups += self._groups(group, fixed)
            self._parts(node, names, groups, observable, {})
        if "cases" in given:
            value = self.emitted.values.pop(str(given["cases"]), node)
            self._cases(value, rows, outputs, observable)

    def _groups(self, of: Group, fixed: tuple[int, ...] = ()) -> list[Group]:
        """Return a part in parts whose tables share only nodes that are observed in each step."""
        found: list[tuple[set[int], set[int]]] = []  # nodes, and axes of their tables
        for node in of.nodes:
            own, axes = {node}, {*self.families[node]}.difference(fixed)
            joined = [one for one in found if one[1] & axes]
            found = [one for one in found if not one[1] & axes]
            found.append((own.union(*(a for a, _ in joined)), axes.union(*(b for _, b in joined))))
        groups = []
        for nodes, _ in found:
            around = {axis for node in nodes for axis in self.families[node]}
            inputs = tuple(k for k in of.inputs if k in nodes and k not in fixed)
            shown = tuple(k for k in of.outputs if k in nodes)
            always = tuple(k for k in fixed if k in around)
            groups.append(Group(sorted(nodes), inputs, shown, always))
        return groups

    def _parts(
        self,
        at: ast.expr,
        names: Sequence[Call],
        groups: Sequence[Group],
        observable: Sequence[int],
        rows: dict[int, Factor],
    ) -> dict[str, Group]:
        """Take parts, each of one group; groups without one must never be impossible."""
        left, taken = [*groups], dict[str, Group]()
        for name in map(str, names):
            value = self.emitted.values.pop(name, at)
            (made,), fields = data(value).args, data(value).keywords
            for group in left:
                places = tuple(map(observable.index, group.inputs))
                axes = {*group.inputs, *group.always}
                if made.name == "tables.Tables":
                    pairs = made.args[0][0].args[0]
                    is_of = {observable[k] for k, _ in pairs} == axes - {*group.outputs[:1]}
                else:
                    is_of = not group.always
                if is_of and fields.get("inputs") == places and fields["outputs"] == group.outputs:
                    break
            else:
                raise UnprovedError(value, "it is no part of the network")
            left.remove(group)
            taken[name] = group
            exponents = [
                np.log2(of[of > 0.0].min()) for of in map(self.tables.__getitem__, group.nodes)
            ]
            least = math.floor(math.fsum(exponents) + _CLOSE)
            fields = {"inputs": places, "outputs": group.outputs, "least": least}
            self.emitted.same("the part", value, Call(f"{_ROOM}.Part", (made,), fields))
            if made.name == "tables.Tables":
                rows |= self._tables(value, made, observable, group)
                continue
            if not self.numbers:
                self._nodes()
            if not {axis for of in group.nodes for axis in self.families[of]} <= {*self.numbers}:
                raise UnprovedError(value, "a table is missing")
            Schedule(self.emitted, self.factors, group, observable).take(value, made)
        for group in left:
            factors = [self.factors[of] for of in group.nodes]
            is_sure = all(table.min() > 0.0 for _, table in factors)
            if group.outputs or not (
                is_sure or joint(factors, [*group.inputs, *group.always]).min() > 0.0
            ):
                self.emitted.differs(at, "a part of the network is missing")
        return taken

    def _nodes(self) -> None:
        """Take the tables of the nodes that operations of numpy use."""
        node = self.emitted.values.pop("nodes", ast.Constant(None))
        self.numbers = data(node)
        for k, (parents, given) in data(node).items():
            rows = given
            if isinstance(given, Call) and given.name == "schedule.rows_of":
                lines = str(*given.args or ()).splitlines()
                rows = tuple(tuple(map(float, line.split())) for line in lines)
            card = self.cards[k]
            numbers = self.tables[k].reshape(-1, card).tolist()
            if repr((parents, rows)) != repr((self.families[k][:-1], tuple(map(tuple, numbers)))):
                self.emitted.differs(node, f"the table of node {k} is another one")

    def _tables(
        self, value: ast.expr, made: Call, observable: Sequence[int], group: Group
    ) -> dict[int, Factor]:
        """Take the tables of a part; return output (or -1) -> inputs, and a row for each case."""
        tables, given, look_up = made.args or ()
        inputs, position = sorted(group.inputs + group.always), observable.index
        # the prior of such a node goes with its evidence
        roots = [of for of in group.inputs if len(self.families[of]) == 1]
        roots = [of for of in roots if of not in group.outputs]
        priors = {position(of): tuple(self.tables[of].tolist()) for of in roots}
        if repr(given) != repr(priors):
            self.emitted.differs(value, f"its priors are {given}, the model says {priors}")
        found: dict[int, Factor] = {}
        strides = []
        for table, output in itertools.zip_longest(tables, group.outputs or [-1]):
            axes = [observable[at] for at, _ in table.args[0]]
            if sorted(axes) != [of for of in inputs if of != output]:
                raise UnprovedError(value, "a table has other inputs")
            rest = [self.factors[of] for of in group.nodes if of not in roots]
            rest += [((of,), np.ones(self.cards[of])) for of in axes]
            weights = joint(rest, [*axes, output] if group.outputs else axes)
            weights = weights.reshape([*(self.cards[of] for of in axes), -1])
            rows = weights
            for k, axis in enumerate(axes):
                prior = self.tables[axis] if axis in roots else np.ones(self.cards[axis])
                weights = np.moveaxis(np.moveaxis(weights, k, -1) * (prior > 0.0), -1, k)
                every = np.diag((prior > 0.0).astype(float))
                every = every if axis in group.always else np.vstack([every, prior])
                rows = np.moveaxis(np.tensordot(every, rows, (1, k)), 0, k)
            steps = (math.prod(rows.shape[k + 1 : -1]) for k in range(len(axes)))
            strides.append(tuple(zip(map(position, axes), steps, strict=True)))
            match table:
                case Call("tables.Table", (of,), named) if repr(of) == repr(strides[-1]) and named:
                    pass
                case _:
                    raise UnprovedError(value, "a table has other rows")
            for key, of in named.items():
                if key == "rows":
                    node = self.emitted.values.pop(str(of), value)
                    self._same(node, data(node), rows.reshape(-1, rows.shape[-1]))
                elif key == "total" and not group.always:
                    self._total(self.emitted.functions.pop(str(of), value), weights)
                else:
                    raise UnprovedError(value)
            found[output] = axes, rows
        function = self.emitted.functions.pop(str(look_up), value)
        self._look_up(function, strides, len(observable))
        return found

    def _same(self, node: ast.AST, got: Any, expected: Array) -> None:
        try:
            numbers = np.array(got, dtype=float)
        except (TypeError, ValueError):
            raise UnprovedError(node) from None
        if numbers.shape != expected.shape:
            raise UnprovedError(node, f"it has {numbers.shape} numbers, not {expected.shape}")
        for wrong in np.argwhere(~(abs(numbers - expected) <= _CLOSE * expected)).tolist()[:1]:
            at = tuple(wrong)
            text = f"number {at} is {numbers[at]}, the model says {expected[at]:.15g}"
            self.emitted.differs(node, text)

    def _total(self, function: ast.AST, weights: Array) -> None:
        """Take the function that sums all products of vectors of the inputs with a table."""
        *counts, card = weights.shape
        vectors = [variables([(k, of) for of in range(n)]) for k, n in enumerate(counts)]
        sums = returned(function, "v", {"v": vectors})
        if not isinstance(sums, list) or len(sums) != card:
            raise UnprovedError(function)
        got = np.zeros_like(weights)
        for state, of in enumerate(sums):
            for product, coefficient in of.items():
                if [axis for axis, _ in product] != [*range(len(counts))]:
                    raise UnprovedError(function, "it is no sum over all inputs")
                got[(*(k for _, k in product), state)] = float(coefficient)
        self._same(function, got, weights)

    def _look_up(
        self, function: ast.AST, strides: Sequence[Sequence[tuple[int, int]]], count: int
    ) -> None:
        """Take the function that finds the rows of the tables."""
        if not isinstance(function, ast.FunctionDef) or ast.unparse(function.args) != "*tables":
            raise UnprovedError(function)
        lines = Lines(function)
        names = unpacked(lines, "tables", len(strides))
        match [*lines.rest]:
            case [
                ast.FunctionDef(body=[*above, ast.Return(ast.List(rows))], name=name) as inner,
                ast.Return(ast.Name(id)),
            ] if name == id and len(rows) == len(names):
                pass
            case _:
                raise UnprovedError(function)
        for row, table, pairs in zip(rows, names, strides, strict=True):
            if not isinstance(row, ast.Subscript) or ast.unparse(row.value) != table:
                raise UnprovedError(row)
            states = {"s": variables(range(count))}
            case = returned(inner, "s", states, place, [*above, ast.Return(row.slice)])
            expected = {(at,): step for at, step in pairs}
            if {of: factor for of, factor in case.items() if factor} != expected:
                self.emitted.differs(row, f"it is another row of {table}")

    def _cases(
        self,
        node: ast.expr,
        tables: Mapping[int, Factor],
        outputs: Sequence[int],
        observable: Sequence[int],
    ) -> None:
        """Take the posteriors that are written out for all cases of evidence."""
        got = data(node)
        every = [*itertools.product(*(range(self.cards[of] + 1) for of in observable))]
        if not isinstance(got, dict) or repr([*got]) != repr(every):
            raise UnprovedError(node, "it has other cases")
        for case in every:
            states = dict(zip(observable, case, strict=True))
            rows: dict[int, Array] = {}
            for output, (axes, table) in tables.items():
                row = table[tuple(states[axis] for axis in axes)]
                seen = states.get(output, len(row))
                rows[output] = row if seen == len(row) else row * (np.arange(len(row)) == seen)
            if not all(row.any() for row in rows.values()):
                if got[case] is not None:
                    self.emitted.differs(node, f"the model says that {case} is impossible")
                continue
            if not isinstance(got[case], tuple) or len(got[case]) != len(outputs):
                raise UnprovedError(node)
            for written, output in zip(got[case], outputs, strict=True):
                self._same(node, written, rows[output] / rows[output].sum())
