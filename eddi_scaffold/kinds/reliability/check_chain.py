"""What is wrong with a Markov chain."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.compiling.reliability import markov
from eddi_scaffold.kinds.reliability.model import Chain
from eddi_scaffold.problems import Place, Problem, error, warning

MAX_STATES = 2000
_LARGE = 500
_LARGEST_RATE = 1e12


def check_chain(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    """Yield the problems of a chain (R002, R007, R013)."""
    broken = False
    if len(chain.initial) != 1:
        found = f"the initial states {', '.join(chain.initial)}" if chain.initial else "none"
        message = f"chain {name!r} needs exactly one initial state, it has {found}"
        yield error("R007", message, place)
        broken = True
    if not chain.fail:
        message = f"chain {name!r} has no fail state"
        yield error("R007", message, place, "mark a state: isFailState, or `fail:` in YAML")
        broken = True
    failed = next((state for state in chain.initial if state in chain.fail), None)
    if failed is not None and len(chain.initial) == 1:
        yield error("R007", starts_failed(failed), place)
        broken = True
    if len(chain.states) > MAX_STATES:
        message = f"chain {name!r} has {len(chain.states)} states, the limit is {MAX_STATES}"
        yield error("R002", message, place)
        broken = True
    for arc in chain.arcs:
        if arc.rate > _LARGEST_RATE:
            message = (
                f"the rate {arc.rate:g} 1/h from {arc.source!r} to {arc.target!r} of chain "
                f"{name!r} is out of range, 0 to {_LARGEST_RATE:.15g} 1/h"
            )
            yield error("R002", message, arc.place)
            broken = True
    if not broken:
        yield from _reach(name, chain, place)


def starts_failed(state: str) -> str:
    """Return what is wrong with a chain that begins in a fail state."""
    return f"the initial state {state!r} is a fail state: p_fail is 1 from the start"


def _reach(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    number = {state: i for i, state in enumerate(chain.states)}
    fail = [number[state] for state in chain.fail]
    initial = number[chain.initial[0]]
    for state in chain.fail:
        if any(arc.source == state and arc.rate > 0.0 for arc in chain.arcs):
            message = f"fail state {state!r} of chain {name!r} has arcs, which are left out"
            hint = "failure is first passage: what comes after it is ignored"
            yield warning("R013", message, place, hint)
    arcs = [(number[a.source], number[a.target], a.rate) for a in chain.arcs]
    given = markov.Chain(tuple(chain.states), initial, tuple(fail), tuple(arcs))
    reached = markov.reached(given)
    lost = [state for state, i in number.items() if i not in reached]
    if lost:
        shown = ", ".join(lost[:8]) + (", ..." if len(lost) > 8 else "")
        yield warning("R013", f"chain {name!r} never reaches {shown}", place)
    if initial not in markov.reaching(given, fail):
        message = f"chain {name!r} cannot fail: no path leads from {chain.initial[0]!r} to failure"
        yield warning("R013", message, place, "its MTTF is infinite")
    elif initial not in markov.certain(given):
        message = f"chain {name!r} may stay for ever in states that cannot fail"
        yield warning("R013", message, place, "its MTTF is infinite")
    if len(number) > _LARGE:
        size = 8e-6 * len(number) ** 2
        message = f"chain {name!r} has {len(number)} states: {size:.0f} MB for each matrix"
        yield warning("R013", message, place)
