"""``parse-rossystem`` as functions: the topics of a robot's system go into a configuration."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    has_errors,
    in_order,
    problem,
    with_excerpts,
)
from eddi_scaffold.config.topic_block import ConfigText, read_block, rewritten
from eddi_scaffold.connect.robot import Robot
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.mros.topics import Outputs, Topic, simulator_outputs


def read_config_text(path: Path) -> ConfigText:
    """Return a configuration, which need not exist."""
    is_there = path.exists() or path.is_symlink()
    return read_block(read_source(path)) if is_there else ConfigText(str(path), "", is_new=True)


@dataclass(frozen=True)
class ConfigChange:
    """What a configuration becomes."""

    document: ConfigText  # before
    after: str  # its new text; the old one where there are errors and nothing resolved

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != self.document.text

    def diff(self) -> str:
        """Return the change as a unified diff."""
        old, new = (t.splitlines(keepends=True) for t in (self.document.text, self.after))
        former = os.devnull if self.document.is_new else self.document.name
        lines = difflib.unified_diff([*old], [*new], former, self.document.name)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


_INFRASTRUCTURE = ("dynamic_reconfigure", "rcl_interfaces", "bond", "lifecycle_msgs")


@dataclass(frozen=True)
class Filters:
    """Which topics are kept; globs are case-sensitive and ``*`` also matches ``/``."""

    topics: tuple[str, ...] = ()  # any match keeps; empty keeps all
    components: tuple[str, ...] = ()  # the same for a component that provides the topic
    # leave out types of `dynamic_reconfigure`, `rcl_interfaces`, `bond` and `lifecycle_msgs`
    no_infrastructure: bool = False

    def keeps(self, topic: Topic) -> bool:
        """Return whether a topic is kept."""
        if self.no_infrastructure and topic.type.partition("/")[0] in _INFRASTRUCTURE:
            return False
        is_provided = not self.components or _matches(topic.components, self.components)
        return is_provided and (not self.topics or _matches([topic.topic], self.topics))


def _matches(names: Iterable[str], globs: Sequence[str]) -> bool:
    return any(fnmatchcase(name, glob) for name in names for glob in globs)


@dataclass(frozen=True)
class Parsed(ConfigChange):
    """What a run found, and what the configuration becomes."""

    robot: Robot
    outputs: Outputs
    problems: tuple[Problem, ...]  # files relative to the directory of models

    def summary(self) -> Mapping[str, int]:
        """Return the figures of the last line."""
        levels = [problem.level for problem in self.problems]
        return {
            "components": self.outputs.components,
            "model_files": len(self.robot.models.files),
            "publishers": self.outputs.publishers,
            "topics": len(self.outputs.topics),
            "services": self.outputs.services,
            "actions": self.outputs.actions,
            "errors": levels.count("error"),
            "warnings": levels.count("warning"),
        }

    def as_json(self) -> dict[str, JsonValue]:
        """Return the result for programs; the same on every machine."""
        system = self.robot.system
        return {
            "system": system.name,
            "dialect": system.dialect,
            "outputs": [
                {
                    **{key: getattr(topic, key) for key in ("id", "type", "topic", "kind")},
                    "components": list(topic.components),
                    "file": topic.place.file,
                    "line": topic.place.line or 0,
                }
                for topic in self.outputs.topics
            ],
            "diagnostics": [
                {
                    "severity": problem.level,
                    "code": problem.code,
                    "file": problem.place.file,
                    "line": problem.place.line,
                    "column": problem.place.col,
                    "message": problem.message,
                }
                for problem in self.problems
            ],
            "summary": dict(self.summary()),
        }


def parse(
    robot: Robot,
    document: ConfigText,
    *,
    include: Collection[str] = (),
    filters: Filters = Filters(),
    names: Literal["label", "model"] = "label",
    writes: Callable[[Topic], bool] = lambda _: True,
) -> Parsed:
    """Join a system with its models, and write topics into a configuration.

    Raises:
        EddiError: the configuration cannot be changed, or the filters leave nothing (M022).
    """
    every = simulator_outputs(
        robot.system, robot.models, include=include, existing=document.old, names=names
    )
    outputs = replace(every, topics=tuple(filter(filters.keeps, every.topics)))
    problems = [*robot.problems, *outputs.problems]
    resolved = {topic.topic for topic in every.topics}
    lost = set() if outputs.is_complete else {old.topic for old in document.old} - resolved
    if filters != Filters() and not (outputs.topics or has_errors(problems)):
        raise EddiError(problem("M022"))
    after, notes = document.text, list[Problem]()
    if outputs.topics or not has_errors(problems):
        written = [*filter(writes, outputs.topics)]
        after, notes = rewritten(document, written, lost)
    problems += notes
    # the configuration is quoted as it was read: what is printed comes after it is rewritten
    own = [reported for reported in problems if reported.place.file == document.name]
    others = [reported for reported in problems if reported.place.file != document.name]
    problems = in_order([*others, *with_excerpts(own, document.text)])
    return Parsed(document, after, robot, outputs, tuple(problems))
