"""The monitor of a network with thresholds: evidence that holds for every state that is possible.

What is not known of an input is tried, state by state, so these bounds are exact.
"""

from __future__ import annotations

import itertools
import math
from operator import eq
from typing import Any, Iterable, Iterator, List, NamedTuple, Sequence, Tuple

from ..monitor import Field, Json, Tree, finite
from ..thresholds import Evidence, Threshold
from ..why import FALSE, TEXTS, TRUE, UNKNOWN, Cause, figure
from .engine import Rows
from .monitor import BayesianNetworkMonitor, Output
from .outputs import Claim

__all__ = ["COMBINATIONS", "REASONS", "Claim", "StateThreshold", "Threshold", "ThresholdMonitor"]

COMBINATIONS = 1024
"""States of unknown nodes, multiplied, up to which they are all tried in a step."""
_REMEMBERED = 1024

Open = Tuple[int, Tuple[int, ...]]
"""Position of an observable node whose state is not known, and the states it may be in."""
Pairs = List[Tuple[float, float]]

INCONSISTENT = "inconsistent"
TOO_MANY = "too many unknown inputs"
UNKNOWN_INPUTS = "unknown inputs"
HOLD = "hold"
BETWEEN = "between limits"
NO_TIME = "no time"
ERROR = "error"
REASONS = {
    BETWEEN: "it lies between its limits, and was not known before",
    ERROR: "a hand-written method failed",
    HOLD: "it holds, but not for long enough yet",
    INCONSISTENT: "the evidence has probability zero",
    NO_TIME: "the step has no time",
}


class StateThreshold(NamedTuple):
    """A threshold of the probability of some states of a node."""

    node: int  # number of the node
    states: tuple[int, ...]  # numbers of the states whose probabilities are added up
    at_least: bool  # the probability must not be below; else it must not be above
    limits: Threshold  # where it begins and ends; of the negative probability for ``at_least``


