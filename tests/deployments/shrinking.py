"""A deployment that violates a property, made smaller as long as it still does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from tests.deployments.drafts import Draft
from tests.deployments.history import History

ATTEMPTS = 400
"""Smaller deployments that are tried at most."""


def smallest(draft: Draft, fails: Callable[[Draft], bool]) -> Draft:
    """Return a deployment that still fails, of which no single part can be left out."""
    left = ATTEMPTS
    smaller: Draft | None = draft
    while smaller is not None:
        draft, smaller = smaller, None
        for candidate in _smaller(draft):
            left -= 1
            if left < 0:
                return draft
            if fails(candidate):
                smaller = candidate
                break
    return draft


def _smaller(draft: Draft) -> Iterator[Draft]:
    """Yield the draft without one part, large parts first."""
    for instance in draft.instances:
        rest = tuple(one for one in draft.instances if one is not instance)
        if rest:
            yield replace(draft, instances=rest, history=_without(draft.history, instance.name))
    for topic in draft.offers:
        rest_of = tuple(one for one in draft.values if one.topic != topic)
        if len(rest_of) < len(draft.values):
            yield replace(draft, values=rest_of)
    for history in _calmer(draft.history):
        yield replace(draft, history=history)
    for k, instance in enumerate(draft.instances):
        if instance.delay:
            prompt = replace(instance, delay=0)
            instances = (*draft.instances[:k], prompt, *draft.instances[k + 1 :])
            yield replace(draft, instances=instances)
    size = len(draft.values) // 2
    while size:
        for k in range(0, len(draft.values), size):
            yield replace(draft, values=(*draft.values[:k], *draft.values[k + size :]))
        size //= 2


def _calmer(history: History) -> Iterator[History]:
    if history.dead:
        yield replace(history, dead=())
    if history.restarts:
        yield replace(history, restarts=())
    if history.clock:
        yield replace(history, clock=())
    if history.latching:
        yield replace(history, latching=False)


def _without(history: History, name: str) -> History:
    """Return what happens to the others."""
    dead = tuple(one for one in history.dead if one[0] != name)
    return replace(
        history, dead=dead, restarts=tuple(one for one in history.restarts if one[1] != name)
    )
