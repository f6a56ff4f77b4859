"""Questions of ``connect --interactive``: what a draft leaves to a person, on a terminal."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.escaping import one_line
from eddi_scaffold.kinds import TODO

if TYPE_CHECKING:
    from eddi_scaffold.connect.draft import Age
    from eddi_scaffold.connect.drafted import Connected
    from eddi_scaffold.connect.matching import Decision
    from eddi_scaffold.connect.needs import Need
    from eddi_scaffold.connect.scoring import Candidate

_NONE = "none of these"
_STOP = "skip all further questions"


def is_possible() -> bool:
    """Return whether there is a terminal, on which a person can answer."""
    return all(one is not None and one.isatty() for one in (sys.stdin, sys.stdout))


def answers(found: Connected) -> tuple[dict[str, Candidate], dict[str, Age]]:
    """Ask for the topic of each input that has candidates, then for the age of their messages.

    Returns:
        Input -> the candidate that was taken, and topic -> when its messages are too old.
    """
    from eddi_scaffold.connect.draft import Age

    taken: dict[str, Candidate] = {}
    for decision in found.unanswered:
        answer = _topic(decision)
        if answer == _STOP:
            return taken, {}
        if not isinstance(answer, str):
            taken[decision.need.id] = answer
    ages: dict[str, Age] = {}
    for decision in found.decisions:
        given = taken.get(decision.need.id)
        best = decision.candidates[0] if decision.state == "taken" else given
        if best is None or decision.need.id not in found.without_age:
            continue
        topic = found.full_name(best.topic)
        seconds = _age(decision.need, topic) if topic not in ages else None
        if seconds is not None:
            ages[topic] = Age(seconds, "")
    return taken, ages


def _topic(decision: Decision) -> Candidate | str:
    import questionary

    from eddi_scaffold.connect.draft import as_expression

    need = decision.need
    shown = {
        one_line(
            f"{as_expression(need, one) or one.access.text}  ({one.score} points,"
            f" {one.topic.topic}{''.join(f'; {why}' for why in one.reasons)})"
        ): one
        for one in decision.candidates
    }
    title = one_line(f"{need.id} ({need.type}{f', {need.unit}' if need.unit else ''}) is")
    answer = questionary.select(title, choices=[*shown, _NONE, _STOP]).unsafe_ask()
    return _completed(need, shown[answer]) if answer in shown else str(answer)


def _completed(need: Need, candidate: Candidate) -> Candidate | str:
    """Ask for what is open in a candidate, such as the name of a joint."""
    import questionary

    from eddi_scaffold.connect.draft import as_expression

    if candidate.access.is_complete or TODO not in candidate.access.text:
        return candidate
    text = as_expression(need, candidate)
    asked = questionary.text(
        f"in place of {TODO}:",
        default=text or candidate.access.text,
        validate=lambda given: bool(given.strip()) and TODO not in given,
    ).unsafe_ask()
    key = candidate.access.key if text is None else "expression"
    return replace(candidate, access=replace(candidate.access, key=key, text=asked.strip()))


def _age(need: Need, topic: str) -> float | None:
    import questionary

    text = questionary.text(
        one_line(f"max_age of {need.id}, from {topic}, in seconds (empty: later):"),
        validate=lambda given: not given.strip() or _seconds(given) is not None,
    ).unsafe_ask()
    return _seconds(text)


def _seconds(text: str) -> float | None:
    """Return a number above 0, ``None`` for anything else."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and value > 0 else None
