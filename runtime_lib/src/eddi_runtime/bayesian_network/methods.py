"""The methods ``node_<name>`` in which a person turns data into evidence (SESAME D7.2 Fig 15)."""

from __future__ import annotations

from functools import partial
from typing import Any, Callable, Dict, List, Mapping, NoReturn, Optional, Sequence, Set, Tuple

from ..plain_values import one_line
from .engine import NodeSpec
from .evidence import EvidenceError, Reading, outcomes_finding


class Answer:
    """Results of the methods of one step.

    Attributes:
        findings: node -> its evidence; nodes that were left at zero are not in it.
        outputs: nodes that were flagged as outputs.
        problems: node -> why its method gave nothing.
    """

    __slots__ = ("findings", "outputs", "problems")

    def __init__(self) -> None:
        self.findings: Dict[int, Reading] = {}
        self.outputs: Set[int] = set()
        self.problems: Dict[int, str] = {}

    def put(
        self,
        positions: Mapping[int, int],
        missing: Sequence[int],
        states: List[int],
        weights: Dict[int, List[float]],
    ) -> None:
        """Replace what was declared by the results of the methods.

        Args:
            positions: node -> its position among the observable ones.
            missing: "not observed" for each of them.
            states: of the observable nodes; changed.
            weights: likelihoods, by position; changed.
        """
        for node in self.problems:  # it would have set what is not known
            if node in positions:
                position = positions[node]
                states[position] = missing[position]
                weights.pop(position, None)
        for node, finding in self.findings.items():
            position = positions[node]
            if isinstance(finding, int):
                states[position] = finding
                weights.pop(position, None)
            else:
                states[position] = missing[position]
                weights[position] = finding


class _Data:
    """What ``update_dra_data`` gets: D7.2's methods take ``.data`` of it."""

    __slots__ = ("data",)

    def __init__(self) -> None:
        self.data: object = None


class Methods:
    """The methods of an object, one per node that has one.

    A method that can read nothing, mostly one without hand-written code, is asked once: it says
    the same in each step. Every other one counts as an observation of its node.

    Attributes:
        observed: nodes that a method observes, or may observe.
        outputs: nodes that are flagged as outputs, as far as that is known before the first step.
    """

    def __init__(self, hooks: object, nodes: Sequence[NodeSpec], *, virtual: bool) -> None:
        self._hooks: Any = hooks
        self._virtual = virtual
        self._data = _Data()
        self._names: List[Tuple[int, str, Tuple[str, ...]]] = []
        self._constant = Answer()
        self.outputs: Set[int] = set()
        for node, spec in enumerate(nodes):
            name = f"node_{spec.attribute}"
            if not hasattr(hooks, name):
                continue
            function: Any = getattr(getattr(hooks, name), "__func__", None)
            code = getattr(function, "__code__", None)
            # Asked without its object: a method that uses that alone may change its result, too.
            if code is not None and _reads_nothing(code):
                asked = partial(function, _NOBODY)
                if not self._ask_one(node, name, spec.states, self._constant, asked):
                    continue
            self._names.append((node, name, spec.states))
            if code is not None and any(one is True for one in code.co_consts):
                self.outputs.add(node)
        self.observed = {*self._constant.findings, *(node for node, *_ in self._names)}
        self.outputs |= self._constant.outputs

    def ask(self, eddi_input: object) -> Answer:
        """Call every method that may change its result, once.

        What one raises is noted and its node is not observed.
        """
        known = self._constant
        if not self._names:
            return known
        answer = Answer()
        answer.findings.update(known.findings)
        answer.outputs |= known.outputs
        hooks, data = self._hooks, self._data
        data.data = eddi_input
        try:
            hooks.update_dra_data(data)
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            reason = f"update_dra_data raised {one_line(problem)}"
            answer.problems.update((node, reason) for node, *_ in self._names)
            return answer
        for node, name, states in self._names:
            reason = self._ask_one(node, name, states, answer)
            if reason:
                answer.problems[node] = reason
        return answer

    def _ask_one(
        self,
        node: int,
        name: str,
        states: Sequence[str],
        answer: Answer,
        method: Optional[Callable[[], Any]] = None,
    ) -> str:
        """Call one method and return what was wrong with it."""
        try:
            is_output, outcomes = (method or getattr(self._hooks, name))()
            if is_output:
                answer.outputs.add(node)
            found = outcomes_finding(outcomes, states, virtual=self._virtual)
        except EvidenceError as problem:
            return f"{name}: {problem}"
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            return f"{name} raised {one_line(problem)}"
        if found is not None:
            answer.findings[node] = found
        elif not self._virtual and any(outcomes.values()):
            return f"{name}: evidence_mode d7.2 drops its outcomes"
        return ""


class _Nobody:
    """Is given to a method in place of its object; what asks it anything fails."""

    def _asked(self, *_: object) -> NoReturn:
        raise TypeError

    __bool__ = __eq__ = __ne__ = __str__ = __repr__ = __format__ = __hash__ = _asked


_NOBODY = _Nobody()


def _reads_nothing(code: Any) -> bool:
    """Return whether a method has nothing to read from: no names, no attributes, no closure."""
    return (
        not (code.co_names or code.co_freevars or code.co_cellvars)
        and (code.co_argcount, code.co_kwonlyargcount) == (1, 0)
        and not any(isinstance(one, type(code)) for one in code.co_consts)
    )
