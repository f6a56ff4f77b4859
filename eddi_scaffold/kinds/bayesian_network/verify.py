"""Whether the text of a Bayesian network has the settings, tables and sums of its model.

What operations of numpy infer is not proved; test vectors compare it with the model.
"""

from __future__ import annotations

import ast
import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.evidence.emitted import Call, Class, Emitted, UnprovedError, data, reading
from eddi_scaffold.evidence.sums import returned, variables
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

    Array = NDArray[np.float64]
_KIND = "bayesian_network"
_CLOSE = 1e-12  # relative difference of two numbers that are equal
_MOST_AXES, _MOST_CASES = 52, 2**20  # that numpy.einsum can name; of evidence


def verify(network: Network, options: NetworkOptions, emitted: Emitted) -> Iterator[str]:
    """Compare a text with a network; yield what is proved."""
    bases = ["explain.Explaining"] if options.explain else []
    bases += ["claims.ThresholdMonitor"] if options.thresholds else []
    monitor = emitted.monitor(", ".join(bases) or f"{_KIND}.BayesianNetworkMonitor")
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
        "nodes": tuple(Call(f"{_KIND}.NodeSpec", fields) for fields in specs),
        "given": tuple(sorted(number[name] for name in options.outputs)),
        "thresholds": tuple(thresholds) or None,
        "virtual": None if options.virtual else False,
        "on_inconsistent": None if inconsistent == "silent" else inconsistent,
    }
    for name, value in expected.items():
        emitted.attribute(monitor, name, value)
    _sources(emitted, monitor, network, options)
    nodes = tuple(number.values())
    outputs = tuple(sorted(number[name] for name in options.inferred))
    observable = tuple(sorted(number[name] for name in options.observable))
    _Program(emitted, network, outputs, observable).take(monitor, "foreseen")
    if "everything" in monitor.attributes or not outputs == observable == nodes:
        _Program(emitted, network, nodes, nodes).take(monitor, "everything")
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
        rows.append(Call(f"{_KIND}.Source", (k, place, reader)))
        reads += f"{reading(emitted.declared.inputs[places[input_id]].attribute)}, "
    if rows:
        sources = monitor.method("sources", "self")
        emitted.same("sources", sources.returned(), tuple(rows))
        sources.end()
        otherwise = "except Exception:\n    return super().read(source)"
        monitor.body("read", "self, source", f"try:\n    return ({reads})\n{otherwise}")


