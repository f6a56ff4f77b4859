"""What a configuration and the command line choose: published ids, filters, default guarantees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.kinds.consert import OPTION_KEYS, published_class
from eddi_scaffold.kinds.consert.consert import ConSert
from eddi_scaffold.yaml_text.nodes import shown

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Options

_FILTERS = {"debounce": "regain_after", "majority": "window"}
_MAX_SAMPLES = 100_000  # Longest history of a filter; at 1 kHz that is 100 s


@dataclass(frozen=True)
class ConSertOptions:
    """What a configuration chooses."""

    # `source`: messages have the ids of the model; `class`: SESAME D7.2's names of classes
    guarantee_ids: str = "source"
    filter: str = ""  # `debounce` or `majority` of the leaves, empty for none
    filter_steps: int = 1  # over how many steps

    def published(self, id_: str) -> str:
        """Return the id of a guarantee in messages."""
        return published_class(id_) if self.guarantee_ids == "class" else id_

    def hold_s(self, frequency: float) -> float:
        """Return for how many seconds a majority may hold after it was lost: half its window."""
        return self.filter_steps // 2 / frequency if self.filter == "majority" else 0.0


def read_options(options: Options) -> tuple[ConSertOptions | None, list[Problem]]:
    """Read the ConSert's own keys of ``Model:``; ``debounce`` is short for one ``filter``."""
    problems: list[Problem] = []
    ids, debounce, filter_ = (options.values.get(key) for key in OPTION_KEYS)
    if ids not in (None, "source", "class"):
        problems.append(problem("K003.guarantee_ids", options.place("guarantee_ids")))
    place = options.place("filter" if debounce is None else "debounce")
    if debounce is not None and filter_ is not None:
        problems.append(problem("K003.debounce_and_filter", place))
    if debounce is not None:
        filter_ = {"kind": "debounce", "regain_after": debounce}
    kind: Any = "none"
    steps: Any = 1
    if isinstance(filter_, Mapping):
        kind = filter_.get("kind")
        key = _FILTERS.get(kind) if isinstance(kind, str) else None
        steps = filter_.get(key, 1) if key else 1
        if key is None and kind != "none":
            problems.append(problem("K028.filter", place, kind=kind))
        elif type(steps) is not int or not 1 <= steps <= _MAX_SAMPLES:
            key = key if debounce is None else "debounce"
            problems.append(problem("K028.steps", place, key=key, limit=_MAX_SAMPLES))
    elif filter_ is not None:
        problems.append(problem("K003.filter", place))
    if problems:
        return None, problems
    return ConSertOptions(str(ids or "source"), str(kind) if steps > 1 else "", steps), []


def with_default_guarantees(
    conserts: Sequence[ConSert], marks: Sequence[str], file: str
) -> tuple[tuple[ConSert, ...], list[Problem]]:
    """Mark guarantees of a file as default ones, for who may not change the file.

    A mark is ``ID``, or ``CONSERT/ID`` where several ConSerts have that id; one that fits none or
    several is an error (C008).
    """
    pairs = {(consert.name, node.id): None for consert in conserts for node in consert.guarantees}
    chosen: set[tuple[str, str]] = set()
    problems: list[Problem] = []
    for mark in dict.fromkeys(marks):
        exact = [pair for pair in pairs if "/".join(pair) == mark]
        named = exact or [pair for pair in pairs if pair[1] == mark]
        if not named:
            hint = did_you_mean(
                mark, [name for pair in pairs for name in (pair[1], "/".join(pair))]
            )
            fields = {"mark": mark, "guarantee": shown(mark)}
            problems.append(problem("C008.no_guarantee", Place(file), hint=hint, **fields))
        elif len(named) > 1:
            names = " or ".join("/".join(pair) for pair in named)
            problems.append(problem("C008.several", Place(file), mark=mark, names=names))
        chosen.update(named)
    marked = []
    for consert in conserts:
        guarantees = tuple(
            replace(node, default=node.default or (consert.name, node.id) in chosen)
            for node in consert.guarantees
        )
        marked.append(replace(consert, guarantees=guarantees))
    return tuple(marked), problems
