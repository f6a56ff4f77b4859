"""The monitor of a Bayesian network: inputs to evidence, evidence to posteriors."""

from __future__ import annotations

import math
from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple, Union

from ..clock import step_time
from ..compatibility import ModelError
from ..inputs import InputSpec, accepted
from ..monitor import Json, Standing, Tree
from ..reading import Absent, read
from . import outputs as out
from .claims import ERROR, UNKNOWN, Claim, Claims
from .engine import Engine
from .evidence import EvidenceError, InconsistentEvidenceError, NotForeseenError, finding
from .explain import Explanation, explain
from .knowledge import NO_ANSWER, Facts, Knowledge, Source, Step
from .methods import Answer, Methods
from .outputs import BayesianNetworkOutput, Monitor, Node, Outcome
from .program import NodeSpec, Program, Rows, StateThreshold
from .standings import standings

Evidence = Union[None, str, Sequence[float]]
"""Of one node: nothing, the name of a state, or one likelihood per state."""
Output = List[BayesianNetworkOutput]
_ACTOR = 0
_NO_TIME = math.nan  # neither before nor behind any time
_UNKNOWN: Rows = ()


class BayesianNetworkMonitor(Monitor):
    """What the class ``Monitor`` of a compiled Bayesian network inherits.

    Not thread-safe: the thread that steps it also asks it.

    Attributes:
        model_id: id of the model: ``bayesian_network_id`` of the output.
        digest: SHA-256 of the model file's content.
        kind: ``bayesian_network``.
        inputs: what ``execute_step`` reads, one attribute each.
        nodes: of the network, in the order of the file.
        given: nodes whose posterior is always given.
        foreseen: inference for what the model declares.
        everything: inference for any node; None where it would be too wide.
        thresholds: the evidence for ConSerts.
        virtual: several non-zero outcomes are likelihoods; False: D7.2's rule.
        on_inconsistent: the result on evidence of probability zero: ``silent``, ``prior`` or
            ``hold``.
        relevance: the status message has the relevance of each observed node.
        remembered: cases of states whose posteriors are kept at most.
    """

    kind = "bayesian_network"
    model_id: str
    digest: str
    inputs: Tuple[InputSpec, ...]
    nodes: Tuple[NodeSpec, ...]
    given: Tuple[int, ...]
    foreseen: Program
    everything: Optional[Program] = None
    thresholds: Tuple[StateThreshold, ...] = ()
    virtual = True
    on_inconsistent = "silent"
    relevance = False
    remembered = 1024

    def __init__(self, hooks: Optional[object] = None) -> None:
        """Make the monitor.

        Args:
            hooks: instance of the package's ``BayesianNetworkConfig``; None: declarations only.

        Raises:
            ModelError: numpy is needed and not installed, or a method observes a node that was not
                foreseen, and no inference is there for it.
        """
        self._sources = self.sources()
        self._timed = any(source.reader.timed for source in self._sources)
        self._timed |= any(one.limits.hold_ns for one in self.thresholds)
        self._claims = Claims(self.thresholds) if self.thresholds else None
        judged = {one.node for one in self.thresholds}
        outputs, observed = {*self.foreseen.outputs}, {*self.foreseen.observable}
        self._judged_only = judged.difference(self.given)
        self._methods = None
        if hooks is not None:
            self._methods = Methods(hooks, self.nodes, virtual=self.virtual)
            observed |= self._methods.observed
            outputs |= self._methods.outputs
            self._judged_only -= self._methods.outputs
        self._knowledge = Knowledge(self._sources, observed)
        self._good: Optional[Tuple[Rows, Set[int]]] = None
        self._source: object = None
        self._output_faults: Tuple[str, ...] = ()
        try:
            self._prepare(self._engine_for(outputs, observed))
        except (ImportError, NotForeseenError) as problem:
            raise ModelError(self.model_id, str(problem)) from None

    def sources(self) -> Tuple[Source, ...]:
        """Return the declared ways from inputs to nodes, by node, with readers of their own."""
        return ()

    def read(self, eddi_input: object) -> Tuple[object, ...]:
        """Return the value of each source; compiled monitors write this out."""
        found = [read(eddi_input, one.spec.attribute, one.spec.id) for one in self._sources]
        return tuple([None if type(value) is Absent else value for value in found])

    def execute_step(self, eddi_input: object, t_ns: Optional[int] = None) -> Output:
        """Evaluate once; never raises an Exception.

        Reads one attribute per input and calls every method of a person. Absent, None, NaN and
        whatever is no value for an input leave its node unobserved, so that its prior speaks.

        Args:
            eddi_input: holds one attribute per input; ``data`` of what the methods get.
            t_ns: time in nanoseconds, for ``missing: hold``; what is no whole number is no time,
                and nothing is held then.

        Returns:
            One ``BayesianNetworkOutput`` with the outputs in the order of the network. An empty
            list when evidence has probability zero and ``on_inconsistent`` is ``silent``.
        """
        self._source = eddi_input
        now: float = 0
        if self._timed:
            time = step_time(t_ns)
            now = _NO_TIME if time is None else time
        answer = NO_ANSWER
        if self._methods is not None:
            answer = self._methods.ask(eddi_input)
            if not answer.outputs <= self._known and not self._grow(answer):
                if self._claims is not None:
                    self._claims.lose(ERROR)
                return []
        last = self._last
        last.answer, last.problem = answer, ""
        flagged = answer.outputs
        states = list(self._missing)
        weights: Dict[int, List[float]] = {}
        last.raw = raw = self.read(eddi_input)
        for (position, judge, absent), value in zip(self._readers, raw):
            try:
                found = judge(value, now)
            except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, no evidence
                last.raw = tuple([None if one is value else one for one in last.raw])
                found = absent(now)
            if isinstance(found, int):
                states[position] = found
            else:
                weights[position] = found
        if answer is not NO_ANSWER:
            answer.put(self._positions, self._missing, states, weights)
        last.states, last.weights = states, weights
        rows = _UNKNOWN if weights else self._known_rows.get(tuple(states), _UNKNOWN)
        if rows is _UNKNOWN:
            rows = self._inferred(states, weights)
        if self._claims is not None:
            opened = self._knowledge.opened(states, weights, answer)
            self._claims.step(now, rows, states, weights, opened)
        last.inconsistent = rows is None
        if rows is not None:
            self._good = rows, flagged
        elif self.on_inconsistent == "prior":
            rows = self._tried(list(self._missing), {})
        elif self.on_inconsistent == "hold" and self._good is not None:
            rows, flagged = self._good
        return [] if rows is None else self._output(rows, flagged)

    def _inferred(self, states: List[int], weights: Mapping[int, List[float]]) -> Optional[Rows]:
        """Return the posteriors of a case that is not known, and remember it."""
        rows = self._engine.infer(states, weights)
        if not weights and len(self._known_rows) < self.remembered:
            self._known_rows[tuple(states)] = rows
        return rows

    def _tried(self, states: List[int], weights: Mapping[int, List[float]]) -> Optional[Rows]:
        """Return the posteriors of a case that is only thought of: it is not worth remembering."""
        rows = _UNKNOWN if weights else self._known_rows.get(tuple(states), _UNKNOWN)
        return self._engine.infer(states, weights) if rows is _UNKNOWN else rows

    def as_json(self, output: Output) -> Optional[List[Dict[str, Json]]]:
        """Return an output as JSON; None when no posterior was given."""
        return out.as_json(output)

    def series(self, output: Output) -> Dict[str, Union[bool, float, str, None]]:
        """Return ``Node=state`` -> probability, None for what was not given; and each threshold."""
        found: Dict[str, Union[bool, float, str, None]] = {
            f"{title}={name}": None
            for node, title, states in self._titles
            if node not in self._judged_only
            for name in states
        }
        for one in output:
            for given in one.output_nodes:
                found.update((f"{given.title}={two.name}", two.value) for two in given.outcomes)
        found.update((one.id, one.active) for one in self.claims())
        return found

    def decided(self, output: Output) -> Dict[str, Union[bool, float, str, None]]:
        """Return each threshold, the most probable state of each node, and the status.

        The state is None for what was not given, the first of equally probable ones.
        """
        found: Dict[str, Union[bool, float, str, None]] = {
            title: None for node, title, _ in self._titles if node not in self._judged_only
        }
        for one in output:
            for given in one.output_nodes:
                found[given.title] = max(given.outcomes, key=lambda two: two.value).name
        found.update((one.id, one.active) for one in self.claims())
        return {**found, "status": self.status_name()}

    def message(self, output: object) -> Union[Tree, List[Tree], None]:
        """Return an output as a ``BayesianNetworkOutput`` tree; None when there is no posterior."""
        tree, self._output_faults = out.output_message(output)
        return tree

    def output_faults(self) -> Tuple[str, ...]:
        """Return what kept posteriors from being published, and which methods failed."""
        last = self._last
        problems = sorted(set(last.answer.problems.values()))
        if last.problem:
            problems.append(last.problem)
        if last.inconsistent:
            shown = ", ".join(f"{name}={value}" for name, value in self._evidence().items())
            problems.append(f"the evidence has probability zero: {shown}")
        return (*problems, *self._output_faults)

    def status_name(self) -> str:
        """Return the status of the last step in a word: why there is no output, for instance."""
        return out.STATUS_NAMES[self.status()]

    def status(self) -> int:
        """Return OK 0, PARTIAL 1, PRIOR 2, INCONSISTENT 3 or ERROR 4 for the last step."""
        last = self._last
        if last.inconsistent:
            return out.INCONSISTENT
        if last.answer.problems or last.problem:
            return out.ERROR
        unobserved = len(self._unobserved())
        if not unobserved and self._missing:
            return out.OK
        return out.PRIOR if unobserved == len(self._missing) else out.PARTIAL

    def status_message(self) -> Tree:
        """Return the facts behind the last step as a ``BayesianNetworkStatus`` without header."""
        relevance = self._explained().relevance if self.relevance else {}
        unobserved = self._unobserved()
        return out.status_message(self.model_id, self.status(), unobserved, self.facts(), relevance)

    def evidence_message(self) -> Tree:
        """Return the thresholds as a ``BayesianNetworkEvidence`` without header."""
        return out.evidence_message(self.model_id, self.facts(), self.claims())

    def claims(self) -> List[Claim]:
        """Return the last result of each threshold, in the order of the configuration."""
        return [] if self._claims is None else self._claims.rows()

    def beside_json(self) -> Dict[str, Json]:
        """Return the results in addition to the posteriors, as ``json`` can write them."""
        return out.evidence_json(self.facts(), self.claims()) if self._claims is not None else {}

    def standings(self) -> List[Standing]:
        """Return every threshold after the last step; raw posteriors claim nothing."""
        return standings(self.claims(), self.facts()) if self._claims is not None else []

    def accepted(self) -> Tuple[str, ...]:
        """Return ``input: key`` for each acceptance that was in use in the last step."""
        return self.facts().accepted

    def facts(self) -> Facts:
        """Return which inputs were known in the last step, and what was accepted for others."""
        facts, last = self._knowledge.facts(self._last), self._last
        if limitless := accepted(self.inputs, self._source):
            facts = facts._replace(accepted=(*facts.accepted, *limitless))
        if not last.inconsistent or self.on_inconsistent == "silent":
            return facts
        key = f"on_inconsistent: {self.on_inconsistent}"
        return facts._replace(accepted=(*facts.accepted, key))

    def explain(self) -> Explanation:
        """Return what was known in the last step, and how much each observed node mattered."""
        return self._explained()._replace(facts=self.facts(), claims=tuple(self.claims()))

    def _explained(self) -> Explanation:
        last, observable = self._last, [self.nodes[one] for one in self._engine.observable]
        return explain(observable, self._missing, self._tried, last.states, last.weights)

    def posteriors(self, evidence: Mapping[str, Evidence]) -> Dict[str, Tuple[float, ...]]:
        """Return the posterior of each output, in the order of its states; steps are not touched.

        Args:
            evidence: node -> what is known; nodes may be left out.

        Raises:
            EvidenceError: an unknown node or state, or numbers that are no likelihoods.
            InconsistentEvidenceError: the evidence has probability zero.
            NotForeseenError: a node was not foreseen, and no inference is there for it.
        """
        numbers = {spec.id: node for node, spec in enumerate(self.nodes)}
        found: Dict[int, Union[int, List[float]]] = {}
        for name, value in evidence.items():
            if name not in numbers:
                raise EvidenceError(f"there is no node {name!r}")
            judged = _judged(self.nodes[numbers[name]], value)
            if judged is not None:
                found[numbers[name]] = judged
        engine = self._engine
        if not found.keys() <= set(engine.observable):
            engine = self._engine_for({*engine.outputs}, {*engine.observable, *found})
        states, weights = list(engine.missing), {}
        for position, node in enumerate(engine.observable):
            one = found.get(node)
            if isinstance(one, int):
                states[position] = one
            elif one is not None:
                weights[position] = one
        rows = engine.infer(states, weights)
        if rows is None:
            shown = ", ".join(f"{name}={value}" for name, value in evidence.items())
            raise InconsistentEvidenceError(f"the evidence has probability zero: {shown}")
        return {self.nodes[node].id: tuple(row) for node, row in zip(engine.outputs, rows)}

    def blocked(self, not_known: Iterable[str] = ()) -> Dict[str, Tuple[str, ...]]:
        """Return input id -> thresholds that are not active; see ``Monitor``.

        A node that is not observed keeps no posterior from being given.
        """
        if self._claims is None:
            return {}
        rows = self.claims()
        found: Dict[str, Tuple[str, ...]] = {}
        if lost := tuple(one.id for one in rows if one.reason in UNKNOWN):
            found = dict.fromkeys(self.facts().unknown_inputs, lost)
        if inactive := tuple(one.id for one in rows if not one.active):
            fed = {source.spec.id for source in self._sources}
            found.update((name, inactive) for name in not_known if name in fed)
        return found

    def faults(self) -> Dict[str, str]:
        """Return input id -> what was wrong with its value in the last step."""
        found: Dict[str, str] = {}
        for source, value in zip(self._sources, self._last.raw):
            try:
                reason = source.reader.fault(value)
            except Exception:  # noqa: BLE001 - a hostile object
                reason = "the value cannot be read"
            if reason is not None:
                found.setdefault(source.spec.id, reason)
        return found

    def reset(self) -> None:
        """Forget former steps."""
        for source in self._sources:
            source.reader.reset()
        if self._claims is not None:
            self._claims.reset()
        self._good, self._output_faults, self._source = None, (), None
        self._last = Step(self._missing)

    def _grow(self, answer: Answer) -> bool:
        """Take outputs in that a method has flagged; False when nothing can infer them."""
        outputs, observable = {*self._engine.outputs, *answer.outputs}, {*self._engine.observable}
        try:
            engine = self._engine_for(outputs, observable)
        except (ImportError, NotForeseenError) as problem:
            self._last = Step(self._missing)
            self._last.answer, self._last.problem = answer, str(problem)
            return False
        self._good = None
        self._prepare(engine)
        return True

    def _engine_for(self, outputs: Set[int], observed: Set[int]) -> Engine:
        """Return inference for some nodes: as foreseen, else for any nodes, which takes longer.

        Raises:
            NotForeseenError: there is no inference for these nodes.
        """
        if not self._not_foreseen(outputs, observed):
            return Engine(self.nodes, self.foreseen)
        if self.everything is None:
            reason = self._not_foreseen(outputs, observed)
            raise NotForeseenError(f"{reason}: name it there and run `eddi-scaffold upgrade`")
        return Engine(self.nodes, self.everything, outputs, observed)

    def _not_foreseen(self, outputs: Iterable[int], observed: Iterable[int]) -> str:
        further = [("observed", one) for one in {*observed}.difference(self.foreseen.observable)]
        further += [("outputs", one) for one in {*outputs}.difference(self.foreseen.outputs)]
        return "; ".join(
            f"node_{self.nodes[one].attribute} sets {self.nodes[one].id}, which was not foreseen:"
            f" `{key}:` of the configuration does not name it"
            for key, one in sorted(further)
        )

    def _prepare(self, engine: Engine) -> None:
        """Take over what depends on the engine."""
        self._engine, nodes = engine, self.nodes
        self._missing = engine.missing
        self._positions = {node: k for k, node in enumerate(engine.observable)}
        self._known = frozenset(engine.outputs)
        self._known_rows: Dict[Tuple[int, ...], Optional[Rows]] = {}
        if engine.program is self.foreseen:
            self._known_rows.update(self.foreseen.cases)
        else:
            import logging  # noqa: PLC0415 - what is foreseen needs it not

            reason = self._not_foreseen(engine.outputs, engine.observable)
            logging.getLogger(__name__).warning("%s, so steps take longer", reason)
        self._titles = [(node, nodes[node].id, nodes[node].states) for node in engine.outputs]
        self._readers = [
            (self._positions[one.node], one.reader.read, one.reader.absent) for one in self._sources
        ]
        self._knowledge.prepare(engine)
        if self._claims is not None:
            self._claims.prepare(engine.outputs, self._tried)
        self._last = Step(self._missing)

    def _output(self, rows: Rows, flagged: Set[int]) -> Output:
        given = self.given
        nodes = [
            Node(title, list(map(Outcome, states, row)))
            for (node, title, states), row in zip(self._titles, rows)
            if node in given or node in flagged
        ]
        return [BayesianNetworkOutput(_ACTOR, self.model_id, nodes)]

    def _evidence(self) -> Mapping[str, object]:
        return self._explained().evidence

    def _unobserved(self) -> List[str]:
        last = self._last
        rows = zip(self._engine.observable, last.states, self._missing)
        return [
            self.nodes[node].id
            for k, (node, state, missing) in enumerate(rows)
            if state == missing and k not in last.weights
        ]


def _judged(node: NodeSpec, value: Evidence) -> Union[int, List[float], None]:
    if isinstance(value, str):
        if value not in node.states:
            raise EvidenceError(f"{node.id}: there is no state {value!r}")
        return node.states.index(value)
    try:
        return None if value is None else finding(value, node.states)
    except EvidenceError as problem:
        raise EvidenceError(f"{node.id}: {problem}") from None
