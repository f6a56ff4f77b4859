"""Whether the tables of a generated Bayesian network are those of a variable elimination."""

from __future__ import annotations

import ast
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from string import ascii_letters
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
from eddi_scaffold.evidence.sums import returned, variables
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

    Array = NDArray[np.float64]
    Factor = tuple[Sequence[int], Array]  # its axes, which are nodes
_ROOM = "bayesian_network"
_CLOSE = 1e-12  # relative difference of two numbers that are equal
_LARGEST, _MOST_AXES = 2**22, 32  # of a table on the way
_ARRAYS = "it is inferred by operations of numpy"


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
        shapes = ([self.cards[axis] for axis in family] for family in self.families)
        tables = (np.array(node.table) for node in network.nodes)
        self.tables = [table.reshape(of) for table, of in zip(tables, shapes, strict=True)]

    def take(
        self, monitor: Class, name: str, outputs: Sequence[int], observable: Sequence[int]
    ) -> None:
        """Take a program with its parts, each of which is one of the network."""
        node = monitor.attributes.pop(name, None)
        given = {} if node is None else data(node).keywords
        if node is None or "parts" not in given or "when_observed" in given:
            raise UnprovedError(node or monitor.node, _ARRAYS)
        same = {"outputs": outputs, "observable": observable, "parts": given["parts"]}
        same |= {"cases": given["cases"]} if "cases" in given else {}
        self.emitted.same(name, node, Call(f"{_ROOM}.Program", (), same))
        parts = {}
        for nodes in self._components([*outputs, *observable]):
            places = tuple(k for k, of in enumerate(observable) if of in nodes)
            shown = tuple(of for of in outputs if of in nodes)
            parts[repr((places, shown))] = places, shown, nodes
        rows: dict[int, Factor] = {}
        for part in map(str, given["parts"]):
            value = self.emitted.values.pop(part, node)
            fields = data(value).keywords
            key = repr((fields.get("inputs"), fields.get("outputs")))
            if key not in parts:
                raise UnprovedError(value, "it is no part of the network")
            rows |= self._part(value, observable, *parts.pop(key))
        for _, shown, nodes in parts.values():
            axes = [of for of in nodes if of in observable]
            if shown or not self._joint(nodes, axes).min() > 0.0:
                self.emitted.differs(node, "a part of the network is missing")
        if "cases" in given:
            value = self.emitted.values.pop(str(given["cases"]), node)
            self._cases(value, rows, outputs, observable)

    def _components(self, asked: Sequence[int]) -> list[list[int]]:
        """Return the nodes above those asked for, in groups that share no table."""
        relevant, waiting = set[int](), [*asked]
        while waiting:
            if (of := waiting.pop()) not in relevant:
                relevant.add(of)
                waiting += self.families[of]
        groups: list[set[int]] = []
        for of in relevant:
            family = {*self.families[of]}
            joined = [group for group in groups if group & family]
            groups = [group for group in groups if not group & family]
            groups.append(family.union(*joined))
        return [sorted(group) for group in groups]

    def _joint(self, nodes: Sequence[int], kept: Sequence[int]) -> Array:
        """Return the product of the tables of nodes, summed over all axes but those kept."""
        factors: list[Factor] = [(self.families[of], self.tables[of]) for of in nodes]
        factors += [((axis,), np.ones(self.cards[axis])) for axis in kept]

        def joined(axis: int) -> list[int]:
            return sorted({of for axes, _ in factors if axis in axes for of in axes})

        while open_ := {of for axes, _ in factors for of in axes}.difference(kept):
            axis = min(open_, key=lambda of: math.prod(self.cards[k] for k in joined(of)))
            axes = [of for of in joined(axis) if of != axis]
            touched = [factor for factor in factors if axis in factor[0]]
            factors = [factor for factor in factors if axis not in factor[0]]
            factors.append((axes, self._product(touched, axes)))
        return self._product(factors, kept)

    def _product(self, factors: Sequence[Factor], kept: Sequence[int]) -> Array:
        axes: Sequence[int] = ()
        result: Array = np.ones(())
        for k, (others, factor) in enumerate(factors, 1):
            every = sorted({*axes, *others})
            if len(every) > _MOST_AXES or math.prod(self.cards[of] for of in every) > _LARGEST:
                raise UnprovedError(None, "the network is too wide")
            left = kept if k == len(factors) else every
            a, b, c = (
                "".join(ascii_letters[every.index(of)] for of in g) for g in (axes, others, left)
            )
            result, axes = np.einsum(f"{a},{b}->{c}", result, factor), left
        return result

    def _part(
        self,
        value: ast.expr,
        observable: Sequence[int],
        places: Sequence[int],
        outputs: Sequence[int],
        nodes: Sequence[int],
    ) -> dict[int, Factor]:
        """Take a part with its tables; return output (or -1) -> inputs, and a row for each case."""
        match data(value).args:
            case (Call("tables.Tables", (tuple() as tables, _, Call(look_up))),):
                pass
            case _:
                raise UnprovedError(value, _ARRAYS)
        inputs, position = [observable[k] for k in places], observable.index
        # the prior of such a node goes with its evidence
        roots = [of for of in inputs if of not in outputs and len(self.families[of]) == 1]
        priors = {position(of): tuple(self.tables[of].tolist()) for of in roots}
        exponents = [math.log2(self.tables[of][self.tables[of] > 0.0].min()) for of in nodes]
        least = math.floor(math.fsum(exponents) + _CLOSE)
        fields = {"inputs": places, "outputs": outputs, "least": least}
        made = Call("tables.Tables", (tables, priors, Call(look_up)))
        self.emitted.same("the part", value, Call(f"{_ROOM}.Part", (made,), fields))
        found: dict[int, Factor] = {}
        strides = []
        for table, output in itertools.zip_longest(tables, outputs or [-1]):
            axes = [of for of in inputs if of != output]
            rest = [of for of in nodes if of not in roots]
            weights = self._joint(rest, [*axes, output] if outputs else axes)
            weights = weights.reshape([*(self.cards[of] for of in axes), -1])
            rows = weights
            for k, axis in enumerate(axes):
                prior = self.tables[axis] if axis in roots else np.ones(self.cards[axis])
                weights = np.moveaxis(np.moveaxis(weights, k, -1) * (prior > 0.0), -1, k)
                every = np.vstack([np.diag((prior > 0.0).astype(float)), prior])
                rows = np.moveaxis(np.tensordot(every, rows, (1, k)), 0, k)
            steps = (math.prod(rows.shape[k + 1 : -1]) for k in range(len(axes)))
            strides.append(tuple(zip(map(position, axes), steps, strict=True)))
            match table:
                case Call("tables.Table", (of,), named) if repr(of) == repr(strides[-1]) and named:
                    pass
                case _:
                    raise UnprovedError(value, "a table has other inputs")
            for key, of in named.items():
                if key == "rows":
                    node = self.emitted.values.pop(str(of), value)
                    self._same(node, data(node), rows.reshape(-1, rows.shape[-1]))
                elif key == "total":
                    self._total(self.emitted.functions.pop(str(of), value), weights)
                else:
                    raise UnprovedError(value)
            found[output] = axes, rows
        self._look_up(self.emitted.functions.pop(look_up, value), strides, len(observable))
        return found

    def _same(self, node: ast.AST, got: Any, expected: Array) -> None:
        try:
            numbers = np.array(got, dtype=float)
        except (TypeError, ValueError):
            raise UnprovedError(node) from None
        if numbers.shape != expected.shape:
            raise UnprovedError(node, f"it has {numbers.shape} numbers, not {expected.shape}")
        for place in np.argwhere(~(abs(numbers - expected) <= _CLOSE * expected)).tolist()[:1]:
            at = tuple(place)
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
            case = returned(inner, "s", states, lines=[*above, ast.Return(row.slice)])
            expected = {(place,): step for place, step in pairs}
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
