"""The monitor of a ConSert: which guarantees of a system hold, from what is known right now."""

from __future__ import annotations

from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    List,
    Mapping,
    Optional,
    Sequence,
    Set,
    Tuple,
    Union,
    overload,
)

from ..documents import ModelError
from ..inputs import InputSpec, accepted
from ..model_file import ModelFile
from ..monitor import Standing, Tree
from . import compile as compiler
from .explain import Explanation, Reason, Sets
from .filters import Majority, make_filter
from .graph import build_graph
from .messages import output_message, status_message
from .model import read_consert
from .values import FALSE, FAULT, MISSING, NAMES, TRUE, UNKNOWN, Judgement, describe, judge

Rows = List[Dict[str, object]]
Groups = List[Tuple[str, ...]]
"""Minimal sets of inputs that would activate a guarantee, by size, then by ids."""


def build(
    model_file: ModelFile,
    hooks: object = None,  # noqa: ARG001 - part of the interface of every kind
    *,
    allow_unsupported: bool = False,
) -> ConSertMonitor:
    """Compile a ConSert.

    Args:
        model_file: the model.
        hooks: not used: all hand-written code is in EDDIInput.
        allow_unsupported: build guarantees without support and gates without input as the
            constants that they are in SESAME's first tool; for tests of the evaluation only.

    Raises:
        ModelError: the model is wrong, or has a constant that no author meant.
    """
    return ConSertMonitor(model_file, allow_unsupported=allow_unsupported)


