"""The methods ``node_<name>`` in which a person turns data into evidence (SESAME D7.2 Fig 15)."""

from __future__ import annotations

import ast
import inspect
import textwrap
from typing import Any, Dict, Iterator, List, Mapping, Sequence, Set, Tuple, Union

from ..plain_values import one_line
from .evidence import EvidenceError, outcomes_finding
from .model import Network


class Answer:
    """Results of the methods of one step.

    Attributes:
        findings: node -> its evidence; nodes that were left at zero are not in it.
        outputs: nodes that were flagged as outputs.
        problems: node -> why its method gave nothing.
    """

    __slots__ = ("findings", "outputs", "problems")

    def __init__(self) -> None:
        self.findings: Dict[int, Union[int, List[float]]] = {}
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

    Attributes:
        observed: nodes whose method sets an outcome, as far as the source shows it.
        doubtful: nodes whose method may set one, although its source does not show it.
        outputs: nodes whose method sets ``is_bn_output``.
    """

    def __init__(self, hooks: Any, network: Network, *, virtual: bool) -> None:
        self._hooks = hooks
        self._virtual = virtual
        self._data = _Data()
        self._states = network.states
        names = [f"node_{attribute}" for attribute in network.attributes]
        self._names: List[Tuple[int, str]] = []
        self._constant = Answer()
        self.observed: Set[int] = set()
        self.doubtful: Set[int] = set()
        self.outputs: Set[int] = set()
        for node, name in enumerate(names):
            if not hasattr(hooks, name):
                continue
            tree = _source(hooks, name)
            observed, output = _assigned(tree)
            self.observed.update([node] if observed else [])
            self.outputs.update([node] if output else [])
            # What cannot change is asked once: mostly methods without hand-written code.
            if not _is_constant(tree) or self._ask_one(node, name, self._constant):
                self._names.append((node, name))
                self.doubtful.update([] if _returns_outcomes(tree) else [node])

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
            answer.problems.update((node, reason) for node, _ in self._names)
            return answer
        for node, name in self._names:
            reason = self._ask_one(node, name, answer)
            if reason:
                answer.problems[node] = reason
        return answer

    def _ask_one(self, node: int, name: str, answer: Answer) -> str:
        """Call one method and return what was wrong with it."""
        try:
            is_output, outcomes = getattr(self._hooks, name)()
            if is_output:
                answer.outputs.add(node)
            found = outcomes_finding(outcomes, self._states[node], virtual=self._virtual)
        except EvidenceError as problem:
            return f"{name}: {problem}"
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            return f"{name} raised {one_line(problem)}"
        if found is not None:
            answer.findings[node] = found
        elif not self._virtual and any(outcomes.values()):
            return f"{name}: evidence_mode d7.2 drops its outcomes"
        return ""


def _source(hooks: Any, name: str) -> ast.Module:
    """Return the source of a method, empty when it cannot be had."""
    try:
        return ast.parse(textwrap.dedent(inspect.getsource(getattr(hooks, name))))
    except (OSError, TypeError, SyntaxError, ValueError):
        return ast.Module([], [])


def _is_constant(tree: ast.Module) -> bool:
    """Return whether a method returns only constants, so that each call gives the same."""
    if len(tree.body) != 1 or not isinstance(tree.body[0], ast.FunctionDef):
        return False
    method = tree.body[0]
    variables: Set[str] = set()
    if method.decorator_list:
        return False

    def known(value: ast.expr | None) -> bool:
        if isinstance(value, ast.Name):
            return value.id in variables
        return isinstance(value, ast.Constant)

    for item in method.body:
        if isinstance(item, ast.Assign) and known(item.value):
            if not all(isinstance(target, ast.Name) for target in item.targets):
                return False
            variables.update(target.id for target in item.targets if isinstance(target, ast.Name))
        elif isinstance(item, ast.Return) and isinstance(item.value, ast.Tuple):
            flag, *others = item.value.elts
            outcomes = others[0] if len(others) == 1 else None
            if not isinstance(outcomes, ast.Dict) or not known(flag):
                return False
            return all(known(one) for one in (*outcomes.keys, *outcomes.values))
        elif not isinstance(item, ast.Pass) and not _is_text(item):
            return False
    return False


def _is_text(item: ast.stmt) -> bool:
    return isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant)


def _assigned(tree: ast.AST) -> Tuple[bool, bool]:
    """Return whether a method sets an outcome and whether it sets the flag, by its source.

    A wrong answer costs one slow step, when the first evidence comes. Without source: (False,
    False).
    """
    observed = output = False
    for target, value in _assignments(tree):
        constant = value.value if isinstance(value, ast.Constant) else None
        if target.startswith("outcome_"):
            observed |= constant != 0.0 or not isinstance(value, ast.Constant)
        elif target == "is_bn_output":
            output |= constant is not False
    return observed, output


def _returns_outcomes(tree: ast.Module) -> bool:
    """Return whether a method returns its variables ``outcome_*`` and nothing else."""
    found = [item.value for item in ast.walk(tree) if isinstance(item, ast.Return)]
    dicts = [one.elts[-1] for one in found if isinstance(one, ast.Tuple) and one.elts]
    return bool(found) and len(dicts) == len(found) and all(map(_is_of_outcomes, dicts))


def _is_of_outcomes(value: ast.expr) -> bool:
    return isinstance(value, ast.Dict) and all(
        isinstance(one, ast.Name) and one.id.startswith("outcome_") for one in value.values
    )


def _assignments(tree: ast.AST) -> Iterator[Tuple[str, ast.expr | None]]:
    for item in ast.walk(tree):
        targets: List[ast.expr] = []
        value = None
        if isinstance(item, ast.Assign):
            targets, value = item.targets, item.value
        elif isinstance(item, (ast.AugAssign, ast.AnnAssign, ast.NamedExpr)):
            targets = [item.target]
            value = None if isinstance(item, ast.AugAssign) else item.value
        elif isinstance(item, (ast.For, ast.withitem)):
            wanted = item.target if isinstance(item, ast.For) else item.optional_vars
            targets = [] if wanted is None else [wanted]
        for target in targets:
            for part in ast.walk(target):
                if isinstance(part, ast.Name):
                    yield part.id, value if part is target else None
