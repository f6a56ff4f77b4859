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

from eddi_scaffold.common.files import read_source, saved_meanwhile
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    did_you_mean,
    has_errors,
    in_order,
    problem,
    with_excerpts,
)
from eddi_scaffold.config.topic_block import (
    ConfigText,
    DroppedTopic,
    OldEntry,
    read_block,
    rewritten,
)
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.mros.directory import load_models, load_system
from eddi_scaffold.mros.model import System
from eddi_scaffold.mros.resolving import Models, flattened
from eddi_scaffold.mros.topics import (
    Outputs,
    Topic,
    simulator_outputs,
)

_MARK = b"\xef\xbb\xbf"
_SHOWN = 12
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
        if self.no_infrastructure and topic.type.partition(".")[0] in _INFRASTRUCTURE:
            return _NO_INFRASTRUCTURE
        if not self.keeps(topic.topic):
            return _ONLY
        is_kept = not self.components or _matches(topic.components, *self.components)
        return None if is_kept else _COMPONENT

    def unmatched(self, topics: Collection[str], components: Collection[str]) -> Iterator[Problem]:
        """Return an error for each glob that matches none of the names that there are."""
        for option, globs, kind, names in (
            (_ONLY, self.topics, "topic", {*topics}),
            (_COMPONENT, self.components, "component", {*components}),
        ):
            more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
            there = f"there are: {', '.join(sorted(names)[:_SHOWN])}{more}" if names else None
            for glob in globs:
                if not _matches(names, glob):
                    hint = did_you_mean(re.sub(r"[*?\[\]]", "", glob), names) or there
                    fields = {"kind": kind, "option": option, "pattern": glob}
                    yield problem("M022.no_match", hint=hint, **fields)

    def __str__(self) -> str:
        """Return the filters as they are given on the command line."""
        options = [f"{_ONLY} {glob!r}" for glob in self.topics]
        options += [f"{_COMPONENT} {glob!r}" for glob in self.components]
        return " ".join([*options, *[_NO_INFRASTRUCTURE] * self.no_infrastructure])


def _matches(names: Iterable[str], *globs: str) -> bool:
    return any(fnmatchcase(name, glob) for name in names for glob in globs)


@dataclass(frozen=True)
class Robot:
    """A system and the models of its nodes, as files of this machine."""

    folder: Path  # of the models
    path: Path  # of the system
    system: System
    models: Models
    problems: tuple[Problem, ...]  # of the files

    def located(self, problems: Iterable[Problem]) -> list[Problem]:
        """Return problems with files as a person can open them, not relative to the models."""
        return [replace(problem, place=self._located(problem.place)) for problem in problems]

    def _located(self, place: Place) -> Place:
        if place.file == self.system.file:
            return replace(place, file=str(self.path))
        models = self.models
        inside = {*models.skipped, *(reported.place.file for reported in models.problems)}
        inside |= {model.file for model in models.files} | {part.file for part in models.systems}
        return replace(place, file=str(self.folder / place.file)) if place.file in inside else place


@dataclass(frozen=True)
class Parsed:
    """What a run found, and what the configuration becomes."""

    robot: Robot
    outputs: Outputs
    problems: tuple[Problem, ...]  # files relative to the directory of models
    before: str | None  # text of the configuration, `None` when there is no file
    after: str  # its new text; the old one where there are errors and nothing resolved

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != (self.before or "")

    def diff(self, name: str) -> str:
        """Return the change of the configuration as a unified diff."""
        return unified_diff(self.before, self.after, name)

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


def unified_diff(before: str | None, after: str, name: str) -> str:
    """Return the change of a file, ``None`` for one that is new."""
    old, new = (before or "").splitlines(keepends=True), after.splitlines(keepends=True)
    lines = difflib.unified_diff(old, new, name if before is not None else os.devnull, name)
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


def read_robot(system: Path, folder: Path) -> Robot:
    """Read a system and all models of its directory.

    Raises:
        EddiError: the system cannot be read, or there is no such directory.
    """
    try:
        model, problems = load_system(system, folder)
    except EddiError as failed:  # who can go no further sees an error in any case
        raise EddiError(*(replace(fault, level="error") for fault in failed.problems)) from None
    models = load_models(folder, systems=bool(model.subsystems))
    return Robot(folder, system, model, models, (*problems, *models.problems))


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
    is_there = config.exists() or config.is_symlink()
    document = read_block(read_source(config)) if is_there else ConfigText(str(config), "")
    parsed = with_topics(robot, document, include=include, filters=filters, names=names)
    return parsed if is_there else replace(parsed, before=None)


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
    known = {*left_out, *(old.topic for old in document.old if not outputs.is_complete)}
    _refuse_filters(filters, robot, outputs, known)

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
    return Parsed(robot, outputs, tuple(problems), document.text, after)


def _refuse_filters(
    filters: Filters, robot: Robot, outputs: Outputs, topics: Collection[str]
) -> None:
    """Refuse filters that match nothing, and report what did not resolve: it may be the cause.

    Raises:
        EddiError: a glob matches nothing, or together they leave nothing.
    """
    systems = flattened(robot.system, robot.models.systems)[0]
    components = [component.name for part in systems for component in part.components]
    wrong = list(filters.unmatched(topics, components))
    some = filters.topics or filters.components
    if some and not wrong and outputs.is_complete and not outputs.topics:
        wrong = [problem("M022.no_topic", filters=filters)]
    if wrong:
        problems = in_order([*robot.problems, *outputs.problems])
        raise EddiError(*robot.located(p for p in problems if p.level == "error"), *wrong)


def save(path: Path, text: str, before: str | None) -> None:
    """Replace a configuration as one step; its byte order mark and its mode stay.

    Args:
        path: the configuration.
        text: its new text.
        before: the text that the new one was made of, ``None`` where there was no file.

    Raises:
        EddiError: it cannot be written (F002), or was saved meanwhile (F013); it stays as it is.
    """
    target = path.resolve()
    temporary = target.with_name(f".eddi-{os.getpid()}")
    try:
        mark = _MARK if target.exists() and target.read_bytes().startswith(_MARK) else b""
        try:
            with temporary.open("xb") as file:
                file.write(mark + text.encode())
                file.flush()
                os.fsync(file.fileno())
            now = target.read_bytes().removeprefix(_MARK) if target.exists() else None
            if now != (None if before is None else before.encode()):
                raise saved_meanwhile(path)
            if now is not None:
                temporary.chmod(target.stat().st_mode & 0o7777)
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as refused:
        reason = refused.strerror or refused
        raise EddiError(problem("F002.write", Place(str(path)), reason=reason)) from None
