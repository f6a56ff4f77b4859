"""The monitor of a Bayesian network: inputs to evidence, evidence to posteriors."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import (
    Any,
    Dict,
    Iterable,
    List,
    Mapping,
    Optional,
    Set,
    Tuple,
    Union,
)

from ..clock import step_time
from ..documents import ModelError
from ..inputs import InputSpec, accepted
from ..model_file import ModelFile
from ..monitor import Standing, Tree
from . import outputs as out
from .claims import ERROR, UNKNOWN, Claim, Claims
from .engine import Posteriors
from .explain import Explanation, explain
from .inference import Evidence, Inference
from .knowledge import NO_ANSWER, Facts, Knowledge, Step
from .methods import Answer, Methods
from .model import read_model_part
from .outputs import BayesianNetworkOutput, Monitor, Node, Outcome
from .sources import make_sources
from .standings import standings
from .width import TooWideError

Output = List[BayesianNetworkOutput]
_ACTOR = 0
_NO_TIME = math.nan  # neither before nor behind any time
_UNKNOWN: Posteriors = []


def build(model_file: ModelFile, hooks: Any = None) -> BayesianNetworkMonitor:
    """Compile a Bayesian network.

    Args:
        model_file: the model.
        hooks: instance of the package's ``BayesianNetworkConfig``; None: declarations only.

    Raises:
        ModelError: the model is wrong or too wide, or needs numpy and it is not installed.
    """
    return BayesianNetworkMonitor(model_file, hooks)


class BayesianNetworkMonitor(Monitor):
    """One compiled Bayesian network. Not thread-safe: the thread that steps it also asks it.

    Attributes:
        model_id: id of the model: ``bayesian_network_id`` of the output.
        digest: SHA-256 of the model file's content.
        kind: ``bayesian_network``.
        inputs: what ``execute_step`` reads, one attribute each.
        inference: posteriors by name, without inputs and methods.
        remembered: cases of states whose posteriors are kept at most.
    """

    remembered = 1024
    kind = "bayesian_network"

    def __init__(self, model_file: ModelFile, hooks: Any = None) -> None:
        self.model_id = model_file.id
        self.digest = model_file.digest
        self.inputs: Tuple[InputSpec, ...] = model_file.inputs
        self._model = model = read_model_part(model_file)
        self._sources = make_sources(model, self.inputs)
        self._timed = any(source.reader.timed for source in self._sources)
        self._timed |= any(one.limits.hold_ns for one in model.thresholds)
        self._claims = Claims(model.thresholds) if model.thresholds else None
        self._methods = None
        outputs: Set[int] = set(model.outputs)
        observed: Set[int] = {source.node for source in self._sources}
        observed.update(model.observed or ())
        if hooks is not None:
            self._methods = Methods(hooks, model.network, virtual=model.virtual)
            observed |= self._methods.observed
            observed |= self._methods.doubtful if model.thresholds else set()
            outputs |= self._methods.outputs
        self._knowledge = Knowledge(self._sources, observed)
        judged = {one.node for one in model.thresholds}
        self._judged_only = judged - outputs
        try:
            self.inference = Inference(model.network, outputs | judged, observed)
        except (TooWideError, ImportError) as problem:
            raise ModelError(model_file.path, str(problem)) from None
        self._good: Optional[Tuple[Posteriors, Set[int]]] = None
        self._source: object = None
        self._output_faults: Tuple[str, ...] = ()
        self._prepare()

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
            self._last.answer = answer
            if not self._foreseen(answer) and not self._grow(answer.outputs, answer.findings):
                if self._claims is not None:
                    self._claims.lose(ERROR)
                return []
        last = self._last
        last.answer, last.problem = answer, ""
        flagged = answer.outputs
        states = list(self._missing)
        weights: Dict[int, List[float]] = {}
        raw: List[object] = []
        for position, attribute, read, reader in self._readers:
            try:
                value = getattr(eddi_input, attribute, None)
                found = read(value, now)
            except Exception:  # noqa: BLE001 - a hostile object: whatever it raises, no evidence
                value, found = None, reader.absent(now)
            raw.append(value)
            if type(found) is int:
                states[position] = found
            else:
                weights[position] = found  # type: ignore[assignment]  # a list, then
        if answer is not NO_ANSWER:
            answer.put(self._positions, self._missing, states, weights)
        last.raw, last.states, last.weights = raw, states, weights
        rows = self._posteriors(states, weights)
        if self._claims is not None:
            opened = self._knowledge.opened(states, weights, answer)
            self._claims.step(now, rows, states, weights, opened)
        last.inconsistent = rows is None
        if rows is not None:
            self._good = rows, flagged
        elif self._model.on_inconsistent == "prior":
            rows = self.inference.engine.infer(self._missing)
        elif self._model.on_inconsistent == "hold" and self._good is not None:
            rows, flagged = self._good
        return [] if rows is None else self._output(rows, flagged)

    def _foreseen(self, answer: Answer) -> bool:
        return answer.outputs <= self._known and self._knowledge.covers(answer.findings)

    def _posteriors(
        self, states: List[int], weights: Mapping[int, List[float]]
    ) -> Optional[Posteriors]:
        """Return the posteriors: known from the start, seen in former steps, or inferred."""
        if weights:
            return self.inference.engine.infer(states, weights)
        key = tuple(states)
        rows = self._known_rows.get(key, _UNKNOWN)
        if rows is _UNKNOWN:
            rows = self.inference.engine.infer(states)
            if len(self._known_rows) < self.remembered:
                self._known_rows[key] = rows
        return rows

    def _tried(self, states: List[int], weights: Mapping[int, List[float]]) -> Optional[Posteriors]:
        """Return the posteriors of a case that is only thought of: it is not worth remembering."""
        rows = _UNKNOWN if weights else self._known_rows.get(tuple(states), _UNKNOWN)
        return self.inference.engine.infer(states, weights) if rows is _UNKNOWN else rows

    def as_json(self, output: Output) -> Optional[List[Dict[str, Any]]]:
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

    def message(self, output: Any) -> Union[Tree, List[Tree], None]:
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
        relevance = self._explained().relevance if self._model.explain else {}
        unobserved = self._unobserved()
        return out.status_message(self.model_id, self.status(), unobserved, self.facts(), relevance)

    def evidence_message(self) -> Tree:
        """Return the thresholds as a ``BayesianNetworkEvidence`` without header."""
        return out.evidence_message(self.model_id, self.facts(), self.claims())

    def claims(self) -> List[Claim]:
        """Return the last result of each threshold, in the order of the configuration."""
        return [] if self._claims is None else self._claims.rows()

    def beside_json(self) -> Dict[str, Any]:
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
        if not last.inconsistent or self._model.on_inconsistent == "silent":
            return facts
        key = f"on_inconsistent: {self._model.on_inconsistent}"
        return facts._replace(accepted=(*facts.accepted, key))

    def explain(self) -> Explanation:
        """Return what was known in the last step, and how much each observed node mattered."""
        return replace(self._explained(), facts=self.facts(), claims=tuple(self.claims()))

    def _explained(self) -> Explanation:
        return explain(self.inference.engine, self._last.states, self._last.weights)

    def posteriors(self, evidence: Mapping[str, Evidence]) -> Dict[str, Tuple[float, ...]]:
        """Return the posteriors for evidence by name; see ``Inference.posteriors``.

        Steps are not touched by it, unless a node was not foreseen as observable.
        """
        before = self.inference.engine
        found = self.inference.posteriors(evidence)
        if self.inference.engine is not before:
            self._prepare()
        return found

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

    def _grow(self, flagged: Iterable[int], findings: Iterable[int]) -> bool:
        """Compile again for more nodes; False when the network is too wide for it."""
        try:
            self.inference.grow(flagged, findings)
        except (TooWideError, ImportError) as problem:
            fresh = Step(self._missing)
            fresh.answer, fresh.problem = self._last.answer, str(problem)
            self._last = fresh
            return False
        self._good, answer = None, self._last.answer
        self._prepare(findings)
        self._last.answer = answer
        return True

    def _prepare(self, inputs: Iterable[int] = ()) -> None:
        """Take over what depends on the compiled engine, and nodes that turned out to be inputs."""
        engine, network = self.inference.engine, self._model.network
        names, states = network.shape.names, network.states
        self._missing = engine.missing
        self._positions = {node: k for k, node in enumerate(engine.observable)}
        self._known = frozenset(engine.outputs)
        self._known_rows: Dict[Tuple[int, ...], Optional[Posteriors]] = {}
        if engine.lookup_only and math.prod(card + 1 for card in engine.missing) <= self.remembered:
            cases = itertools.product(*(range(card + 1) for card in engine.missing))
            self._known_rows = {case: engine.infer(case) for case in cases}
        self._titles = [(node, names[node], states[node]) for node in engine.outputs]
        self._readers = [
            (self._positions[one.node], one.spec.attribute, one.reader.read, one.reader)
            for one in self._sources
        ]
        self._knowledge.prepare(engine, inputs)
        if self._claims is not None:
            self._claims.prepare(engine.outputs, self._tried)
        self._last = Step(self._missing)

    def _output(self, rows: Posteriors, flagged: Set[int]) -> Output:
        given = self._model.outputs
        nodes = [
            Node(title, list(map(Outcome, states, row)))
            for (node, title, states), row in zip(self._titles, rows)
            if node in given or node in flagged
        ]
        return [BayesianNetworkOutput(_ACTOR, self.model_id, nodes)]

    def _evidence(self) -> Mapping[str, object]:
        return self._explained().evidence

    def _unobserved(self) -> List[str]:
        last, names = self._last, self._model.network.shape.names
        pairs = zip(self.inference.engine.observable, last.states, self._missing)
        return [
            names[node]
            for k, (node, state, missing) in enumerate(pairs)
            if state == missing and k not in last.weights
        ]
