"""Steps of a circle across robots that no word shows: topics between two monitors.

At run time, a word names the monitors on whose words it rests, and none of these relies on it. What
a monitor reads on a topic names nobody, so a circle that has such a step would not be seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.deployments.wiring.support import Participant, supports
from eddi_scaffold.graphs import reached
from eddi_scaffold.problems import Problem, error


def check_hidden(participants: Sequence[Participant]) -> Iterator[Problem]:
    """Report what is told to other robots and rests by topics on a word of one (D017).

    Args:
        participants: the monitors that read each other's topics.
    """
    telling = [one for one in participants if _tells(one)]
    relying = {claim: one for one in participants for claim in one.by_words}
    if not telling or not relying:
        return
    graph = supports(participants)
    for one in telling:
        for output in one.outputs:
            claim = one.claim(output)
            behind = reached(graph, [claim])
            hidden = next((c for c, of in relying.items() if c in behind and of is not one), None)
            if hidden is not None:
                yield _hidden(one, claim, hidden)
                break


def _tells(one: Participant) -> bool:
    """Return whether other robots may rely on a monitor, among which nobody looked for circles."""
    fleet = one.config.config.Fleet
    return fleet is not None and not fleet.closed


def _hidden(one: Participant, claim: str, hidden: str) -> Problem:
    message = (
        f"{claim} is told to other robots and rests on a topic of {hidden}, which rests on the word"
        " of another robot: if that one relies on this robot, no word shows the circle"
    )
    hint = (
        "let one monitor have both, or name each robot in a deployment file; where no robot relies"
        f" on {one.name}, it needs no `Fleet`"
    )
    return error("D017", message, one.config.place("Fleet"), hint)
