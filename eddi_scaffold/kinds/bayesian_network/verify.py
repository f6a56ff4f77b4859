"""Whether the text of a Bayesian network has the settings, tables and messages of its model."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.evidence.emitted import Call, Class, Emitted, UnprovedError, data, reading
from eddi_scaffold.kinds.bayesian_network.elimination import factors_of, summed
from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes

if TYPE_CHECKING:
    from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions
_KIND = "bayesian_network"
_CLOSE = 1e-12  # relative difference of two numbers that are equal


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
    outputs = tuple(sorted(number[name] for name in options.inferred))
    observable = tuple(sorted(number[name] for name in options.observable))
    _Program(emitted, network, outputs, observable).take(monitor)
    emitted.end(monitor)
    shown = ", ".join(network.nodes[k].id for k in outputs)
    yield f"{shown} for any evidence of {len(observable)} nodes, to {_CLOSE:g} of each number"


def _sources(emitted: Emitted, monitor: Class, network: Network, options: NetworkOptions) -> None:
    """Take the methods that read the inputs of the nodes."""
    places = {input_.id: k for k, input_ in enumerate(emitted.declared.inputs)}
    rows, reads = [], ""
    for k, node in enumerate(network.nodes):
        input_id = options.input_of(node.id)
        if input_id is None:
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


class _Part(NamedTuple):
    """Nodes that no evidence connects with others, ascending."""

    nodes: Sequence[int]
    inputs: Sequence[int]  # that may be observed
    outputs: tuple[int, ...]
    roots: Sequence[int]  # inputs whose prior goes with their evidence


class _Program:
    """What is inferred: nodes are numbers, and a table has an axis for each."""

    def __init__(
        self, emitted: Emitted, network: Network, outputs: Sequence[int], observable: Sequence[int]
    ) -> None:
        self.emitted, self.outputs, self.observable = emitted, outputs, observable
        self.factors = factors_of(network)
        self.parents = {k: axes[:-1] for k, (axes, _) in enumerate(self.factors)}
        self.scheduled: set[int] = set()  # nodes whose tables are in the text

    def take(self, monitor: Class) -> None:
        """Take the program: parts that share no node; what is in none is always possible."""
        node = monitor.attributes.pop("foreseen", ast.Constant(None))
        parts = data(node).keywords["parts"]
        left = reached(self.parents, [*self.outputs, *self.observable])
        for name in parts:
            left -= self._part(self.emitted.values.pop(str(name), node), left)
        axes = {axis for of in left for axis in self.factors[of][0]}
        is_sure = all(self.factors[of][1].min() > 0.0 for of in left)
        if not is_sure or axes - left or left.intersection(self.outputs):
            self.emitted.differs(node, "a part of the network is missing")
        same = {"outputs": self.outputs, "observable": self.observable, "parts": parts}
        self.emitted.same("foreseen", node, Call(f"{_KIND}.Program", (), same))
        if self.scheduled:
            self._nodes(self.emitted.values.pop("nodes", node))

    def _part(self, node: ast.expr, left: set[int]) -> set[int]:
        """Take a part, with tables of its outputs or with messages; return its nodes."""
        (made,), fields = data(node).args, data(node).keywords
        starts = [*(self.observable[k] for k in fields["inputs"]), *fields["outputs"]]
        nodes = reached(self.parents, starts)
        if not nodes <= left:
            raise UnprovedError(node, "it shares nodes with another part")
        inputs = [k for k in self.observable if k in nodes]
        outputs = tuple(k for k in self.outputs if k in nodes) or fields["outputs"][:1]
        roots = [k for k in inputs if not self.parents[k] and k not in outputs]
        part = _Part(sorted(nodes), inputs, outputs, roots)
        take = self._tables if made.name == "tables.Tables" else self._messages
        smallest = (of[of > 0.0].min() for of in (self.factors[k][1] for k in nodes))
        least = math.floor(math.fsum(map(math.log2, smallest)) + _CLOSE)
        same = {"inputs": self._places(inputs), "outputs": outputs, "least": least}
        self.emitted.same("the part", node, Call(f"{_KIND}.Part", (take(node, made, part),), same))
        return nodes

    def _places(self, nodes: Sequence[int]) -> tuple[int, ...]:
        return tuple(map(self.observable.index, nodes))

    def _tables(self, node: ast.expr, made: Call, part: _Part) -> Call:
        """Take P(output, evidence) of each output."""
        tables = []
        given: Any = made.args
        for table, output in zip(given[0], part.outputs, strict=True):
            axes = [k for k in part.inputs if k != output]
            factors = [self.factors[k] for k in part.nodes if k not in part.roots]
            for k in axes:  # the axis of what is observed: its states, and none
                prior = self.factors[k][1] if k in part.roots else np.ones(self._card(k))
                observed = np.vstack([np.diag((prior > 0.0) * 1.0), prior])
                factors.append(((~k, k), observed))
            rows = summed(factors, [*(~k for k in axes), output])
            numbers = self.emitted.values.pop(str(table.args[1]), node)
            got, expected = np.array(data(numbers)), rows.reshape(-1, self._card(output))
            if got.dtype != float or got.shape != expected.shape:
                raise UnprovedError(numbers, f"it has not {expected.shape} numbers")
            if (wrong := ~(abs(got - expected) <= _CLOSE * expected)).any():
                text = f"a number is {got[wrong][0]}, the model says {expected[wrong][0]:.15g}"
                self.emitted.differs(numbers, text)
            tables.append(Call("tables.Table", (self._places(axes), table.args[1])))
        priors = {self.observable.index(k): tuple(self.factors[k][1].tolist()) for k in part.roots}
        return Call("tables.Tables", (tuple(tables), priors))

    def _card(self, node: int) -> int:
        return int(self.factors[node][1].shape[-1])

    def _messages(self, node: ast.expr, made: Call, part: _Part) -> Call:
        """Take messages: products of leaves, summed over nodes that no other leaf has."""
        self.scheduled.update(part.nodes)
        axes_of = {("table", k): {*self.factors[k][0]} for k in part.nodes if k not in part.roots}
        axes_of |= {("prior" if k in part.roots else "evidence", k): {k} for k in part.inputs}
        places = {("unit", k): {k} for k in part.outputs}  # of ones
        # leaves, axes, nodes that are summed over, known
        taken: list[tuple[set[tuple[str, int]], set[int], set[int], bool]] = []
        given: Any = made.args
        _, name, answers = given
        value = self.emitted.values.pop(str(name), node)
        for row in data(value):
            kind, parts, nodes, _, is_known = row
            axes, lost = {*nodes}, set[int]()
            if kind == "product":
                parts = (first, second) = sorted(parts)
                (leaves, own, of_a, a), (others, more, of_b, b) = taken[first], taken[second]
                is_right = first >= 0 and not leaves & others and axes <= own | more
                leaves, can_be_known = leaves | others, a and b
                gone = (own | more) - axes
                lost = of_a | of_b | gone
                is_right &= lost.isdisjoint(axes)
                is_right &= all(leaf in leaves or not gone & of for leaf, of in axes_of.items())
            else:
                leaf, can_be_known = (kind, *(parts or nodes)), True
                is_right = is_known and axes == {**axes_of, **places}.get(leaf)
                leaves, parts = {leaf} - places.keys(), leaf[1:] if kind == "table" else ()
            seen = sorted(k for of, k in leaves if of != "table")
            is_known = can_be_known and (is_known or not seen)
            seen = seen if is_known else []
            expected = (kind, tuple(parts), tuple(sorted(axes)), tuple(seen), is_known)
            if not is_right or repr(row) != repr(expected):
                raise UnprovedError(value, f"message {len(taken)} is no sum over its nodes")
            taken.append((leaves, axes, lost, is_known))
        for output, answer in zip(part.outputs, answers, strict=True):
            leaves, axes, *_ = taken[answer]
            if axes != {output} or leaves != axes_of.keys() - {("evidence", output)} or answer < 0:
                raise UnprovedError(node, "its answers are no posteriors")
        return Call("schedule.Schedule", (Call("nodes"), name, answers))

    def _nodes(self, node: ast.expr) -> None:
        """Take the tables that messages are made of."""
        for k, (parents, rows) in data(node).items():
            table = self.factors[k][1].reshape(-1, self._card(k)).tolist()
            expected: list[object] = [*map(tuple, table)]
            given = rows
            if isinstance(rows, Call) and rows.name == "schedule.rows_of":
                (text,) = () if rows.keywords else rows.args or ()
                given = tuple(tuple(map(float, line.split())) for line in text.splitlines())
            if repr((parents, given)) != repr((self.parents[k], tuple(expected))):
                self.emitted.differs(node, f"the table of node {k} is another one")
        if {*data(node)} != self.scheduled:
            raise UnprovedError(node, "it has the tables of other nodes")
