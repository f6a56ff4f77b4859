"""The monitor of a Bayesian network: inputs to evidence, evidence to posteriors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Dict, List, NamedTuple, Union

from ..inputs import InputSpec, look_again, step_time
from ..monitor import Field, Json, ModelError, Monitor, Tree, row_trees
from ..plain_values import Absent, read
from . import outputs as out
from .engine import Engine, NodeSpec, Program, Rows, States, Weights
from .outputs import NO_ANSWER, BayesianNetworkOutput, Node, Outcome

if TYPE_CHECKING:
    from .direct import DirectReader
    from .readers import Discretiser

Output = List[BayesianNetworkOutput]
Named = Dict[str, Union[bool, float, str, None]]
_ACTOR = 0
_NO_TIME = math.nan  # neither before nor behind any time
_UNKNOWN: Rows = ()


class Source(NamedTuple):
    """A declared way from an input to a node."""

    node: int
    spec: InputSpec
    reader: Discretiser | DirectReader


class BayesianNetworkMonitor(out.Monitor, Monitor[Output]):
    """What the class ``Monitor`` of a compiled network inherits; not thread-safe."""

    kind = "bayesian_network"
    nodes: tuple[NodeSpec, ...]  # of the network, in the order of the file
    given: tuple[int, ...]  # nodes whose posterior is always given
    foreseen: Program  # inference for what the model declares
    virtual = True  # several non-zero outcomes are likelihoods; False: D7.2's rule
    # the result on evidence of probability zero: ``silent``, ``prior`` or ``hold``
    on_inconsistent = "silent"
    remembered = 1024  # cases of states whose posteriors are kept at most

    def __init__(self, hooks: object | None = None) -> None:
        """Make the monitor; ModelError without numpy, or what was not foreseen."""
        self._sources = self.sources()
        self._fed = {source.node: (k, source) for k, source in enumerate(self._sources)}
        self._timed = any(source.reader.timed for source in self._sources)
        self._methods = None
        flagged: set[int] = set()
        try:
            self.engine = Engine(self.nodes, self.foreseen)
        except ImportError as problem:
            raise ModelError(self.model_id, str(problem)) from None
        if hooks is not None:
            self._methods = out.Methods(hooks, self.nodes, virtual=self.virtual)
            flagged = self._methods.outputs
            unknown = self._methods.observed.difference(self.engine.observable)
            if unknown:
                raise ModelError(self.model_id, self._not_foreseen("observed", unknown))
        self._missing, self._known = self.engine.missing, frozenset(self.engine.outputs)
        self._known_rows: dict[tuple[int, ...], Rows | None] = {}
        self._shown = self._shown_with(set())
        given = {*self.given, *flagged}
        shown = [self.nodes[node] for node in self.engine.outputs if node in given]
        self._given = [(node.id, node.states) for node in shown]
        places = [self.engine.positions[source.node] for source in self._sources]
        readers = [source.reader for source in self._sources]
        self._readers = [(at, of.read, of.absent) for at, of in zip(places, readers)]
        self.reset()

    def reset(self) -> None:
        for source in self._sources:
            source.reader.reset()
        self._good: tuple[Rows, set[int]] | None = None
        self._output_faults, self._source = (), None
        self._last = out.Step(self._missing)

    def sources(self) -> tuple[Source, ...]:
        """Return the declared ways from inputs to nodes, by node, with readers of their own."""
        return ()

    def read(self, eddi_input: object) -> tuple[object, ...]:
        """Return the value of each source; compiled monitors write this out."""
        specs = [source.spec for source in self._sources]
        values = [read(eddi_input, spec.attribute, spec.id) for spec in specs]
        return tuple([None if type(value) is Absent else value for value in values])

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Output:
        """Return one ``BayesianNetworkOutput``, or none; never raises.

        Absent, None, NaN and whatever is no value for an input leave its node unobserved, so that
        its prior speaks; without a time nothing is held. There is no output where evidence has
        probability zero and ``on_inconsistent`` is ``silent``.
        """
        look_again(eddi_input, t_ns)
        self._source, self._at = eddi_input, t_ns
        last = self._last
        time = step_time(t_ns) if self._timed else 0
        now = _NO_TIME if time is None else time
        answer = NO_ANSWER
        if self._methods is not None:
            answer = self._methods.ask(eddi_input)
            if not answer.outputs <= self._known:
                last = self._last = out.Step(self._missing)
                unknown = answer.outputs.difference(self._known)
                last.answer, last.problem = answer, self._not_foreseen("outputs", unknown)
                return []
        states = list(self._missing)
        weights: dict[int, list[float]] = {}
        raw = self.read(eddi_input)
        last.now, last.answer, last.problem, last.raw = now, answer, "", raw
        for (position, judge, absent), value in zip(self._readers, raw):
            try:
                evidence = judge(value, now)
            except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, no evidence
                last.raw = tuple([None if item is value else item for item in last.raw])
                evidence = absent(now)
            if isinstance(evidence, int):
                states[position] = evidence
            else:
                weights[position] = evidence
        if answer is not NO_ANSWER:
            answer.put(self.engine, states, weights)
        rows = _UNKNOWN if weights else self._known_rows.get(tuple(states), _UNKNOWN)
        if rows is _UNKNOWN:
            rows = self.engine.infer(states, weights)
            if not weights and len(self._known_rows) < self.remembered:
                self._known_rows[tuple(states)] = rows
        last.states, last.weights, last.rows = states, weights, rows
        flagged = answer.outputs
        if rows is not None:
            self._good = rows, flagged
        elif self.on_inconsistent == "prior":
            rows = self._tried(self._missing, {})
        elif self.on_inconsistent == "hold" and self._good is not None:
            rows, flagged = self._good
        if rows is None:
            return []
        shown = self._shown_with(flagged) if flagged else self._shown
        given = [Node(title, list(map(Outcome, names, rows[k]))) for k, title, names in shown]
        return [BayesianNetworkOutput(_ACTOR, self.model_id, given)]

    def _tried(self, states: States, weights: Weights) -> Rows | None:
        """Return the posteriors of a case that is only thought of: it is not worth remembering."""
        rows = _UNKNOWN if weights else self._known_rows.get(tuple(states), _UNKNOWN)
        return self.engine.infer(states, weights) if rows is _UNKNOWN else rows

    def as_json(self, output: Output) -> list[dict[str, Json]] | None:
        return [network.as_json() for network in output] or None

    def series(self, output: Output) -> Named:
        named: Named = {f"{title}={name}": None for title, names in self._given for name in names}
        for node in (node for item in output for node in item.output_nodes):
            named.update((f"{node.title}={item.name}", item.value) for item in node.outcomes)
        named.update((claim.id, claim.active) for claim in self.claims())
        return named

    def decided(self, output: Output) -> Named:
        """Return each threshold, the first most probable state, the status."""
        named: Named = dict.fromkeys(title for title, _ in self._given)
        for node in (node for item in output for node in item.output_nodes):
            named[node.title] = max(node.outcomes, key=lambda item: item.value).name
        named.update((claim.id, claim.active) for claim in self.claims())
        return {**named, "status": self.status_name()}

    def message(self, output: object) -> Tree | list[Tree] | None:
        trees, faults = row_trees(output, out.output_tree)
        self._output_faults = tuple(faults)
        return trees[0] if trees and len(trees) == 1 else trees or None

    def output_faults(self) -> tuple[str, ...]:
        last = self._last
        problems = sorted(set(last.answer.problems.values()))
        if last.problem:
            problems.append(last.problem)
        if last.rows is None:
            shown = ", ".join(f"{name}={value}" for name, value in self._evidence()[0].items())
            problems.append(f"the evidence has probability zero: {shown}")
        return (*problems, *self._output_faults)

    def status_name(self) -> str:
        return out.STATUS_NAMES[self.status()]

    def status(self) -> int:
        """Return OK 0, PARTIAL 1, PRIOR 2, INCONSISTENT 3 or ERROR 4 for the last step."""
        last, (observed, unobserved) = self._last, self._evidence()
        if last.rows is None:
            return out.INCONSISTENT
        if last.answer.problems or last.problem:
            return out.ERROR
        return out.PRIOR if not observed else out.PARTIAL if unobserved else out.OK

    def status_message(self) -> Tree:
        facts = self.facts()
        fields: dict[str, Field] = {
            "bayesian_network_id": self.model_id,
            "status": self.status(),
            "unobserved": self._evidence()[1],
            "valid": facts.valid,
            "unknown_inputs": list(facts.unknown_inputs),
            "undecided": [f"{node}: {', '.join(of)}" for node, of in facts.undecided.items()],
            "accepted": list(facts.accepted),
            "relevance_nodes": [],
            "relevance": [],
        }
        return "BayesianNetworkStatus", fields

    def claims(self) -> list[out.Claim]:
        """Return the last result of each threshold, in the order of the configuration."""
        return []

    def accepted(self) -> tuple[str, ...]:
        return self.facts().accepted

    def facts(self) -> out.Facts:
        """Return which inputs were known in the last step, and what was accepted for others."""
        step, unknown, accepted = self._last, [], []
        undecided: dict[str, tuple[str, ...]] = {}
        for position, node in enumerate(self.engine.observable):
            if node in step.answer.findings:
                continue
            if node not in self._fed or node in step.answer.problems:
                unknown.append(self.nodes[node].id)
                continue
            number, (_, spec, reader) = self._fed[node]
            raw = step.raw[number] if step.raw else None
            taken = step.states[position]
            try:
                known, key = reader.known(raw, step.weights.get(position, taken))
            except Exception:  # noqa: BLE001 - a hostile object
                known, key = False, ""
            if not known:
                unknown.append(spec.id)
            if key:
                accepted.append(f"{spec.id}: {key}")
            if reader.possible:
                states = dict.fromkeys((taken, *reader.possible))
                undecided[self.nodes[node].id] = tuple(self.nodes[node].states[k] for k in states)
        accepted = [*dict.fromkeys(accepted), *super().accepted()]
        if step.rows is None and self.on_inconsistent != "silent":
            accepted.append(f"on_inconsistent: {self.on_inconsistent}")
        failed = step.rows is None or step.problem or step.answer.problems
        valid = not (unknown or undecided or failed)
        return out.Facts(valid, tuple(dict.fromkeys(unknown)), undecided, tuple(accepted))

    def faults(self) -> dict[str, str]:
        reasons: dict[str, str] = {}
        for source, value in zip(self._sources, self._last.raw):
            try:
                reason = source.reader.fault(value)
            except Exception:  # noqa: BLE001 - a hostile object
                reason = "the value cannot be read"
            if reason is not None:
                reasons.setdefault(source.spec.id, reason)
        return reasons

    def _not_foreseen(self, key: str, nodes: set[int]) -> str:
        names = ", ".join([self.nodes[node].id for node in sorted(nodes)])
        return (
            f"methods set {names}, but `{key}:` of the configuration does not name it: name it"
            " there and run `eddi-scaffold upgrade`"
        )

    def _shown_with(self, flagged: set[int]) -> list[tuple[int, str, tuple[str, ...]]]:
        """Return (place, title, states) of each output that is given in a step."""
        pairs = [*enumerate(self.engine.outputs)]
        shown = [
            (k, self.nodes[number])
            for k, number in pairs
            if number in self.given or number in flagged
        ]
        return [(place, node.id, node.states) for place, node in shown]

    def _evidence(self) -> tuple[dict[str, out.Known], list[str]]:
        """Return observed node -> its state or likelihoods; and the nodes that are not."""
        nodes, last = [self.nodes[k] for k in self.engine.observable], self._last
        known: dict[str, out.Known] = {}
        for position, (node, state) in enumerate(zip(nodes, last.states)):
            if position in last.weights:
                known[node.id] = tuple(last.weights[position])
            elif state < len(node.states):
                known[node.id] = node.states[state]
        return known, [node.id for node in nodes if node.id not in known]
