"""What is known of the nodes that inputs feed, and what is accepted in place of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

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
    reader: Union[Discretiser, DirectReader]


class Step:
    """What the last step saw.

    Attributes:
        now: its time in nanoseconds.
        raw: the value of each source.
        states: of each observable node.
        weights: likelihoods, by position.
        answer: of the methods.
        rows: posteriors; None: the evidence has probability zero.
        problem: what kept the step from being done.
    """

    __slots__ = ("answer", "now", "problem", "raw", "rows", "states", "weights")

    def __init__(self, missing: Sequence[int]) -> None:
        self.now: float = 0
        self.raw: Sequence[object] = ()
        self.states = list(missing)
        self.weights: Dict[int, List[float]] = {}
        self.answer = NO_ANSWER
        self.rows: Optional[Rows] = ()
        self.problem = ""


class Facts(NamedTuple):
    """What is known about the inputs of a step.

    Attributes:
        valid: all of them are known, and so are the states of their nodes.
        unknown_inputs: inputs without a usable value, whatever is accepted in their place; the
            node where only a method observes it.
        undecided: node -> states that it may be in, when there are several; the posterior takes
            the first.
        accepted: ``input: key`` for each key of the configuration that was needed.
    """

    valid: bool
    unknown_inputs: Tuple[str, ...]
    undecided: Mapping[str, Tuple[str, ...]]
    accepted: Tuple[str, ...]


def evidence_of(step: Step, nodes: Sequence[NodeSpec]) -> Tuple[Dict[str, Known], List[str]]:
    """Return observed node -> its state, or its likelihoods; and the nodes that are not observed.

    Args:
        step: what it saw.
        nodes: the observable ones.
    """
    found: Dict[str, Known] = {}
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
    fed: Mapping[int, Tuple[int, Source]],
) -> Facts:
    """Return what was known in a step.

    Args:
        step: what it saw.
        observable: numbers of the observable nodes.
        nodes: of the network.
        fed: node -> number of the source that feeds it, and the source.
    """
    unknown: List[str] = []
    accepted: List[str] = []
    undecided: Dict[str, Tuple[str, ...]] = {}
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
            undecided[nodes[node].id] = tuple(nodes[node].states[one] for one in states)
    failed = step.rows is None or step.problem or step.answer.problems
    valid = not (unknown or undecided or failed)
    return Facts(valid, tuple(dict.fromkeys(unknown)), undecided, tuple(dict.fromkeys(accepted)))
