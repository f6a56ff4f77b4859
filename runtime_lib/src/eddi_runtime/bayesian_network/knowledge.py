"""What is known of the nodes that inputs feed, and what is accepted in place of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Mapping, NamedTuple, Sequence, Tuple, Union

from ..inputs import InputSpec
from .engine import NodeSpec, Rows
from .methods import Answer

if TYPE_CHECKING:
    from .direct import DirectReader
    from .readers import Discretiser

Known = Union[str, Tuple[float, ...]]
"""A state, or likelihoods of which the largest is 1."""
NO_ANSWER = Answer()


class Source(NamedTuple):
    """A declared way from an input to a node."""

    node: int
    spec: InputSpec
    reader: Discretiser | DirectReader


class Step:
    """What the last step saw."""

    __slots__ = ("answer", "now", "problem", "raw", "rows", "states", "weights")

    def __init__(self, missing: Sequence[int]) -> None:
        self.now: float = 0  # its time in nanoseconds
        self.raw: Sequence[object] = ()  # the value of each source
        self.states = list(missing)  # of each observable node
        self.weights: dict[int, list[float]] = {}  # likelihoods, by position
        self.answer = NO_ANSWER  # of the methods
        self.rows: Rows | None = ()  # posteriors; None: the evidence has probability zero
        self.problem = ""  # what kept the step from being done


class Facts(NamedTuple):
    """What is known about the inputs of a step."""

    valid: bool  # all of them are known, and so are the states of their nodes
    # inputs without a usable value, whatever is accepted in their place; the node where only a
    # method observes it
    unknown_inputs: tuple[str, ...]
    # node -> states that it may be in, when there are several; the posterior takes the first
    undecided: Mapping[str, tuple[str, ...]]
    accepted: tuple[str, ...]  # ``input: key`` for each key of the configuration that was needed


def evidence_of(step: Step, nodes: Sequence[NodeSpec]) -> tuple[dict[str, Known], list[str]]:
    """Return observed node -> its state, or its likelihoods; and the nodes that are not."""
    found: dict[str, Known] = {}
    for position, (node, state) in enumerate(zip(nodes, step.states)):
        if position in step.weights:
            found[node.id] = tuple(step.weights[position])
        elif state < len(node.states):
            found[node.id] = node.states[state]
    return found, [one.id for one in nodes if one.id not in found]


def facts_of(
    step: Step,
    observable: Sequence[int],
    nodes: Sequence[NodeSpec],
    fed: Mapping[int, tuple[int, Source]],
) -> Facts:
    """Return what was known in a step."""
    unknown: list[str] = []
    accepted: list[str] = []
    undecided: dict[str, tuple[str, ...]] = {}
    for position, node in enumerate(observable):
        if node in step.answer.findings:
            continue
        if node not in fed or node in step.answer.problems:
            unknown.append(nodes[node].id)
            continue
        number, (_, spec, reader) = fed[node]
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
            states = (taken, *(one for one in reader.possible if one != taken))
            undecided[nodes[node].id] = tuple(nodes[node].states[state] for state in states)
    failed = step.rows is None or step.problem or step.answer.problems
    valid = not (unknown or undecided or failed)
    return Facts(valid, tuple(dict.fromkeys(unknown)), undecided, tuple(dict.fromkeys(accepted)))