class ThresholdMonitor(BayesianNetworkMonitor):
    """What the class ``Monitor`` of a compiled network with thresholds inherits."""

    thresholds: tuple[StateThreshold, ...]  # the evidence for ConSerts
    _bounds: Pairs | None  # of each probability in the last step

    def __init__(self, hooks: object | None = None) -> None:
        self._judges = [Evidence(threshold.limits) for threshold in self.thresholds]
        self._plan = (
            [threshold.at_least for threshold in self.thresholds],
            [threshold.limits.hold_ns for threshold in self.thresholds],
            [judge.step for judge in self._judges],
        )
        super().__init__(hooks)
        self._timed = True
        self._doubtful = [source.reader for source in self._sources if source.reader.doubtful]
        order = self.engine.outputs
        self._picks = [(order.index(of.node), of.states) for of in self.thresholds]
        self._tried_bounds: dict[Any, Pairs | None] = {}
        readers = {node: source.reader for node, (_, source) in self._fed.items()}
        self._places = [
            (position, node, tuple(range(missing)), readers.get(node))
            for position, (node, missing) in enumerate(zip(self.engine.observable, self._missing))
        ]

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Output:
        output = super().execute_step(eddi_input, t_ns)
        last = self._last
        if last.problem:
            self._lose(ERROR)
            return output
        opened = self._opened()
        self._all_known = not opened
        bounds: Pairs | None = None
        if opened and math.prod([len(possible) for _, possible in opened]) > COMBINATIONS:
            self._lose(TOO_MANY)
            return output
        if opened:
            bounds = self._bounds_over(opened)
        elif last.rows is not None:
            bounds = [(p, p) for p in self._picked(last.rows)]
        if bounds is None:
            self._lose(INCONSISTENT)
            return output
        self._bounds, self._timely = bounds, last.now == last.now
        for at_least, hold_ns, step, (low, high) in zip(*self._plan, bounds):
            usable = self._timely or not hold_ns
            worst, best = (-low, -high) if at_least else (high, low)
            step(last.now, worst, usable=usable, best=best)
        return output

    def _lose(self, reason: str) -> None:
        """Let nothing be active, whatever the probabilities are."""
        self._bounds, self._reason = None, reason
        for judge in self._judges:
            judge.step(0, math.nan, usable=False)

    def _picked(self, rows: Rows) -> list[float]:
        return [
            rows[place][states[0]]
            if len(states) == 1
            else math.fsum([rows[place][state] for state in states])
            for place, states in self._picks
        ]

    def _bounds_over(self, opened: Sequence[Open]) -> Pairs | None:
        """Return (lowest, highest) of each probability; None if no combination is possible."""
        states, weights = self._last.states, self._last.weights
        key = tuple(states), tuple(opened)
        if not weights and key in self._tried_bounds:
            return self._tried_bounds[key]
        tried, cases = list(states), []
        for case in itertools.product(*(possible for _, possible in opened)):
            for (position, _), state in zip(opened, case):
                tried[position] = state
            rows = self._tried(tried, weights)
            if rows is not None:
                cases.append(self._picked(rows))
        bounds = [(min(column), max(column)) for column in zip(*cases)] if cases else None
        if not weights:
            if len(self._tried_bounds) >= _REMEMBERED:
                self._tried_bounds.clear()
            self._tried_bounds[key] = bounds
        return bounds

    def _opened(self) -> Sequence[Open]:
        """Return the nodes whose states are not known, where that is not accepted."""
        last, missing = self._last, self._missing
        doubt = self._doubtful and any(reader.possible for reader in self._doubtful)
        if not doubt and True not in map(eq, last.states, missing):
            return ()
        opened: list[Open] = []
        for position, node, every, reader in self._places:
            by_method = node in last.answer.findings or node in last.answer.problems
            if last.states[position] == missing[position]:
                accepted = reader is not None and reader.prior_accepted and not by_method
                if position not in last.weights and not accepted:
                    opened.append((position, every))
            elif reader is not None and reader.possible and not by_method:
                opened.append((position, tuple(reader.possible)))
        return opened

    def claims(self) -> list[Claim]:
        bounds = self._bounds or [(math.nan, math.nan)] * len(self.thresholds)
        made = []
        for threshold, own, (low, high) in zip(self.thresholds, self._judges, bounds):
            reason = "" if own.active else self._reason
            if self._bounds is not None and not own.active:
                if not own.possible:
                    reason = ""
                elif (-low if threshold.at_least else high) <= threshold.limits.activate:
                    reason = HOLD if self._timely else NO_TIME
                else:
                    reason = BETWEEN if self._all_known else UNKNOWN_INPUTS
            made.append(Claim(own.id, own.active, low, high, reason))
        return made

    def evidence_message(self) -> Tree:
        facts = self.facts()
        fields: dict[str, Field] = {
            "bayesian_network_id": self.model_id,
            "valid": facts.valid,
            "unknown_inputs": list(facts.unknown_inputs),
            "evidence": [("BayesianNetworkThreshold", claim._asdict()) for claim in self.claims()],
        }
        return "BayesianNetworkEvidence", fields

    def beside_json(self) -> dict[str, Json]:
        """Return what is beside the posteriors; a bound not computed is None."""
        facts, rows = self.facts(), [claim._asdict() for claim in self.claims()]
        return {
            "valid": facts.valid,
            "unknown_inputs": list(facts.unknown_inputs),
            "accepted": list(facts.accepted),
            "evidence": [{name: finite(value) for name, value in row.items()} for row in rows],
        }

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        for claim, threshold, judge in zip(self.claims(), self.thresholds, self._judges):
            verdict = TRUE if claim.active else UNKNOWN if claim.reason else FALSE
            yield claim.id, verdict, () if claim.active else self._causes(claim, threshold, judge)

    def _causes(self, claim: Claim, threshold: StateThreshold, judge: Evidence) -> list[Cause]:
        node, limit = self.nodes[threshold.node], abs(threshold.limits.activate)
        about = f"{node.id}={' or '.join([node.states[state] for state in threshold.states])}"
        best, tail = (claim.high if threshold.at_least else claim.low), f"limit {figure(limit)}"
        if claim.reason == HOLD:
            hold = threshold.limits.hold_ns / 1e9
            since = self._lasting(judge.since)
            return [Cause((), "hold", TEXTS["hold"], since=since, limit=hold)]
        if not claim.reason:
            text = f"{about} {figure(best)} for {{since}}, {tail}"
            return [Cause((), "false", text, since=self._lasting(judge.lost), limit=limit)]
        if claim.reason == BETWEEN:
            return [Cause((), "window", f"{about} {figure(best)}, {tail}", limit=limit)]
        if claim.reason not in (UNKNOWN_INPUTS, TOO_MANY):
            return [Cause((), "invalid", REASONS[claim.reason])]
        bounds = f"{about} {figure(claim.low)} .. {figure(claim.high)}, {tail}"
        return self._of_nodes("" if math.isnan(claim.low) else bounds)

    def _of_nodes(self, detail: str) -> list[Cause]:
        """Return why the states of nodes are not known that are open."""
        facts = self.facts()
        accepted = {text.partition(": ")[0] for text in facts.accepted}
        names = [name for name in facts.unknown_inputs if name not in accepted]
        specs = [spec for spec in self.inputs if spec.id in names]
        texts = {
            name: f"may be {' or '.join(of)} after a gap" for name, of in facts.undecided.items()
        }
        known = {spec.id for spec in specs}  # a node that only a method observes is no input
        texts.update({name: "not observed" for name in names if name not in known})
        more = [Cause((name,), "invalid", text, detail=detail) for name, text in texts.items()]
        return [*self._of_unknown(specs, self.faults(), detail), *more]

    def reset(self) -> None:
        super().reset()
        for judge in self._judges:
            judge.reset()
        self._bounds = None
        self._reason, self._all_known, self._timely = UNKNOWN_INPUTS, False, True
