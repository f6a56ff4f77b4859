"""What was known in a step of a Bayesian network monitor, and what it gives (D7.2 Fig 18).

Virtual evidence is a likelihood, P(observation | state) (Pearl 1988, 2.2.2), as in GeNIe.
"""

from __future__ import annotations

import math
from functools import partial
from types import SimpleNamespace
from typing import Any, List, Mapping, NamedTuple, Sequence, Tuple, Union

from ..monitor import Json, Tree
from ..plain_values import exactly, one_line, plain, show
from .engine import Engine, NodeSpec, Rows

Finding = Union[None, int, List[float]]
"""None: nothing is known. A number: the state, for sure. A list: likelihoods, the largest is 1."""
Reading = Union[int, List[float]]
"""A state, the number of states for "not observed", or likelihoods."""

_EPSILON = 2.220446049250313e-16


class EvidenceError(ValueError):
    """Values are no evidence; the message names the state and the value."""


def finding(values: Sequence[object], states: Sequence[str], *, virtual: bool = True) -> Finding:
    """Return the finding in one number per state, or raise EvidenceError.

    All zero: nothing. One other than zero: that state for sure. Several: likelihoods, of which
    only the ratios count. Not ``virtual`` (D7.2's generated code): exactly one 1.0 among zeros is
    the state, everything else is nothing.
    """
    numbers: Sequence[Any] = values  # what is none raises TypeError, or is found by its type
    count = len(numbers)
    if count != len(states):
        raise EvidenceError(f"{count} values for {len(states)} states")
    zeros = numbers.count(0.0)
    if zeros == count:
        return None
    if virtual and zeros == count - 1:
        try:  # the usual case, four times faster
            largest = max(numbers)
            if 0.0 < largest < math.inf:
                return numbers.index(largest)
        except TypeError:
            pass
    elif virtual and set(map(type, numbers)) == {float} and min(numbers) >= 0.0:
        largest = max(numbers)
        if sum(numbers) < math.inf:  # so none is NaN
            return [number / largest for number in numbers]
    checked = [_number(value, state) for value, state in zip(values, states)]
    if not virtual:
        sure = [k for k, number in enumerate(checked) if abs(number - 1.0) <= _EPSILON]
        return sure[0] if len(sure) == 1 and abs(sum(checked) - 1.0) <= _EPSILON else None
    others = [k for k, number in enumerate(checked) if number]
    if len(others) < 2:
        return others[0] if others else None
    largest = max(checked)
    return [number / largest for number in checked]


def outcomes_finding(
    outcomes: Mapping[str, object], states: Sequence[str], *, virtual: bool = True
) -> Finding:
    """Return the finding in state -> number (SESAME D7.2 Fig 15), or EvidenceError."""
    if tuple(outcomes) == states:  # as generated
        return finding(list(outcomes.values()), states, virtual=virtual)
    try:
        values = [outcomes[state] for state in states]
    except KeyError as problem:
        raise EvidenceError(f"there is no outcome for the state {problem.args[0]!r}") from None
    if len(outcomes) != len(states):
        unknown = sorted(str(outcome) for outcome in outcomes if outcome not in states)
        raise EvidenceError(f"there is no state {', '.join(unknown)}")
    return finding(values, states, virtual=virtual)


def _number(value: object, state: str) -> float:
    number = plain(value)
    if number is None or isinstance(number, str):
        raise EvidenceError(f"{state} is {show(value)}, which is no number")
    if not 0.0 <= number < math.inf:
        raise EvidenceError(f"{state} is {show(value)}, not a finite number from 0 on")
    return float(number)


_Method = Tuple[int, str, Tuple[str, ...], Any]
"""Number of a node, name of its method, states of the node; another one in place of it."""


class Answer:
    """Results of the methods of one step."""

    __slots__ = ("findings", "outputs", "problems")

    def __init__(self) -> None:
        # node -> its evidence; nodes that were left at zero are not in it
        self.findings: dict[int, Reading] = {}
        self.outputs: set[int] = set()  # nodes that were flagged as outputs
        self.problems: dict[int, str] = {}  # node -> why its method gave nothing

    def put(self, engine: Engine, states: list[int], weights: dict[int, list[float]]) -> None:
        """Replace what was declared by the results of the methods."""
        positions, missing = engine.positions, engine.missing
        for node in self.problems:  # it would have set what is not known
            if node in positions:
                states[positions[node]] = missing[positions[node]]
                weights.pop(positions[node], None)
        for node, finding in self.findings.items():
            position = positions[node]
            if isinstance(finding, int):
                states[position] = finding
                weights.pop(position, None)
            else:
                states[position], weights[position] = missing[position], finding


