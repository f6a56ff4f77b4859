"""What ``compiled.py`` holds of a network: names, tables, and what is done with them in a step."""

from __future__ import annotations

from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Union,
)

if TYPE_CHECKING:
    from ..thresholds import Threshold

Rows = Sequence[Sequence[float]]
States = Sequence[int]
Weights = Mapping[int, Sequence[float]]
Posteriors = List[List[float]]
Cases = Mapping[Tuple[int, ...], Optional[Rows]]


_NO_CASES: Cases = {}


class NodeSpec(NamedTuple):
    """A node: its name, its states, and its method ``node_<attribute>``."""

    id: str
    states: Tuple[str, ...]
    attribute: str


class StateThreshold(NamedTuple):
    """A threshold of the probability of some states of a node.

    Attributes:
        node: number of the node.
        states: numbers of the states whose probabilities are added up.
        at_least: the probability must not be below; else it must not be above.
        limits: where it begins and ends; of the negative probability for ``at_least``.
    """

    node: int
    states: Tuple[int, ...]
    at_least: bool
    limits: Threshold


class Table(NamedTuple):
    """P(output, what is observed) of one output.

    Attributes:
        card: number of states of the output; 1 if it is the probability of the evidence alone.
        strides: (position of an input, distance between the rows of its states).
        rows: one for each case; a state behind those of an input represents "not observed".
            Empty where ``total`` gives them.
        total: vectors of the inputs -> the row, summed over all states; None for a large table.
    """

    card: int
    strides: Tuple[Tuple[int, int], ...]
    rows: Rows = ()
    total: Optional[Callable[[Sequence[Sequence[float]]], List[float]]] = None


class Tables(NamedTuple):
    """The tables of a small part, one for each output.

    Attributes:
        tables: one for each output; one for the evidence if there is no output.
        priors: position of an input -> its prior, where that is not in the tables.
        bind: rows of each table -> the look-up: states -> a row of each table.
    """

    tables: Tuple[Table, ...]
    priors: Mapping[int, Sequence[float]]
    bind: Callable[..., Callable[[States], Rows]]


class Message(NamedTuple):
    """A message of a join tree.

    Attributes:
        kind: ``product``, ``table``, ``evidence``, ``prior`` (evidence with it) or ``unit``.
        parts: numbers of the messages that are multiplied; of a ``table``, its node.
        nodes: it has an axis for each; what the parts have beyond them is summed out.
        inputs: observable nodes that known numbers depend on, one axis each before the nodes.
        known: its numbers are made when the monitor starts, for every case of its inputs.
    """

    kind: str
    parts: Tuple[int, ...]
    nodes: Tuple[int, ...]
    inputs: Tuple[int, ...]
    known: bool


class Steps(NamedTuple):
    """Operations on arrays that are made when the monitor starts.

    Attributes:
        slots: how each array is made; see ``schedule``.
        bind: (numpy, arrays) -> the step: states -> a row for each output.
        operations: (function, slot, ...), where there is no ``bind``.
        answers: slot with the row of each output, where there is no ``bind``.
    """

    slots: Tuple[Tuple[Any, ...], ...]
    bind: Optional[Callable[..., Callable[[States], Posteriors]]] = None
    operations: Tuple[Tuple[Any, ...], ...] = ()
    answers: Tuple[int, ...] = ()


class Schedule(NamedTuple):
    """The operations of a large part, for numpy.

    Attributes:
        nodes: number -> (numbers of the parents, table of its probabilities), of the whole file.
        messages: fields of ``Message``, each behind its parts.
        answers: the message that gives the row of each output; without outputs, the messages whose
            product, summed, is the probability of the evidence.
        hard: for steps without virtual evidence: messages of few inputs are looked up.
        full: for any evidence; None where each observable node is observed.
    """

    nodes: Mapping[int, Tuple[Tuple[int, ...], Rows]]
    messages: Tuple[Tuple[Any, ...], ...]
    answers: Tuple[int, ...]
    hard: Optional[Steps]
    full: Optional[Steps]


class Part(NamedTuple):
    """A part of a network; no evidence connects it with the others.

    Attributes:
        made: its tables or its schedule.
        inputs: positions of its observable nodes among those of the program.
        outputs: nodes whose rows it gives; empty for the probability of the evidence alone.
        least: lower bound of the exponent of any product of its non-zero probabilities.
    """

    made: Union[Tables, Schedule]
    inputs: Tuple[int, ...]
    outputs: Tuple[int, ...]
    least: int


class Program(NamedTuple):
    """Inference for some outputs and observable nodes.

    Attributes:
        outputs: nodes whose posteriors can be asked for, ascending.
        observable: nodes that may be observed, ascending; evidence goes by position here.
        parts: all that can matter.
        when_observed: in place of them in steps in which each observable node is observed.
        cases: states -> posteriors, where there are few; None: they are impossible.
    """

    outputs: Tuple[int, ...]
    observable: Tuple[int, ...]
    parts: Tuple[Part, ...]
    when_observed: Tuple[Part, ...] = ()
    cases: Cases = _NO_CASES
