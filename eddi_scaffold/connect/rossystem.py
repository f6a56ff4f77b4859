"""``parse-rossystem`` as functions: the topics of a robot's system go into a configuration."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

from eddi_scaffold.common.files import read_source, saved_meanwhile
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    has_errors,
    in_order,
    problem,
    with_excerpts,
)
from eddi_scaffold.config.topic_block import (
    ConfigText,
    DroppedTopic,
    OldEntry,
    TopicEntry,
    new_document,
    read_block,
    rewritten,
)
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.mros.directory import load_models, load_system
from eddi_scaffold.mros.model import System
from eddi_scaffold.mros.resolving import Models, flattened
from eddi_scaffold.mros.topics import (
    OPTIONS,
    Existing,
    Filters,
    Include,
    Outputs,
    Topic,
    simulator_outputs,
)

_MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True)
class Robot:
    """A system and the models of its nodes, as files of this machine.

    Attributes:
        folder: of the models.
        path: of the system.
        problems: of the files.
    """

    folder: Path
    path: Path
    system: System
    models: Models
    problems: tuple[Problem, ...]

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
    """What a run found, and what the configuration becomes.

    Attributes:
        problems: files relative to the directory of models.
        before: text of the configuration, ``None`` when there is no file.
        after: its new text; the old one where there are errors and nothing resolved.
    """

    robot: Robot
    outputs: Outputs
    problems: tuple[Problem, ...]
    before: str | None
    after: str

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
                {key: value for key, value in asdict(topic).items() if key != "deadlines"}
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
    include: Collection[Include] = (),
    filters: Filters | None = None,
    names: Literal["label", "model"] = "label",
) -> Parsed:
    """Join a system with its models, and write its topics into the text of a configuration.

    Raises:
        EddiError: the configuration is there and cannot be changed, or the filters leave nothing.
    """
    is_there = config.exists() or config.is_symlink()
    document = read_block(read_source(config)) if is_there else new_document(str(config))
    parsed = with_topics(robot, document, include=include, filters=filters, names=names)
    return parsed if is_there else replace(parsed, before=None)


def with_topics(
    robot: Robot,
    document: ConfigText,
    *,
    include: Collection[Include] = (),
    filters: Filters | None = None,
    names: Literal["label", "model"] = "label",
    writes: Callable[[Topic], bool] = lambda _: True,
) -> Parsed:
    """Do the same with a text, for the topics that are to be written."""
    filters = filters or Filters()
    file = document.name
    existing = [Existing(old.id, old.topic, Place(file, old.line, 1)) for old in document.old]
    options: dict[str, Any] = {"include": include, "filters": filters, "names": names}
    outputs = simulator_outputs(robot.system, robot.models, existing=existing, **options)
    problems = [*robot.problems, *outputs.problems]
    _refuse_filters(filters, robot, outputs, document)
    after, notes = document.text, list[Problem]()
    if outputs.topics or not has_errors(problems):
        topics = filter(writes, outputs.topics)
        entries = [TopicEntry(topic.id, topic.type, topic.topic) for topic in topics]
        after, notes = rewritten(document, entries, lambda old: _absence(old, outputs, filters))
    problems += notes
    # the configuration is quoted as it was read: what is printed comes after it is rewritten
    own = [reported for reported in problems if reported.place.file == file]
    others = [reported for reported in problems if reported.place.file != file]
    problems = in_order([*others, *with_excerpts(own, document.text)])
    return Parsed(robot, outputs, tuple(problems), document.text, after)


def _refuse_filters(filters: Filters, robot: Robot, outputs: Outputs, document: ConfigText) -> None:
    """Refuse filters that match nothing, and report what did not resolve: it may be the cause.

    Raises:
        EddiError: a glob matches nothing, or together they leave nothing.
    """
    topics = [*(topic.topic for topic in outputs.topics), *outputs.left_out]
    if not outputs.is_complete:
        topics += [old.topic for old in document.old]
    systems = flattened(robot.system, robot.models.systems)[0]
    components = [component.name for part in systems for component in part.components]
    wrong = list(filters.unmatched(topics, components))
    some = filters.topics or filters.components
    if some and not wrong and outputs.is_complete and not outputs.topics:
        wrong = [problem("M022.no_topic", filters=filters)]
    if wrong:
        problems = in_order([*robot.problems, *outputs.problems])
        raise EddiError(*robot.located(p for p in problems if p.level == "error"), *wrong)


def _absence(old: OldEntry, outputs: Outputs, filters: Filters) -> DroppedTopic:
    """Explain why an entry is not rewritten; what may be there all the same stays."""
    criterion = outputs.left_out.get(old.topic)
    if not outputs.is_complete and not filters.keeps(old.topic):
        criterion = "topics"
    if criterion is not None:
        return DroppedTopic(f"is left out by {OPTIONS[criterion]}")
    if not outputs.is_complete:
        return DroppedTopic("did not resolve this time, or is gone", stays=True)
    return DroppedTopic()


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
