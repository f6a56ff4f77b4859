"""``eddi_config.yml``: how one model is connected to a robot (SESAME D7.2 Figs 32 and 39).

The only importer of pydantic. Values follow YAML 1.1, as D7.2's tools and roslaunch do.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StrictBool,
    StrictFloat,
    StrictInt,
    StrictStr,
    ValidationError,
)

from eddi_scaffold.config.message_types import FieldsOf, used
from eddi_scaffold.identifiers import is_ros_name
from eddi_scaffold.kinds import DeclaredInput, InputType, Options, kinds
from eddi_scaffold.positioned_yaml.columns import inside_scalar
from eddi_scaffold.positioned_yaml.nodes import (
    Items,
    Map,
    Node,
    differs_between_versions,
    read_map,
    value_11,
)
from eddi_scaffold.problems import (
    EddiError,
    NearNames,
    Place,
    Problem,
    did_you_mean,
    error,
    has_errors,
    in_order,
    warning,
)
from eddi_scaffold.readers.xml_text import looks_like_xml
from eddi_scaffold.source import Source, beside, read_source

_ALIASES = {
    "EDDIOoutputs": "EDDIOutputs",
    "EDDIOOutputs": "EDDIOutputs",
    "SimulatorOutput": "SimulatorOutputs",
}
_MESSAGE_TYPE = re.compile(r"([a-z][a-z0-9_]*)(?:\.|/msg/|/)([A-Za-z][A-Za-z0-9_]*)")
_TEXTS = {
    "bool_type": "true or false is expected",
    "dict_type": "a map is expected",
    "int_type": "a whole number is expected",
    "list_type": "a list is expected, such as [first, second]",
    "model_type": "a map is expected",
    "string_type": "a text is expected",
    "too_short": "a text is expected, not nothing",
}
"""Our words for pydantic's, which speak to programmers."""
_KEY = -1
"""Last part of the path under which the place of a key is noted, not that of its value."""
_EVENT_FILES = "event_files"
"""Key of the remembered texts beside those of the configuration itself."""
_TYPES: dict[str, InputType] = {
    "bool": "bool", "boolean": "bool", "float": "float", "double": "float", "float32": "float",
    "float64": "float", "number": "float", "int": "int", "integer": "int", "int32": "int",
    "int64": "int", "str": "str", "string": "str", "text": "str", "state": "state",
    "float[]": "float[]", "number[]": "float[]", "bool[]": "bool[]",
}  # fmt: skip


_FREQUENCIES = (1e-6, 1e6)
"""Least and most steps per second: periods that every clock can count."""


def _topic(text: str) -> str:
    if not is_ros_name(text):
        raise ValueError("a ROS name is expected: letters, digits, `_` and `/`, such as /rte/e0a")
    return text


def _message_type(text: str) -> str:
    match = _MESSAGE_TYPE.fullmatch(text)
    if match is None:
        raise ValueError("a message type is expected, such as std_msgs.Bool or std_msgs/Bool")
    return f"{match[1]}/{match[2]}"


def _input_type(text: str) -> str:
    if text.lower() not in _TYPES:
        raise ValueError("the type of an input is bool, float, int, str, state, float[] or bool[]")
    return _TYPES[text.lower()]


def _max_age(value: object) -> object:
    if value == "none" or value is None:
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("seconds (a number above 0) or the word none are expected")  # noqa: TRY004 - pydantic collects ValueErrors
    if not math.isfinite(value) or value <= 0:
        raise ValueError("seconds must be a number above 0, or the word none")
    return float(value)


