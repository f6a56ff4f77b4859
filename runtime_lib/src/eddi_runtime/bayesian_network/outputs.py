"""What was known in a step of a Bayesian network monitor, and what it gives (D7.2 Fig 18)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Sequence, Tuple, Union

from ..inputs import InputSpec
from ..monitor import Json, Tree, rows_of
from ..plain_values import plain
from .engine import Rows
from .evidence import Answer

if TYPE_CHECKING:
    from .direct import DirectReader
    from .readers import Discretiser

Known = Union[str, Tuple[float, ...]]  # a state, or likelihoods of which the largest is 1
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


OK, PARTIAL, PRIOR, INCONSISTENT, ERROR = range(5)
"""Status: all observed; some not; none; evidence of probability zero; a person's method failed."""
STATUS_NAMES = ("ok", "partial", "prior", "inconsistent", "error")


class _Record:
    """Equal to another one with equal values, and shown with their names."""

    def __eq__(self, other: object) -> bool:
        return vars(self) == vars(other) if type(other) is type(self) else NotImplemented

    def as_json(self) -> dict[str, Json]:
        return {
            name: [one.as_json() for one in value] if isinstance(value, list) else value
            for name, value in vars(self).items()
        }

    __hash__ = None  # type: ignore[assignment]  # the values may change

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={value!r}" for name, value in vars(self).items())
        return f"{type(self).__name__}({shown})"


class Outcome(_Record):
    """The probability of one state."""

    def __init__(self, name: str, value: float) -> None:
        self.name = name
        self.value = value


class Node(_Record):
    """The posterior of one output; the title is the name of the node."""

    def __init__(self, title: str, outcomes: list[Outcome]) -> None:
        self.title = title
        self.outcomes = outcomes


class Claim(NamedTuple):
    """Result of a threshold in the last step."""

    id: str  # of the threshold
    active: bool  # the probability is on the right side for every state that is possible
    low: float  # lower bound of the probability; NaN: not computed
    high: float  # upper bound
    reason: str  # why it is not active; empty when it is, or is known to be on the wrong side

    def bounds(self, form: str) -> str:
        """Return the bounds for people, empty where they were not computed."""
        if math.isnan(self.low):
            return ""
        low, high = format(self.low, form), format(self.high, form)
        return low if self.low == self.high else f"{low} to {high}"

    def text(self) -> str:
        active, bounds = "active" if self.active else "not active", self.bounds(".3g")
        reason = f" ({self.reason})" if self.reason else ""
        return f"{self.id}: {active}{', ' if bounds else ''}{bounds}{reason}"


class BayesianNetworkOutput(_Record):
    """The posteriors of all outputs, in the order of the network."""

    def __init__(self, actor_id: int, bayesian_network_id: str, output_nodes: list[Node]) -> None:
        self.actor_id = actor_id
        self.bayesian_network_id = bayesian_network_id
        self.output_nodes = output_nodes


class Monitor:
    """The base class of D7.2's monitors."""

    def execute_step(self, eddi_input: object, t_ns: int | None = None) -> object:
        """Evaluate once."""
        raise NotImplementedError


def output_message(output: object) -> tuple[Tree | list[Tree] | None, tuple[str, ...]]:
    """Return the tree of an output, None for none, and what was wrong; never raises."""
    rows = rows_of(output)
    if rows is None:
        return None, ("the output is not a list; nothing is published",)
    faults: list[str] = []
    trees: list[Tree] = []
    for one in rows:
        try:
            nodes = [_node_tree(node) for node in one.output_nodes]
            trees.append(("BayesianNetworkOutput", {"output_nodes": nodes}))
        except Exception as problem:  # noqa: BLE001, PERF203 - a person's code may have put anything there
            faults.append(f"an output cannot be published: {type(problem).__name__}")
    return trees[0] if len(trees) == 1 else trees or None, tuple(faults)


def _node_tree(node: Any) -> Tree:
    outcomes = [_outcome_tree(outcome) for outcome in node.outcomes]
    return "NodeOutput", {"title": _text(node.title), "outcomes": outcomes}


def _outcome_tree(outcome: Any) -> Tree:
    value = plain(outcome.value)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError("an outcome is no finite number")
    return "OutcomeOutput", {"outcome_name": _text(outcome.name), "outcome_value": float(value)}


def _text(value: Any) -> str:
    text = plain(value)
    if not isinstance(text, str):
        raise TypeError("a name is no text")
    return text