class Methods:
    """The methods of an object, one per node that has one.

    One that can read nothing, mostly without hand-written code, is asked once. Every other one
    counts as an observation of its node.
    """

    def __init__(self, hooks: object, nodes: Sequence[NodeSpec], *, virtual: bool) -> None:
        self._hooks: Any = hooks
        self._virtual = virtual
        self._data = SimpleNamespace(data=None)  # D7.2's methods take `.data` of it
        self._asked: list[_Method] = []
        self._constant = Answer()
        # nodes that are flagged as outputs, as far as that is known before the first step
        self.outputs: set[int] = set()
        for node, spec in enumerate(nodes):
            name = f"node_{spec.attribute}"
            method: Any = getattr(hooks, name, None)
            if method is None:
                continue
            function: Any = getattr(method, "__func__", None)
            code: Any = getattr(function, "__code__", None)
            # Asked without its object: a method that uses that alone may change its result, too.
            if code is not None and _reads_nothing(code):
                self._ask([(node, name, spec.states, partial(function, _NOBODY))], self._constant)
                if self._constant.problems.pop(node, None) is None:
                    continue
            self._asked.append((node, name, spec.states, None))
            if code is not None and any(constant is True for constant in code.co_consts):
                self.outputs.add(node)
        # nodes that a method observes, or may observe
        self.observed = {*self._constant.findings, *(node for node, *_ in self._asked)}
        self.outputs |= self._constant.outputs

    def ask(self, eddi_input: object) -> Answer:
        """Call every method that may change its result; what one raises is noted."""
        if not self._asked:
            return self._constant
        answer = Answer()
        answer.findings.update(self._constant.findings)
        answer.outputs |= self._constant.outputs
        self._data.data = eddi_input
        try:
            self._hooks.update_dra_data(self._data)
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            reason = f"update_dra_data raised {one_line(problem)}"
            answer.problems.update((node, reason) for node, *_ in self._asked)
        else:
            self._ask(self._asked, answer)
        return answer

    def _ask(self, asked: Sequence[_Method], answer: Answer) -> None:
        hooks, virtual = self._hooks, self._virtual
        for node, name, states, other in asked:
            try:
                is_output, outcomes = (other or getattr(hooks, name))()
                if is_output:
                    answer.outputs.add(node)
                finding = outcomes_finding(outcomes, states, virtual=virtual)
                if finding is not None:
                    answer.findings[node] = finding
                elif not virtual and any(outcomes.values()):
                    answer.problems[node] = f"{name}: evidence_mode d7.2 drops its outcomes"
            except EvidenceError as problem:  # noqa: PERF203 - what the others say counts
                answer.problems[node] = f"{name}: {problem}"
            except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
                answer.problems[node] = f"{name} raised {one_line(problem)}"


class _Nobody:
    """Is given to a method in place of its object; what asks it anything fails."""

    def _asked(self, *_: object) -> Any:
        raise TypeError

    __bool__ = __eq__ = __ne__ = __str__ = __repr__ = __format__ = __hash__ = _asked


_NOBODY = _Nobody()


def _reads_nothing(code: Any) -> bool:
    """Return whether a method has nothing to read from: no names, no attributes, no closure."""
    return (
        not (code.co_names or code.co_freevars or code.co_cellvars)
        and (code.co_argcount, code.co_kwonlyargcount) == (1, 0)
        and not any(isinstance(co_const, type(code)) for co_const in code.co_consts)
    )


Known = Union[str, Tuple[float, ...]]  # a state, or likelihoods of which the largest is 1
NO_ANSWER = Answer()


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
    # inputs without a usable value; the node where only a method observes it
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
            name: [item.as_json() for item in value] if isinstance(value, list) else value
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


def output_tree(output: Any) -> Tree:
    """Return an output as a message tree; whatever a person's code made of it may raise."""
    nodes: list[Tree] = []
    for node in output.output_nodes:
        outcomes: list[Any] = []
        for outcome in node.outcomes:
            value: Any = plain(outcome.value)
            if type(value) not in (int, float) or not math.isfinite(value):
                raise TypeError(f"{show(outcome.value)} is no finite number")
            fields = {"outcome_name": exactly(str, outcome.name), "outcome_value": float(value)}
            outcomes.append(("OutcomeOutput", fields))
        nodes.append(("NodeOutput", {"title": exactly(str, node.title), "outcomes": outcomes}))
    return "BayesianNetworkOutput", {"output_nodes": nodes}