def _frequency(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("a number of steps per second is expected")  # noqa: TRY004 - pydantic collects ValueErrors
    low, high = _FREQUENCIES
    if not low <= value <= high:  # never true of not-a-number
        raise ValueError(
            f"{low:f} to {high:.0f} steps per second are expected; "
            "10 is usual, and `mode: on_change` steps at once when a message comes"
        )
    return float(value)


def _version(text: str) -> str:
    if re.fullmatch(r"[0-9]+\.[0-9]+\.[0-9]+", text) is None:
        raise ValueError("three numbers are expected, such as 0.1.0")
    return text


def _maintainer(text: str) -> str:
    form = r"[^<>]+<[^<>@\s]+@[^<>\s]+\.[^<>\s]+>"
    if re.fullmatch(form, text) is None or not text.isprintable():
        raise ValueError("a name and an address are expected: Ada Lovelace <ada@example.org>")
    return text


def _line(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise ValueError("one line of text is expected")
    return text


def _file_name(text: str) -> str:
    if not text.strip() or "\0" in text:
        raise ValueError("the name of a file is expected")
    return text


def _named(value: object) -> object:
    """Accept D7.2's ids that YAML 1.1 reads as numbers."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


Name = Annotated[StrictStr, BeforeValidator(_named), Field(min_length=1)]
MaxAge = Annotated[float | Literal["none"] | None, BeforeValidator(_max_age)]
FileName = Annotated[StrictStr, AfterValidator(_file_name)]
Line = Annotated[StrictStr, AfterValidator(_line)]
Topic = Annotated[StrictStr, AfterValidator(_topic)]
MessageType = Annotated[StrictStr, AfterValidator(_message_type)]
Default = StrictBool | StrictInt | StrictFloat | StrictStr | None


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ModelSection(_Section):
    """Which model runs, and how.

    Attributes:
        frequency: steps per second, in Hz.
        mode: one step per period, or at once when a message comes (and per period).
        parameters: D7.2's list of maps; names the file of a kind that has one.

    Further keys belong to the kind, which checks them.
    """

    model_config = ConfigDict(extra="allow", frozen=True)

    id: Name
    type: StrictStr
    frequency: Annotated[float, BeforeValidator(_frequency)] = 10.0
    mode: Literal["rate", "on_change"] = "rate"
    parameters: Any = None


class _Entry(_Section):
    id: Name


class SimulatorOutput(_Entry):
    """One topic of the robot that the monitor listens to.

    Attributes:
        max_age: default of the inputs that require it, in seconds.
    """

    type: MessageType
    topic: Topic
    max_age: MaxAge = None


class Input(_Entry):
    """One input of the monitor.

    Attributes:
        requires: ids of the simulator outputs it is made of.
        default: value before the first message.
        unit: unit of the value, when it is not the model's.
        field: path into the message (``data``, ``guarantees[G0].active``).
        expression: a condition or value over the messages (docs/events.md), in place of ``field``.
        expression_file: file of events, relative to the configuration, that has it in place of
            ``expression``.
        event: which event of that file it is; the only one needs no name.
        states: for an input that is a state: state -> condition.
        polarity: what an UNKNOWN condition gives: nothing (``EVIDENCE``) or true (``HAZARD``).
        max_age: seconds after which the value is unknown, or ``none`` for never.
        renamed_from: former id; its hand-written body moves along.
    """

    type: Annotated[StrictStr, AfterValidator(_input_type)] | None = None
    requires: list[Name] = []
    default: Default = None
    unit: StrictStr | None = None
    field: StrictStr | None = None
    expression: StrictStr | None = None
    expression_file: FileName | None = None
    event: Name | None = None
    states: dict[StrictStr, StrictStr] | None = None
    polarity: Literal["EVIDENCE", "HAZARD"] = "EVIDENCE"
    max_age: MaxAge = None
    renamed_from: Name | None = None
    allow_unsafe_default: StrictBool = False

    @property
    def is_computed(self) -> bool:
        """Whether an expression gives the value."""
        return any(one is not None for one in (self.expression, self.expression_file, self.states))


class Output(_Entry):
    """One topic on which the result is published.

    Attributes:
        field: path into the result (``guarantees[G0].active``): its value alone is published, as a
            message of ``std_msgs``; without it the whole result.
        event: of a kind that gives several messages in a step: the id of the one that goes here.
    """

    topic: Topic
    field: StrictStr | None = None
    event: Name | None = None


class PackageSection(_Section):
    """What stands in the generated package.xml."""

    version: Annotated[StrictStr, AfterValidator(_version)] = "0.1.0"
    description: Line | None = None
    maintainer: Annotated[StrictStr, AfterValidator(_maintainer)] | None = None
    license: Line = "Apache-2.0"


class Config(_Section):
    """The whole file, checked for form; whether it fits the model is checked with the model.

    Attributes:
        declarations: VAR, CONST and ENUM for the expressions of inputs.
        MessageTypes: message type -> field -> type, as in its ``.msg`` file: for types that
            eddi-scaffold does not know.
    """

    Model: ModelSection
    SimulatorOutputs: list[SimulatorOutput] = []
    declarations: list[StrictStr] = []
    EDDIInputs: list[Input] = []
    EDDIOutputs: list[Output] = []
    Package: PackageSection = PackageSection()
    MessageTypes: dict[MessageType, dict[StrictStr, StrictStr]] = {}


@dataclass(frozen=True)
class ConfigFile:
    """A configuration with the place of each of its parts.

    Attributes:
        places: path such as ``("EDDIInputs", 0, "id")`` -> place of the value.
        remembered: it comes from the answers of a package, not from its file.
        text: of the file.
        event_files: name of each ``expression_file`` as it stands there -> its text.
    """

    config: Config
    name: str
    places: Mapping[tuple[str | int, ...], Place]
    remembered: bool = False
    text: str = ""
    event_files: Mapping[str, str] = field(default_factory=dict)

    def as_json(self) -> str:
        """Return configuration and files of events as canonical JSON: what the answers remember."""
        document = self.config.model_dump(exclude_defaults=True)
        if self.event_files:
            document[_EVENT_FILES] = dict(self.event_files)
        return json.dumps(document, sort_keys=True)

    def path(self, name: str) -> str:
        """Return the path of a file that is named relative to this configuration, for places."""
        return name if self.remembered else str(Path(self.name).parent / name)

    def read(self, name: str) -> Source:
        """Open a file that is named relative to this configuration.

        Raises:
            EddiError: it cannot be read (F001), it is not below the folder of the configuration
                (F009), or the configuration is a remembered one (K033).
        """
        if self.remembered:
            message = f"{name!r} cannot be read: the configuration is remembered, not given"
            raise EddiError(error("K033", message, hint="name the configuration with -c"))
        return read_source(beside(self.name, name))

    def inside(self, *path: str | int) -> Callable[[int], Place]:
        """Return offset in the text of a value -> its place in the file."""
        return inside_scalar(self.text, self.place(*path))

    def place(self, *path: str | int) -> Place:
        """Return the place of a part, or of the nearest part around it."""
        for end in range(len(path), -1, -1):
            if path[:end] in self.places:
                return self.places[path[:end]]
        return Place(self.name)


def from_json(text: str, name: str) -> ConfigFile:
    """Read back what ``ConfigFile.as_json`` wrote.

    Raises:
        ValueError: a person or a merge has damaged it.
    """
    document = json.loads(text)
    files = document.pop(_EVENT_FILES, {}) if isinstance(document, dict) else {}
    if not isinstance(files, dict) or not all(isinstance(one, str) for one in files.values()):
        raise ValueError(f"{_EVENT_FILES} is no map of texts")
    config = Config.model_validate(document)
    return ConfigFile(config, name, {}, remembered=True, event_files=files)


@dataclass(frozen=True)
class Robot:
    """What models of a robot say beside a configuration.

    Attributes:
        outputs: the entries of ``SimulatorOutputs`` as they stand -> those that count.
        types: message type -> fields, of the specifications beside the node models.
    """

    outputs: Callable[[Any], Any] = lambda entries: entries
    types: FieldsOf = field(default_factory=dict)


def read_config(
    source: Source, robot: Robot | None = None
) -> tuple[ConfigFile | None, list[Problem]]:
    """Read a configuration; the result is ``None`` when a problem is an error.

    Args:
        source: the file.
        robot: models of the robot, whose topics and message types count beside the file.
    """
    if looks_like_xml(source.data):
        return None, [error("K001", "this is XML, not an eddi_config.yml", Place(source.name))]
    document, problems = read_map(source, "K001")
    if document is None:
        return None, problems
    places: dict[tuple[str | int, ...], Place] = {}
    data = _plain(_renamed(document, problems), (), places, problems)
    # an empty section is an empty list, as D7.2's tools read it
    data = {key: [] if value is None and key != "Model" else value for key, value in data.items()}
    if robot is not None:
        data["SimulatorOutputs"] = robot.outputs(data.get("SimulatorOutputs") or [])
    problems += _unknown_options(data.get("Model"), places, source.name)
    try:
        config = Config.model_validate(data)
    except ValidationError as failed:
        return None, in_order([*problems, *_translated(failed, places, source.name)])
    text = source.data.decode("utf-8-sig", "replace")
    file = ConfigFile(_with_types(config, robot), source.name, places, text=text)
    problems += _repeated_ids(file)
    files, unread = _event_files(file)
    file = replace(file, event_files=files)
    problems += unread
    return (None if has_errors(problems) else file), in_order(problems)


def _event_files(file: ConfigFile) -> tuple[dict[str, str], list[Problem]]:
    """Read the files of events that inputs name (F001, E001)."""
    texts: dict[str, str] = {}
    problems: list[Problem] = []
    for index, entry in enumerate(file.config.EDDIInputs):
        name = entry.expression_file
        if name is None or name in texts:
            continue
        try:
            source = file.read(name)
            texts[name] = source.data.decode("utf-8-sig")
        except EddiError as failure:
            (problem,) = failure.problems
            place = file.place("EDDIInputs", index, "expression_file")
            hint = problem.hint if problem.code == "F009" else _near(Path(file.path(name)))
            problems.append(_about(replace(problem, hint=hint), name, place))
        except UnicodeDecodeError as wrong:
            line = source.data.count(b"\n", 0, wrong.start) + 1
            place = Place(source.name, line, 1)
            problems.append(error("E001", "the file is not UTF-8 text", place))
    return texts, problems


def _near(path: Path) -> str | None:
    there = [one.name for one in path.parent.glob("*.events")] if path.parent.is_dir() else []
    return did_you_mean(path.name, sorted(there))


def _about(problem: Problem, name: str, place: Place) -> Problem:
    """Say of which file a problem is, where its name stands."""
    return replace(problem, message=f"{name!r}: {problem.message}", place=place)


def _with_types(config: Config, robot: Robot | None) -> Config:
    """Take in the message types of the robot's models that the inputs need, to be remembered."""
    if robot is None:
        return config
    required = {name for item in config.EDDIInputs for name in item.requires}
    types = [source.type for source in config.SimulatorOutputs if source.id in required]
    found = {**used(types, robot.types), **config.MessageTypes}
    return config.model_copy(update={"MessageTypes": found})


def options_of(file: ConfigFile | None) -> Options:
    """Return what a configuration says to the kind of its model."""
    if file is None:
        return Options()
    config, section = file.config, file.config.Model
    values = {**(section.model_extra or {}), "parameters": section.parameters}
    types = {source.id: source.type for source in config.SimulatorOutputs}
    inputs = tuple(
        DeclaredInput(
            id=item.id,
            type=_TYPES[item.type] if item.type is not None else None,
            unit=item.unit,
            default=item.default,
            place=file.place("EDDIInputs", index),
            messages=tuple(types[name] for name in item.requires),
        )
        for index, item in enumerate(config.EDDIInputs)
    )
    return Options(
        id=section.id,
        values={key: value for key, value in values.items() if value is not None},
        inputs=inputs,
        frequency=section.frequency,
        parts=tuple(output.event for output in config.EDDIOutputs),
        place=lambda *path: file.place("Model", *path),
        read=file.read,
    )


def full_topic(name: str, namespace: str, package: str) -> str:
    """Return the full name of a topic, as ROS resolves it for a node.

    Args:
        name: as in the configuration: absolute, relative, or private with ``~``.
        namespace: of the robot, such as ``/robot1``; empty for none.
        package: name of the monitor's package and node.
    """
    if name.startswith("/"):
        return name
    own = f"{package}/" if name.startswith("~") else ""
    return f"{namespace}/{own}{name.removeprefix('~')}"


_MODEL_KEYS = ("model", "config", "file")
_Keys = tuple[str | int, ...]


def named_model(file: ConfigFile) -> str | None:
    """Return the file that ``parameters`` names as the model, relative to the configuration.

    SESAME D7.2 writes ``parameters: [{config: safeml_config.yml}]``.
    """
    found = _named_model(file)
    return None if found is None else found[0]


def named_model_path(file: ConfigFile) -> Path | None:
    """Return where the file is that ``parameters`` names, ``None`` where it names none.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the configuration
            (F009); the place is that of its name.
    """
    found = _named_model(file)
    if found is None:
        return None
    name, where = found
    try:
        path = beside(file.name, name)
        path.stat()
    except EddiError as failure:
        raise EddiError(*(_about(p, name, file.place(*where)) for p in failure.problems)) from None
    except (OSError, ValueError):
        hint = "a name is relative to the folder of the configuration"
        message = f"there is no file {name!r}"
        raise EddiError(error("F001", message, file.place(*where), hint)) from None
    return path


def _named_model(file: ConfigFile) -> tuple[str, _Keys] | None:
    """Return the name of the model's file and the keys under which it stands."""
    given = file.config.Model.parameters
    where: _Keys = ("Model", "parameters")
    maps = [((*where, k), one) for k, one in enumerate(given)] if isinstance(given, list) else []
    for key in _MODEL_KEYS:
        for keys, one in maps or [(where, given)]:
            name = one.get(key) if isinstance(one, dict) else None
            if isinstance(name, str) and name:
                return name, (*keys, key)
    return None


def _options_for(section: object) -> set[str]:
    """Return the keys that the kind of this section understands; of all kinds if it is unknown."""
    name = section.get("type") if isinstance(section, Mapping) else None
    wanted = name.casefold() if isinstance(name, str) else None
    fitting = [
        kind for kind in kinds().values() if wanted in {t.casefold() for t in kind.config_types}
    ]
    return {key for kind in fitting or kinds().values() for key in kind.options}


def _unknown_options(
    section: object, places: Mapping[tuple[str | int, ...], Place], file: str
) -> Iterable[Problem]:
    if not isinstance(section, Mapping):
        return
    known = {*ModelSection.model_fields, *_options_for(section)}
    near = NearNames(sorted(known), "known keys")
    for key in section:
        if key not in known:
            place = places.get(("Model", key, _KEY), Place(file))
            yield error("K004", f"unknown key {key!r}", place, near.hint(key))


def _renamed(document: Map, problems: list[Problem]) -> Map:
    """Give the sections that D7.2's figures misspell their names."""
    entries = []
    for key, value in document.entries:
        if key.text in _ALIASES:
            name = _ALIASES[key.text]
            problems.append(
                warning(
                    "K002", f"{key.text!r} is read as {name!r}", key.place, "rename the section"
                )
            )
            key = replace(key, text=name)  # noqa: PLW2901 - the same key, spelt right
        entries.append((key, value))
    return replace(document, entries=tuple(entries))


def _plain(
    node: Node,
    path: tuple[str | int, ...],
    places: dict[tuple[str | int, ...], Place],
    problems: list[Problem],
) -> Any:
    """Turn a node graph into plain values; note where each stands."""
    places[path] = node.place
    if isinstance(node, Map):
        result = {}
        for key, value in node.entries:
            inner = (*path, key.text)
            result[key.text] = _plain(value, inner, places, problems)
            places[(*inner, _KEY)] = key.place
            if isinstance(value, Map | Items):
                places[inner] = key.place
        return result
    if isinstance(node, Items):
        return [_plain(item, (*path, i), places, problems) for i, item in enumerate(node.items)]
    if differs_between_versions(node):
        value = value_11(node)
        message = f"{node.text!r} is read as {value!r} (YAML 1.1)"
        problems.append(
            warning("K008", message, node.place, "write it in quotes if a text is meant")
        )
    return value_11(node)


def _translated(
    failed: ValidationError, places: Mapping[tuple[str | int, ...], Place], file: str
) -> Iterable[Problem]:
    """Turn pydantic's findings into problems with a place, one per value."""
    seen: set[tuple[str | int, ...]] = set()
    for found in failed.errors():
        path = tuple(found["loc"])
        while path and path not in places:
            path = path[:-1]
        if path in seen and found["type"] != "missing":
            continue
        seen.add(path)
        place = places.get(path, Place(file))
        key = str(found["loc"][-1])
        if found["type"] == "missing":
            yield error("K003", f"{_named_path(path) or 'the file'} has no {key!r}", place)
        elif found["type"] == "extra_forbidden":
            known = _known_keys(path[:-1])
            hint = did_you_mean(key, known) or f"known keys: {', '.join(sorted(known))}"
            if not key.isidentifier() and (*path[:-1], "expression") in places:
                hint = "put the expression in quotes: inside { } a comma ends it"
            yield error("K004", f"unknown key {key!r}", places.get((*path, _KEY), place), hint)
        else:
            own = _TEXTS.get(found["type"]) or found["msg"].removeprefix("Value error, ")
            if len(found["loc"]) > len(path):  # one of several types that would do
                own = "true, false, a number or a text is expected"
            text, _, hint = own.replace("Input should be", "must be").partition("; ")
            message = f"{_named_path(path) or 'the file'}: {text}"
            yield error("K005", message, place, hint or None)


def _named_path(path: Sequence[str | int]) -> str:
    """Name a value by its keys; which entry of a list it is says the place."""
    return ".".join(part for part in path if isinstance(part, str))


def _known_keys(path: tuple[str | int, ...]) -> set[str]:
    sections: dict[str, type[BaseModel]] = {
        "Model": ModelSection,
        "SimulatorOutputs": SimulatorOutput,
        "EDDIInputs": Input,
        "EDDIOutputs": Output,
        "Package": PackageSection,
    }
    section = sections.get(str(path[0])) if path else Config
    return set(section.model_fields) if section else set()


def _repeated_ids(file: ConfigFile) -> Iterable[Problem]:
    config = file.config
    required_ids = {name for item in config.EDDIInputs for name in item.requires}
    sections: dict[str, Sequence[_Entry]] = {
        "SimulatorOutputs": config.SimulatorOutputs,
        "EDDIInputs": config.EDDIInputs,
        "EDDIOutputs": config.EDDIOutputs,
    }
    for section, entries in sections.items():
        first: dict[str, int] = {}
        for index, entry in enumerate(entries):
            if entry.id in first:
                before = file.place(section, first[entry.id], "id").line
                # A parsed robot system may hold one id twice: harmless until an input requires it.
                harmless = section == "SimulatorOutputs" and entry.id not in required_ids
                yield (warning if harmless else error)(
                    "K006",
                    f"the id {entry.id!r} stands twice in {section}, first in line {before}",
                    file.place(section, index, "id"),
                )
            first.setdefault(entry.id, index)
    known = {entry.id for entry in config.SimulatorOutputs}
    near = NearNames(known)
    for index, item in enumerate(config.EDDIInputs):
        for position, required in enumerate(item.requires):
            if required not in known:
                yield error(
                    "K007",
                    f"input {item.id!r} requires {required!r}, which is no simulator output",
                    file.place("EDDIInputs", index, "requires", position),
                    near.hint(required),
                )
