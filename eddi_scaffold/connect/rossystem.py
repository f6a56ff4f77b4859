"""``parse-rossystem`` as functions: the topics of a robot's system go into a configuration."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import (
    EddiError,
    Problem,
    did_you_mean,
    has_errors,
    in_order,
    problem,
    shortened_list,
    with_excerpts,
)
from eddi_scaffold.config.topic_block import (
    ConfigText,
    DroppedTopic,
    OldEntry,
    read_block,
    rewritten,
)
from eddi_scaffold.connect.robot import Robot
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.mros.resolving import flattened
from eddi_scaffold.mros.topics import Outputs, Topic, simulator_outputs


def read_config_text(path: Path | None, name: Path) -> tuple[ConfigText, str | None]:
    """Return a configuration and its text, ``None`` as the text where there is no file."""
    if path is None or not (path.exists() or path.is_symlink()):
        return ConfigText(str(name), ""), None
    document = read_block(read_source(path))
    return document, document.text


@dataclass(frozen=True)
class ConfigChange:
    """What a configuration becomes."""

    name: str  # of the file
    before: str | None  # its text, `None` when there is no file
    after: str  # its new text; the old one where there are errors and nothing resolved

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != (self.before or "")

    def diff(self) -> str:
        """Return the change as a unified diff."""
        old, new = (t.splitlines(keepends=True) for t in (self.before or "", self.after))
        former = self.name if self.before is not None else os.devnull
        lines = difflib.unified_diff([*old], [*new], former, self.name)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


_INFRASTRUCTURE = ("dynamic_reconfigure", "rcl_interfaces", "bond", "lifecycle_msgs")
_ONLY, _COMPONENT, _NO_INFRASTRUCTURE = "--only", "--component", "--exclude-infrastructure"


@dataclass(frozen=True)
class Filters:
    """Which topics are kept; globs are case-sensitive and ``*`` also matches ``/``."""

    topics: tuple[str, ...] = ()  # any match keeps; empty keeps all
    components: tuple[str, ...] = ()  # the same for a component that provides the topic
    # leave out types of `dynamic_reconfigure`, `rcl_interfaces`, `bond` and `lifecycle_msgs`
    no_infrastructure: bool = False

    def keeps(self, name: str) -> bool:
        """Return whether a topic of this name is kept."""
        return not self.topics or _matches([name], *self.topics)

    def leaves_out(self, topic: Topic) -> str | None:
        """Return the option that keeps a topic out; ``None`` when it is kept."""
        if self.no_infrastructure and topic.type.partition("/")[0] in _INFRASTRUCTURE:
            return _NO_INFRASTRUCTURE
        if not self.keeps(topic.topic):
            return _ONLY
        is_kept = not self.components or _matches(topic.components, *self.components)
        return None if is_kept else _COMPONENT

    def check(self, robot: Robot, outputs: Outputs, topics: Collection[str]) -> None:
        """Refuse filters that match nothing, with what did not resolve: it may be the cause.

        Raises:
            EddiError: a glob matches nothing, or together they leave nothing.
        """
        systems, _ = flattened(robot.system, robot.models.systems)
        components = {component.name for part in systems for component in part.components}
        wrong = [
            *_unmatched(_ONLY, self.topics, "topic", topics),
            *_unmatched(_COMPONENT, self.components, "component", components),
        ]
        some = self.topics or self.components
        if some and not wrong and outputs.is_complete and not outputs.topics:
            wrong = [problem("M022.no_topic")]
        if wrong:
            problems = in_order([*robot.problems, *outputs.problems])
            raise EddiError(*robot.located(p for p in problems if p.level == "error"), *wrong)


def _matches(names: Iterable[str], *globs: str) -> bool:
    return any(fnmatchcase(name, glob) for name in names for glob in globs)


def _unmatched(
    option: str, globs: Collection[str], kind: str, names: Collection[str]
) -> Iterator[Problem]:
    """Yield an error for each glob that matches none of the names that there are."""
    there = f"there are: {shortened_list(sorted(names))}" if names else None
    for glob in globs:
        if not _matches(names, glob):
            hint = did_you_mean(re.sub(r"[*?\[\]]", "", glob), names) or there
            yield problem("M022.no_match", hint=hint, kind=kind, option=option, pattern=glob)


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
    config: Path,
    *,
    include: Collection[str] = (),
    filters: Filters | None = None,
    names: Literal["label", "model"] = "label",
) -> Parsed:
    """Join a system with its models, and write its topics into the text of a configuration.

    Raises:
        EddiError: the configuration is there and cannot be changed, or the filters leave nothing.
    """
    document, before = read_config_text(config, config)
    parsed = with_topics(robot, document, include=include, filters=filters, names=names)
    return replace(parsed, before=before)


def with_topics(
    robot: Robot,
    document: ConfigText,
    *,
    include: Collection[str] = (),
    filters: Filters | None = None,
    names: Literal["label", "model"] = "label",
    writes: Callable[[Topic], bool] = lambda _: True,
) -> Parsed:
    """Do the same with a text, for the topics that are to be written."""
    filters = filters or Filters()
    every = simulator_outputs(
        robot.system, robot.models, include=include, existing=document.old, names=names
    )
    left_out = {topic.topic: filters.leaves_out(topic) for topic in every.topics}
    topics = tuple(topic for topic in every.topics if left_out[topic.topic] is None)
    outputs = replace(every, topics=topics)
    problems = [*robot.problems, *outputs.problems]
    filters.check(
        robot,
        outputs,
        {*left_out, *(old.topic for old in document.old if not outputs.is_complete)},
    )

    def absence(old: OldEntry) -> DroppedTopic:
        """Explain why an entry is not rewritten; what may be there all the same stays."""
        option = left_out.get(old.topic)
        if not outputs.is_complete and not filters.keeps(old.topic):
            option = _ONLY
        if option is not None:
            return DroppedTopic(f"is left out by {option}")
        if not outputs.is_complete:
            return DroppedTopic("did not resolve this time, or is gone", stays=True)
        return DroppedTopic()

    after, notes = document.text, list[Problem]()
    if topics or not has_errors(problems):
        after, notes = rewritten(document, [*filter(writes, topics)], absence)
    problems += notes
    # the configuration is quoted as it was read: what is printed comes after it is rewritten
    own = [reported for reported in problems if reported.place.file == document.name]
    others = [reported for reported in problems if reported.place.file != document.name]
    problems = in_order([*others, *with_excerpts(own, document.text)])
    return Parsed(document.name, document.text, after, robot, outputs, tuple(problems))
