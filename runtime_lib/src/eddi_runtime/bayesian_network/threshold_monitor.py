"""The monitor of a network with thresholds: posteriors, and evidence for ConSerts."""

from __future__ import annotations

import math
from operator import eq
from typing import Iterable, Sequence

from ..monitor import Field, Json, Standing, Tree
from .claims import ERROR, REASONS, UNKNOWN, Claim, Claims, Open, StateThreshold
from .monitor import BayesianNetworkMonitor, Output
from .outputs import Facts


class ThresholdMonitor(BayesianNetworkMonitor):
    """What the class ``Monitor`` of a compiled network with thresholds inherits."""

    thresholds: tuple[StateThreshold, ...]  # the evidence for ConSerts

    def __init__(self, hooks: object | None = None) -> None:
        self._claims = Claims(self.thresholds)
        super().__init__(hooks)
        self._timed |= any(threshold.limits.hold_ns for threshold in self.thresholds)
        self._doubtful = [source.reader for source in self._sources if source.reader.doubtful]

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Output:
        output = super().execute_step(eddi_input, t_ns)
        last = self._last
        if last.problem:
            self._claims.lose(ERROR)
        else:
            opened = self._opened()
            self._claims.step(last.now, last.rows, last.states, last.weights, opened)
        return output

    def evidence_message(self) -> Tree:
        """Return the thresholds as a ``BayesianNetworkEvidence`` without header."""
        facts = self.facts()
        fields: dict[str, Field] = {
            "bayesian_network_id": self.model_id,
            "valid": facts.valid,
            "unknown_inputs": list(facts.unknown_inputs),
            "evidence": [("BayesianNetworkThreshold", claim._asdict()) for claim in self.claims()],
        }
        return "BayesianNetworkEvidence", fields

    def claims(self) -> list[Claim]:
        return self._claims.rows()

    def beside_json(self) -> dict[str, Json]:
        """Return what is beside the posteriors; a bound not computed is None."""
        facts, rows = self.facts(), [claim._asdict() for claim in self.claims()]
        for row in rows:
            row.update((k, None) for k in ("low", "high") if not math.isfinite(row[k]))
        return {
            "valid": facts.valid,
            "unknown_inputs": list(facts.unknown_inputs),
            "accepted": list(facts.accepted),
            "evidence": rows,
        }

    def standings(self) -> list[Standing]:
        facts = self.facts()
        return [
            Standing("threshold", claim.id, claim.active, *_why(claim, facts))
            for claim in self.claims()
        ]

    def blocked(self, not_known: Iterable[str] = ()) -> dict[str, tuple[str, ...]]:
        rows = self.claims()
        found: dict[str, tuple[str, ...]] = {}
        if lost := tuple(row.id for row in rows if row.reason in UNKNOWN):
            found = dict.fromkeys(self.facts().unknown_inputs, lost)
        if inactive := tuple(row.id for row in rows if not row.active):
            fed = {source.spec.id for source in self._sources}
            found.update((name, inactive) for name in not_known if name in fed)
        return found

    def reset(self) -> None:
        super().reset()
        self._claims.reset()

    def _prepare(self, outputs: set[int], observed: set[int]) -> None:
        super()._prepare(outputs, observed)
        self._claims.prepare(self.engine.outputs, self._tried)
        readers = {node: source.reader for node, (_, source) in self._fed.items()}
        self._places = [
            (position, node, tuple(range(missing)), readers.get(node))
            for position, (node, missing) in enumerate(zip(self.engine.observable, self._missing))
        ]

    def _opened(self) -> Sequence[Open]:
        """Return the nodes whose states are not known, where that is not accepted."""
        last, missing = self._last, self._missing
        doubt = self._doubtful and any(reader.possible for reader in self._doubtful)
        if not doubt and True not in map(eq, last.states, missing):
            return ()
        found: list[Open] = []
        for position, node, every, reader in self._places:
            by_method = node in last.answer.findings or node in last.answer.problems
            if last.states[position] == missing[position]:
                accepted = reader is not None and reader.prior_accepted and not by_method
                if position not in last.weights and not accepted:
                    found.append((position, every))
            elif reader is not None and reader.possible and not by_method:
                found.append((position, tuple(reader.possible)))
        return found


def _why(one: Claim, facts: Facts) -> tuple[tuple[tuple[str, str], ...], str]:
    """Return what a threshold lacks, and why else it is not active, in words for people."""
    if one.active:
        return (), ""
    if one.reason in UNKNOWN:
        lacks = _lacks(facts)
        return tuple(lacks.items()), "" if lacks else one.reason
    if one.reason:
        return (), REASONS[one.reason]
    bounds = one.bounds(".4g")
    return (), f"the probability is {bounds}" if bounds else ""


def _lacks(facts: Facts) -> dict[str, str]:
    """Return input or node -> why its state is not known and not accepted either."""
    accepted = {text.partition(": ")[0] for text in facts.accepted}
    found = {name: "not known" for name in facts.unknown_inputs if name not in accepted}
    for node, states in facts.undecided.items():
        found[node] = f"may be {' or '.join(states)} after a gap"
    return found
