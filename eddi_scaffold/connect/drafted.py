"""What a run of ``connect`` gives: the new text, and why it is so."""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence
from dataclasses import dataclass

from eddi_scaffold.config.block import ConfigText
from eddi_scaffold.connect.matching import Decision
from eddi_scaffold.connect.reading import content, topics_of
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.problems import Problem


@dataclass(frozen=True)
class Connected:
    """A draft.

    Attributes:
        name: of the configuration.
        before: its text, ``None`` when there is no file.
        after: its new text.
        decisions: one for each input of the model.
        kept: inputs that were decided before.
        problems: of the robot, and of the configuration.
        todo: how many values are still to be decided.
    """

    name: str
    before: str | None
    after: str
    decisions: Sequence[Decision]
    kept: frozenset[str]
    problems: Sequence[Problem]
    todo: int

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != self.before

    def state(self, decision: Decision) -> str:
        """Return ``taken``, ``listed`` or ``none``, or ``kept`` where a person has decided."""
        return "kept" if decision.need.id in self.kept else decision.state

    @property
    def has_topics(self) -> bool:
        """Whether the configuration names topics of a robot."""
        return bool(topics_of(content(ConfigText(self.name, self.after, 0, 0))))

    def diff(self) -> str:
        """Return the change as a unified diff."""
        old = (self.before or "").splitlines(keepends=True)
        name = self.name if self.before is not None else os.devnull
        new = self.after.splitlines(keepends=True)
        lines = difflib.unified_diff(old, new, name, self.name)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)

    def as_json(self) -> dict[str, JsonValue]:
        """Return the decisions for programs."""
        return {
            "inputs": [
                {
                    "id": one.need.id,
                    "state": self.state(one),
                    "candidates": [
                        {
                            "output": found.topic.id,
                            found.access.key: found.access.text,
                            "unit": found.access.unit,
                            "score": found.score,
                            "parts": dict(found.parts),
                            "why": list(found.reasons),
                        }
                        for found in one.candidates
                    ],
                }
                for one in self.decisions
            ],
            "todo": self.todo,
        }
