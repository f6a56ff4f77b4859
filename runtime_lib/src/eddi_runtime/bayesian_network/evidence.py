"""Evidence from numbers, one per state of a node; the reading of SESAME D7.2 is kept, too.

Virtual evidence is a likelihood, P(observation | state), as in Pearl 1988, section 2.2.2, and in
GeNIe; a posterior cannot be forced.
"""

from __future__ import annotations

import math
from typing import Any, List, Mapping, Sequence, Union

from ..plain_values import plain, show

Finding = Union[None, int, List[float]]
"""None: nothing is known. A number: the state, for sure. A list: likelihoods, the largest is 1."""
Reading = Union[int, List[float]]
"""A state, the number of states for "not observed", or likelihoods."""

_EPSILON = 2.220446049250313e-16


class EvidenceError(ValueError):
    """Values are no evidence; the message names the state and the value."""


class NotForeseenError(ValueError):
    """A node is observed or asked for, and no inference was compiled for it."""


def finding(values: Sequence[object], states: Sequence[str], *, virtual: bool = True) -> Finding:
    """Return the finding in one number per state.

    All zero: nothing. One other than zero: that state for sure, whatever the number. Several:
    likelihoods, of which only the ratios count.

    Args:
        values: numbers, in the order of the states.
        states: names of the states.
        virtual: False: the rule of SESAME D7.2's generated code: exactly one 1.0 among zeros is
            the state, everything else is nothing.

    Raises:
        EvidenceError: a value is no number, NaN, infinite or negative, or their count is wrong.
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
        return _as_in_d72(checked)
    others = [k for k, number in enumerate(checked) if number]
    if len(others) < 2:
        return others[0] if others else None
    largest = max(checked)
    return [number / largest for number in checked]


def outcomes_finding(
    outcomes: Mapping[str, object], states: Sequence[str], *, virtual: bool = True
) -> Finding:
    """Return the finding in a dictionary from states to numbers (SESAME D7.2 Fig 15).

    Raises:
        EvidenceError: as ``finding`` does, or the keys are not the states of the node.
    """
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


def _as_in_d72(numbers: Sequence[float]) -> int | None:
    sure = [k for k, number in enumerate(numbers) if abs(number - 1.0) <= _EPSILON]
    return sure[0] if len(sure) == 1 and abs(sum(numbers) - 1.0) <= _EPSILON else None