class ConSertMonitor:
    """One compiled ConSert. Not thread-safe: the thread that steps it also asks it.

    Ids in the output of ``execute_step`` are those that ``guarantee_ids`` asks for; everywhere
    else they are those of the model.

    Attributes:
        model_id: id of the model.
        digest: SHA-256 of the model file's content.
        kind: ``consert``.
        inputs: what ``execute_step`` reads, one attribute each.
        guarantee_ids: ids of the guarantees in file order.
        published_ids: their ids in the output.
        step: one evaluation: object with the inputs -> active flags in file order. Never raises.
    """

    kind = "consert"
    step: Callable[[object], Tuple[bool, ...]]

    def __init__(self, model_file: ModelFile, *, allow_unsupported: bool = False) -> None:
        data = read_consert(model_file)
        self._graph = build_graph(data)
        if self._graph.unsupported and not allow_unsupported:
            listed = ", ".join(map(repr, self._graph.unsupported))
            raise ModelError("", f"constant without being meant as default: {listed}")
        self.model_id = model_file.id
        self.digest = model_file.digest
        self.inputs: Tuple[InputSpec, ...] = model_file.inputs
        self.guarantee_ids = tuple(g.id for g in data.guarantees)
        self.published_ids = tuple(g.published for g in data.guarantees)
        self._data = data
        self._number = dict(zip(self.published_ids, self._graph.guarantees))
        self._number.update(zip(self.guarantee_ids, self._graph.guarantees))
        self._filter = make_filter(model_file.settings, self._graph.leaves)
        self._record = compiler.Record(self._graph.leaves)
        self.step = compiler.compile_step(
            self._graph,
            data.leaves,
            [(spec.attribute, spec.id) for spec in self.inputs],
            self._record,
            None if self._filter is None else self._filter.apply,
        )
        self._rows = compiler.compile_rows(self.published_ids)
        self._output_faults: Tuple[str, ...] = ()
        self._groups: Tuple[Sequence[int], Dict[int, Groups]] = ((), {})

    def execute_step(self, eddi_input: object, t_ns: Optional[int] = None) -> Rows:
        """Evaluate once: a new list of ``{'id': ..., 'active': ...}`` in file order.

        Reads one attribute per input. Absent, None, NaN and whatever is no value for the input
        is UNKNOWN, and a guarantee is active only when it is TRUE. Never raises an Exception.
        """
        return self._rows(self.step(eddi_input))

    def as_json(self, output: Rows) -> Rows:
        """Return the rows: they are JSON already."""
        return output

    def series(self, output: Rows) -> Dict[str, Union[bool, float, str, None]]:
        """Return guarantee id -> is it active."""
        return {str(row["id"]): row["active"] is True for row in output}

    def verdicts(self) -> Dict[str, str]:
        """Return guarantee id -> ``TRUE``, ``UNKNOWN`` or ``FALSE`` after the last step."""
        values = self._graph.evaluate(self._leaf_values())
        return {
            name: NAMES[values[k]] for name, k in zip(self.guarantee_ids, self._graph.guarantees)
        }

    def input_verdicts(self) -> Dict[str, str]:
        """Return input id -> ``TRUE``, ``UNKNOWN`` or ``FALSE`` after the last step, filtered."""
        return {spec.id: NAMES[v] for spec, v in zip(self.inputs, self._leaf_values())}

    def best_guarantees(self) -> Dict[str, Optional[str]]:
        """Return provided service id -> its best active guarantee, ``None`` when none is active.

        The lowest ``ranking`` is best, then guarantees without one, in file order; a default
        guarantee comes last.
        """
        values = self._graph.evaluate(self._leaf_values())
        place = {g.id: k for k, g in enumerate(self._data.guarantees)}

        def rank(name: str) -> Tuple[bool, bool, int, int]:
            one = self._data.guarantees[place[name]]
            return one.default, one.ranking is None, one.ranking or 0, place[name]

        return {
            service.id: min(
                (name for name in service.guarantees if values[self._number[name]] == TRUE),
                key=rank,
                default=None,
            )
            for service in self._data.services
        }

    @overload
    def explain(
        self, guarantee_id: None = None, *, loss_sets: bool = False
    ) -> Tuple[Explanation, ...]: ...

    @overload
    def explain(self, guarantee_id: str, *, loss_sets: bool = False) -> Explanation: ...

    def explain(
        self, guarantee_id: Optional[str] = None, *, loss_sets: bool = False
    ) -> Union[Explanation, Tuple[Explanation, ...]]:
        """Return why a guarantee is active or not after the last step.

        Args:
            guarantee_id: as in the model or as published; None: all of them, in file order.
            loss_sets: find also the sets of several inputs whose loss ends an active guarantee.

        Raises:
            LookupError: there is no such guarantee; the message names those there are.
        """
        sets = Sets(self._graph, self._leaf_values())
        reasons = self.reasons()
        if guarantee_id is None:
            return tuple(
                self._explain(k, sets, reasons, loss_sets=loss_sets) for k in self._graph.guarantees
            )
        if guarantee_id not in self._number:
            there = ", ".join(self.guarantee_ids) or "none"
            raise LookupError(f"there is no guarantee {guarantee_id!r}; there: {there}")
        return self._explain(self._number[guarantee_id], sets, reasons, loss_sets=loss_sets)

    def _explain(
        self, node: int, sets: Sets, reasons: Dict[str, Reason], *, loss_sets: bool
    ) -> Explanation:
        active = sets.values[node] == TRUE
        missing, truncated = ([], False) if active else sets.missing(node)
        losses, more = sets.loss_sets(node) if active and loss_sets else ([], False)
        return Explanation(
            guarantee=self._graph.names[node],
            active=active,
            verdict=NAMES[sets.values[node]],
            missing=tuple(missing),
            single_losses=sets.single_losses(node) if active else (),
            loss_sets=tuple(losses),
            reasons={one: reasons[one] for group in missing for one in group},
            truncated=truncated or more,
        )

    def reasons(self) -> Dict[str, Reason]:
        """Return input id -> why it is not TRUE after the last step; TRUE inputs are left out."""
        found = {}
        for k, ((value, why), filtered) in enumerate(zip(self._judgements(), self._leaf_values())):
            if filtered != TRUE:
                found[self.inputs[k].id] = self._reason(k, value, why)
        return found

    def standings(self) -> Tuple[Standing, ...]:
        """Return every guarantee after the last step, and for an inactive one what it lacks.

        What is not known comes before what is known to be FALSE: where a guarantee is UNKNOWN,
        there is a set of inputs that are not known and would activate it.
        """
        leaf_values = tuple(self._leaf_values())
        values = self._graph.evaluate(leaf_values)
        groups, reasons = self._missing_groups(leaf_values), self.reasons()
        false = {spec.id for spec, value in zip(self.inputs, leaf_values) if value == FALSE}
        return tuple(
            _standing(name, active=values[k] == TRUE, groups=groups[k], false=false, why=reasons)
            for name, k in zip(self.guarantee_ids, self._graph.guarantees)
        )

    def accepted(self) -> Tuple[str, ...]:
        """Return ``input: key`` for each acceptance that was in use in the last step."""
        found = accepted(self.inputs, self._record.source)
        if not isinstance(self._filter, Majority):
            return found
        rows = zip(self.inputs, self._filter.values, self._judgements())
        held = (spec.id for spec, value, (now, _) in rows if value == TRUE and now != TRUE)
        return (*found, *(f"{name}: filter: majority" for name in held))

    def blocked(self, not_known: Iterable[str] = ()) -> Dict[str, Tuple[str, ...]]:
        """Return input id -> inactive guarantees that depend on it, for inputs not known now.

        Not known: missing, stale, NaN, or a value of a wrong type. An input that is well known to
        be FALSE is not listed: nothing is wrong with it.

        Args:
            not_known: inputs that count as not known even when they hold FALSE, such as one that
                still has its default because no message has come.
        """
        named = set(not_known)
        unknown = {
            k
            for k, (value, _) in enumerate(self._judgements())
            if value == UNKNOWN or self.inputs[k].id in named
        }
        sets = Sets(self._graph, self._leaf_values())
        found: Dict[int, List[str]] = {k: [] for k in sorted(unknown)}
        for name, node in zip(self.guarantee_ids, self._graph.guarantees):
            if unknown and sets.values[node] != TRUE:
                for k in sets.unknown_below(node, unknown):
                    found[k].append(name)
        return {self.inputs[k].id: tuple(names) for k, names in found.items() if names}

    def faults(self) -> Dict[str, str]:
        """Return input id -> what was wrong with its value in the last step."""
        return {
            self.inputs[k].id: describe(self._data.leaves[k], self._record.raw[k], FAULT)
            for k, (_, why) in enumerate(self._judgements())
            if why == FAULT
        }

    def fault_counts(self) -> Dict[str, int]:
        """Return input id -> in how many steps its value had a wrong type, since the start."""
        return {spec.id: n for spec, n in zip(self.inputs, self._record.fault_counts)}

    def decided(self, output: Rows) -> Dict[str, Union[bool, float, str, None]]:
        """Return the same: there is nothing but verdicts."""
        return self.series(output)

    def message(self, output: Any) -> Tree:
        """Return an output as a ``ConSertOutput`` tree; never raises.

        Only a bool is taken as active: a row that a person's code has spoilt is published as not
        active, and ``output_faults`` reports it.
        """
        tree, self._output_faults = output_message(output, self.published_ids)
        return tree

    def output_faults(self) -> Tuple[str, ...]:
        """Return what was wrong with the output that ``message`` was given last."""
        return self._output_faults

    def status_message(self) -> Tree:
        """Return the facts behind the last step as a ``ConSertStatus`` tree without header."""
        leaf_values = tuple(self._leaf_values())
        groups = self._missing_groups(leaf_values)
        values = self._graph.evaluate(leaf_values)
        rows = [
            (name, values[k], list(groups[k][0]) if groups[k] else [])
            for name, k in zip(self.guarantee_ids, self._graph.guarantees)
        ]
        return status_message(self.model_id, self.digest, rows, self.accepted())

    def reset(self) -> None:
        """Forget former steps: filters begin anew, inputs count as missing."""
        if self._filter is not None:
            self._filter.reset()
        fresh = compiler.Record(self._graph.leaves)
        self._record.raw, self._record.source = fresh.raw, fresh.source
        self._record.fault_counts[:] = fresh.fault_counts
        self._output_faults = ()

    def _judgements(self) -> List[Judgement]:
        return [judge(leaf, raw) for leaf, raw in zip(self._data.leaves, self._record.raw)]

    def _leaf_values(self) -> Sequence[int]:
        if self._filter is not None:
            return self._filter.values
        return [value for value, _ in self._judgements()]

    def _missing_groups(self, leaf_values: Sequence[int]) -> Dict[int, Groups]:
        """Return the sets of each guarantee; they cost more than a step: only on a change."""
        if self._groups[0] != leaf_values or not self._groups[1]:
            sets = Sets(self._graph, leaf_values)
            self._groups = (
                leaf_values,
                {
                    k: [] if sets.values[k] == TRUE else sets.missing(k)[0]
                    for k in self._graph.guarantees
                },
            )
        return self._groups[1]

    def _reason(self, leaf: int, value: int, why: str) -> Reason:
        raw = self._record.raw[leaf]
        if value == TRUE and self._filter is not None:
            return Reason("debouncing", self._filter.waiting(leaf))
        if why == MISSING:
            state = _state(self._record.source, self.inputs[leaf].id)
            if state is not None:
                return state
        return Reason(why, describe(self._data.leaves[leaf], raw, why))


def _standing(
    name: str, *, active: bool, groups: Groups, false: Set[str], why: Mapping[str, Reason]
) -> Standing:
    if active:
        return Standing("guarantee", name, active=True)
    if not groups:
        return Standing("guarantee", name, active=False, reason="nothing can activate it")
    group = next((one for one in groups if false.isdisjoint(one)), groups[0])
    lacks = tuple((one, why[one].text) for one in group)
    return Standing("guarantee", name, active=False, lacks=lacks)


def _state(source: object, input_id: str) -> Optional[Reason]:
    """Return the reason of ``EDDIInputBase`` for an input without a value, if any."""
    try:
        found: Any = source.states.get(input_id)  # type: ignore[attr-defined]  # asked, not known
        if found is None or found.state == "ok":
            return None
        return Reason(str(found.state), str(found.reason))
    except Exception:  # noqa: BLE001 - any object may be given as input
        return None