class _Program:
    """What is inferred, in one part: nodes are numbers, and a table has an axis for each."""

    def __init__(
        self, emitted: Emitted, network: Network, outputs: Sequence[int], observable: Sequence[int]
    ) -> None:
        self.emitted, self.outputs, self.observable = emitted, outputs, observable
        names, self.cards = network.names(), [len(node.states) for node in network.nodes]
        parents = (map(names.index, node.parents) for node in network.nodes)
        self.families = {k: (*of, k) for k, of in enumerate(parents)}
        self.nodes = sorted(reached(self.families, [*outputs, *observable]))
        shapes = ([self.cards[axis] for axis in of] for of in self.families.values())
        tables = (np.array(node.table) for node in network.nodes)
        self.tables = [of.reshape(shape) for of, shape in zip(tables, shapes, strict=True)]

    def take(self, monitor: Class, name: str) -> None:
        """Take a program, its part, and what is written out for all cases of evidence."""
        node = monitor.attributes.pop(name, ast.Constant(None))
        given = getattr(data(node), "keywords", {})
        if len(given.get("parts", ())) != 1:
            raise UnprovedError(node, "it has independent parts")
        self._part(self.emitted.values.pop(str(*given["parts"]), node))
        same = {"outputs": self.outputs, "observable": self.observable, "parts": given["parts"]}
        if "cases" in given:
            same["cases"] = given["cases"]
            self._cases(self.emitted.values.pop(str(given["cases"]), node))
        self.emitted.same(name, node, Call(f"{_KIND}.Program", (), same))

    def _joint(self, nodes: Sequence[int], observed: Sequence[int], output: int) -> Array:
        """Return P(output, evidence) with an axis for each observed node: its states, or none.

        The table of an observed node that is not one of ``nodes`` goes with its evidence.
        """
        number, cases = len(self.cards), math.prod(self.cards[k] + 1 for k in observed)
        if 2 * number > _MOST_AXES or cases > _MOST_CASES:
            raise UnprovedError(None, "the network is too large")
        operands: list[Any] = [of for k in nodes for of in (self.tables[k], self.families[k])]
        for k in observed:
            prior = np.ones(self.cards[k]) if k in nodes else self.tables[k]
            operands += [np.vstack([np.diag((prior > 0.0) * 1.0), prior]), (number + k, k)]
        kept = [*(number + k for k in observed), output]
        result: Array = np.einsum(*operands, kept, optimize="greedy")
        return result

    def _part(self, node: ast.expr) -> None:
        """Take a part: the tables of its outputs, each by what is observed of the other nodes."""
        (made,) = data(node).args
        if made.name != "tables.Tables":
            raise UnprovedError(node, "it is inferred by operations of numpy")
        roots = [k for k in self.observable if len(self.families[k]) == 1 and k not in self.outputs]
        rest = [of for of in self.nodes if of not in roots]
        place, tables = self.observable.index, []
        for table, output in zip(made.args[0], self.outputs, strict=True):
            axes = [of for of in self.observable if of != output]
            rows = self._joint(rest, axes, output)
            steps = ((place(k), math.prod(rows.shape[at:-1])) for at, k in enumerate(axes, 1))
            tables.append(Call("tables.Table", (tuple(steps),), table.keywords))
            named = {key: str(of) for key, of in table.keywords.items()}
            if not named or not named.keys() <= {"rows", "total"}:
                raise UnprovedError(node)
            if "rows" in named:
                numbers = self.emitted.values.pop(named["rows"], node)
                self._same(numbers, data(numbers), rows.reshape(-1, rows.shape[-1]))
            if "total" in named:
                function = self.emitted.functions.pop(named["total"], node)
                self._total(function, rows[(slice(-1),) * len(axes)])
        self._look_up(self.emitted.functions.pop(str(made.args[2]), node), tables)
        priors = {place(k): tuple(self.tables[k].tolist()) for k in roots}
        expected = Call("tables.Tables", (tuple(tables), priors, made.args[2]))
        smallest = (self.tables[of][self.tables[of] > 0.0].min() for of in self.nodes)
        least = math.floor(math.fsum(map(math.log2, smallest)) + _CLOSE)
        inputs = tuple(range(len(self.observable)))
        fields = {"inputs": inputs, "outputs": self.outputs, "least": least}
        self.emitted.same("the part", node, Call(f"{_KIND}.Part", (expected,), fields))

    def _same(self, node: ast.AST, got: Any, expected: Array) -> None:
        numbers = np.array(got)
        if numbers.dtype != float or numbers.shape != expected.shape:
            raise UnprovedError(node, f"it has not {expected.shape} numbers")
        wrong = ~(abs(numbers - expected) <= _CLOSE * expected)
        if wrong.any():
            text = f"a number is {numbers[wrong][0]}, the model says {expected[wrong][0]:.15g}"
            self.emitted.differs(node, text)

    def _total(self, function: ast.AST, weights: Array) -> None:
        """Take the function that sums all products of vectors of the inputs with a table."""
        *counts, card = weights.shape
        vectors = [variables([(k, of) for of in range(n)]) for k, n in enumerate(counts)]
        sums, got = returned(function, "v", {"v": vectors}), np.zeros_like(weights)
        for state, of in zip(range(card), sums, strict=True):
            for product, coefficient in of.items():
                if [axis for axis, _ in product] != [*range(len(counts))]:
                    raise UnprovedError(function, "it is no sum over all inputs")
                got[(*(k for _, k in product), state)] = float(coefficient)
        self._same(function, got, weights)

    def _look_up(self, function: ast.AST, tables: Sequence[Call]) -> None:
        """Take the function that finds the row of each table by the states that are observed."""
        sums = [" + ".join(f"s[{k}] * {by}" for k, by in (of.args or ())[0]) for of in tables]
        cases = {of: f"k{k}" for k, of in enumerate(dict.fromkeys(sums))}
        lines = "".join(f"        {name} = {of or 0}\n" for of, name in cases.items())
        rows = ", ".join(f"t{k}[{cases[of]}]" for k, of in enumerate(sums))
        names = "".join(f"t{k}, " for k in range(len(sums)))
        inner = f"    def look_up(s):\n{lines}        return [{rows}]\n    return look_up"
        head = f"def {getattr(function, 'name', '')}(*tables):\n    {names}= tables\n"
        if ast.unparse(function) != ast.unparse(ast.parse(head + inner)):
            raise UnprovedError(function, "it looks up other rows")

    def _cases(self, node: ast.expr) -> None:
        """Take the posteriors that are written out for all cases of evidence."""
        joint = [self._joint(self.nodes, self.observable, output) for output in self.outputs]
        got, cases = data(node), [*itertools.product(*map(range, joint[0].shape[:-1]))]
        if repr([*got]) != repr(cases):
            raise UnprovedError(node, "it has other cases")
        for case in cases:
            if (got[case] is None) is bool(joint[0][case].any()):
                self.emitted.differs(node, f"the model says otherwise whether {case} is possible")
            elif got[case] is not None:
                for written, of in zip(got[case], joint, strict=True):
                    self._same(node, written, of[case] / of[case].sum())
