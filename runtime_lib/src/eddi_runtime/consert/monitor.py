"""The monitor of a ConSert: which guarantees of a system hold, from what is known right now."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterable, Iterator, List, Sequence, overload

from ..inputs import accepted, look_again, states_of, step_time
from ..monitor import Monitor, Tree, row_trees
from ..plain_values import ABSENT, exactly, plain, read
from ..why import TRUE, Cause
from .verdicts import (
    FAULT,
    NAMES,
    Explanation,
    Guarantee,
    Judgement,
    Leaf,
    Sets,
)

if TYPE_CHECKING:  # travels where a monitor has one
    from .filters import LeafFilter
    from .search import Graph

Rows = List[Dict[str, object]]
_NEVER = -1  # truth of an input before the first step


class ConSert(Monitor[Rows]):
    """What the class ``Monitor`` of a compiled ConSert inherits.

    Ids in the output are those of ``guarantee_ids``; everywhere else those of the model.
    """

    kind = "consert"
    leaves: tuple[Leaf, ...]  # how each of the inputs is judged
    guarantees: tuple[Guarantee, ...]  # in file order
    graph: Graph | None = None  # where the sets of a guarantee are too many to be written down
    services: tuple[tuple[str, tuple[str, ...]], ...] = ()  # each with ids of its guarantees
    raw: Sequence[object]  # of the last step, ``Absent`` where an input could not be read
    _seen: Sequence[object]  # ``raw``, or what the filter gave, when they were looked at last
    # truth of each input then, from when on it has been that, and from when on it is not TRUE
    _noted: list[tuple[int, int | None, int | None]]
    _found: Sets | None

    def __init__(self, leaf_filter: LeafFilter | None = None) -> None:
        self.filter = leaf_filter  # of the truth values of the inputs
        self.guarantee_ids = tuple(guarantee.id for guarantee in self.guarantees)
        self.published_ids = tuple(row.published or row.id for row in self.guarantees)
        self._input_ids = tuple(spec.id for spec in self.inputs)
        self._named = dict(zip(self.published_ids, self.guarantees))
        self._named.update(zip(self.guarantee_ids, self.guarantees))
        self.reset()

    def step(self, source: object) -> tuple[bool, ...]:
        """Return active flags in file order; never raises. Small models write this out."""
        self.raw, self._source = self.read(source), source
        values: Sequence[int] = [self.judge(k, value) for k, value in enumerate(self.raw)]
        if self.filter is not None:
            values = self.filter.apply(values)
        sets = self._sets_of(values)
        return tuple([sets.value(guarantee) == TRUE for guarantee in self.guarantees])

    def read(self, source: object) -> tuple[object, ...]:
        return tuple([read(source, spec.attribute, spec.id) for spec in self.inputs])

    def judge(self, leaf: int, raw: object) -> int:
        return self.leaves[leaf].judge(raw)[0]

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> Rows:
        """Return ``{'id': ..., 'active': ...}`` for each guarantee, in file order.

        Absent, None, NaN and whatever is no value for the input is UNKNOWN; active is TRUE alone.
        """
        look_again(eddi_input, t_ns)
        flags = self.step(eddi_input)
        self.look(t_ns)
        return [{"id": id_, "active": flag} for id_, flag in zip(self.published_ids, flags)]

    def look(self, t_ns: int | None) -> None:
        """Note at the end of a step since when inputs are what they are, where one is another."""
        self._at = t_ns
        seen: Sequence[object] = self.raw if self.filter is None else self.filter.values
        try:
            if seen == self._seen:
                return
        except Exception:  # noqa: BLE001, S110 - values may compare as they like
            pass
        now = step_time(t_ns)
        for k, (value, before) in enumerate(zip(seen, self._seen)):
            if value is not before:
                truth = self.judge(k, value) if self.filter is None else self.filter.values[k]
                last, began, lost = self._noted[k]
                if truth != last:
                    began, lost = now, now if last in (TRUE, _NEVER) else lost
                self._noted[k] = truth, began, lost
        self._seen = seen

    def _whys(self) -> Iterator[tuple[str, int, Iterable[Cause]]]:
        """Return the causes of the set of inputs that is nearest to TRUE, for each guarantee."""
        sets, values = self._sets(), self._leaf_values()

        def distance(group: list[int]) -> tuple[object, ...]:
            return -min([values[k] for k in group], default=TRUE), len(group), sorted(group)

        places = self._places()
        for guarantee, name in zip(self.guarantees, self.published_ids):
            if not guarantee.default:
                groups = [[places[id_] for id_ in group] for group in sets.missing(guarantee)[0]]
                nearest = min(groups, key=distance, default=[])
                nearest.sort(key=lambda k: (self._noted[k][2] or 0, k))
                yield name, sets.value(guarantee), [c for k in nearest for c in self._of_leaf(k)]

    def _of_leaf(self, k: int) -> list[Cause]:
        value, why = self.leaves[k].judge(self.raw[k])
        since = self._lasting(self._noted[k][1])
        if value == TRUE and self.filter is not None:
            own = Cause((), "hold", self.filter.waiting(k))
            return [own._replace(path=(self._input_ids[k],), since=since)]
        own = self.leaves[k].cause(self.raw[k], why)
        return self._of_input(self.inputs[k], value, since, own)

    def series(self, output: Rows) -> dict[str, bool | float | str | None]:
        return {str(row["id"]): row["active"] is True for row in output}

    def verdicts(self) -> dict[str, str]:
        """Return guarantee id -> ``TRUE``, ``UNKNOWN`` or ``FALSE`` after the last step."""
        sets = self._sets()
        return {guarantee.id: NAMES[sets.value(guarantee)] for guarantee in self.guarantees}

    def input_verdicts(self) -> dict[str, str]:
        """Return input id -> ``TRUE``, ``UNKNOWN`` or ``FALSE`` after the last step, filtered."""
        return {spec.id: NAMES[v] for spec, v in zip(self.inputs, self._leaf_values())}

    def best_guarantees(self) -> dict[str, str | None]:
        """Return service id -> its best active guarantee, None when none is active.

        The lowest ``ranking`` is best, then those without, in file order; a default comes last.
        """
        sets = self._sets()
        active = [guarantee for guarantee in self.guarantees if sets.value(guarantee) == TRUE]
        active.sort(key=lambda row: (row.default, row.ranking is None, row.ranking or 0))
        return {
            service: next((row.id for row in active if row.id in names), None)
            for service, names in self.services
        }

    @overload
    def explain(self, guarantee_id: None = None) -> tuple[Explanation, ...]: ...

    @overload
    def explain(self, guarantee_id: str) -> Explanation: ...

    def explain(self, guarantee_id: str | None = None) -> Explanation | tuple[Explanation, ...]:
        """Return why a guarantee, by either id, is active or not; None: all of them.

        An unknown id is a LookupError that names those there are.
        """
        sets, places = self._sets(), self._places()
        if guarantee_id is None:
            return tuple([self._explain(guarantee, sets, places) for guarantee in self.guarantees])
        if guarantee_id not in self._named:
            there = ", ".join(self.guarantee_ids) or "none"
            raise LookupError(f"there is no guarantee {guarantee_id!r}; there: {there}")
        return self._explain(self._named[guarantee_id], sets, places)

    def _explain(self, guarantee: Guarantee, sets: Sets, places: dict[str, int]) -> Explanation:
        value, (missing, truncated) = sets.value(guarantee), sets.missing(guarantee)
        return Explanation(
            guarantee=guarantee.id,
            active=value == TRUE,
            verdict=NAMES[value],
            missing=tuple(missing),
            single_losses=sets.single_losses(guarantee) if value == TRUE else (),
            reasons={name: self._reason(places[name]) for name in sorted(set().union(*missing))},
            truncated=truncated,
            robots=self._robots(guarantee),
        )

    def _reason(self, k: int) -> str:
        return "; ".join([cause._replace(path=cause.path[1:]).chain for cause in self._of_leaf(k)])

    def _places(self) -> dict[str, int]:
        return {name: k for k, name in enumerate(self._input_ids)}

    def robots(self, guarantee_id: str) -> tuple[str, ...]:
        names = self._robots(self._named[guarantee_id]).values()
        return tuple(sorted({robot for robots in names for robot in robots}))

    def _robots(self, guarantee: Guarantee) -> dict[str, tuple[str, ...]]:
        states = states_of(self._source).items()
        words = {name: state.robots for name, state in states if state.robots}
        if not words:  # as for most robots: nothing is to be found out
            return {}
        return {name: words[name] for name in self._sets().granting(guarantee) if name in words}

    def accepted(self) -> tuple[str, ...]:
        words = accepted(self.inputs, self._source)
        if self.filter is None or not self.filter.accepts:
            return words
        rows = zip(self.inputs, self.filter.values, self._judgements())
        held = (spec.id for spec, value, (now, _) in rows if value == TRUE and now != TRUE)
        return (*words, *(f"{name}: {self.filter.accepts}" for name in held))

    def faults(self) -> dict[str, str]:
        return {
            self.inputs[k].id: self.leaves[k].fault(self.raw[k])
            for k, (_, why) in enumerate(self._judgements())
            if why == FAULT
        }

    def message(self, output: object) -> Tree:
        """Return a ``ConSertOutput`` tree; what is spoilt is published as not active."""
        spoilt: list[str] = []

        def tree_of(row: Any) -> Tree:
            name, active = exactly(str, row["id"]), plain(row["active"])
            if not isinstance(active, bool):
                spoilt.append(f"'active' of {name!r} is not a bool; published as not active")
            return "Guarantee", {"id": name, "active": active is True}

        trees, faults = row_trees(output, tree_of)
        if trees is None:
            trees = [("Guarantee", {"id": id_, "active": False}) for id_ in self.published_ids]
        self._output_faults = (*faults, *spoilt)
        return "ConSertOutput", {"guarantees": trees}

    def status_message(self) -> Tree:
        sets = self._sets()
        rows: list[Tree] = []
        for guarantee in self.guarantees:
            verdict, missing = sets.value(guarantee), [*(*sets.missing(guarantee)[0], ())[0]]
            fields: Any = {"id": guarantee.id, "verdict": verdict, "missing": missing}
            rows.append(("GuaranteeStatus", fields))
        return "ConSertStatus", {
            "model_id": self.model_id,
            "model_digest": self.digest,
            "guarantees": rows,
            "accepted": list(self.accepted()),
        }

    def reset(self) -> None:
        if self.filter is not None:
            self.filter.reset(len(self.inputs))
        size = len(self.inputs)
        self._seen, self._noted = (_NEVER,) * size, [(_NEVER, None, None)] * size
        self.raw = (ABSENT,) * len(self.inputs)
        self._source = self._at = None
        self._output_faults = ()
        self._found = None

    def _judgements(self) -> list[Judgement]:
        return [leaf.judge(raw) for leaf, raw in zip(self.leaves, self.raw)]

    def _leaf_values(self) -> Sequence[int]:
        if self.filter is not None:
            return self.filter.values
        return [value for value, _ in self._judgements()]

    def _sets(self) -> Sets:
        leaf_values = tuple(self._leaf_values())
        if self._found is None or self._found.leaf_values != leaf_values:
            self._found = self._sets_of(leaf_values)
        return self._found

    def _sets_of(self, leaf_values: Sequence[int]) -> Sets:
        if self.graph is None:
            return Sets(self._input_ids, leaf_values)
        return self.graph.sets(leaf_values)
