"""The form of ``eddi_config.yml``: its sections, keys and values (SESAME D7.2 Figs 32 and 39)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection
from typing import Annotated, Any, Literal

from eddi_runtime.node.start import FREQUENCIES
from eddi_runtime.peers import LONGEST_LEASE
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
    model_validator,
)

from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import HintedError, did_you_mean
from eddi_scaffold.config.field_types import PRIMITIVES

_MESSAGE_TYPE = re.compile(r"([a-z][a-z0-9_]*)(?:\.|/msg/|/)([A-Za-z][A-Za-z0-9_]*)")
_QUANTITY = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?(?:e[-+]?[0-9]{1,2})?) *([a-z]*)")
_ADDRESS = re.compile(r"[^<>]+<[^<>@\s]+@[^<>\s]+\.[^<>\s]+>")
_SECONDS = {"": 1.0, "ms": 1e-3, "s": 1.0, "sec": 1.0, "min": 60.0}
_LONGEST = 1e6  # seconds: more is not a limit at all


def _number(
    what: str,
    is_legal: Callable[[float], bool],
    hint: str | None = None,
    words: Collection[object] = (),
) -> BeforeValidator:
    """Return the check of a number, or of one of some words; the hint is for one beyond limits."""

    def check(value: object) -> object:
        if value in words:
            return value
        match = _QUANTITY.fullmatch(value.strip().casefold()) if isinstance(value, str) else None
        if match is not None and match[2] and match[2] in _SECONDS:
            value = float(f"{float(match[1]) * _SECONDS[match[2]]:.15g}")
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise HintedError(f"{what} are expected", "such as 0.5")
        if not is_legal(value):  # never true of not-a-number
            raise HintedError(f"{what} are expected", hint)
        return float(value)

    return BeforeValidator(check)


def text(is_legal: Callable[[str], object], what: str, hint: str | None = None) -> AfterValidator:
    """Return the check of a text."""

    def check(value: str) -> str:
        if not is_legal(value):
            raise HintedError(f"{what} is expected", hint)
        return value

    return AfterValidator(check)


def _is_line(text: str) -> bool:
    return bool(text.strip()) and text.isprintable()


def _message_type(text: str) -> str:
    match = _MESSAGE_TYPE.fullmatch(text)
    if match is None:
        raise ValueError("a message type is expected, such as std_msgs.Bool or std_msgs/Bool")
    return f"{match[1]}/{match[2]}"


def _field_type(text: str) -> str:
    name = text.partition("[")[0]
    if re.fullmatch("[a-z][a-z0-9_]*", name) and name not in PRIMITIVES:
        hint = did_you_mean(name, PRIMITIVES) or "such as float64 or std_msgs/Header"
        raise HintedError(f"there is no type {name!r}: a type of ROS messages is expected", hint)
    return text


def _named(value: object) -> object:
    """Accept D7.2's ids that YAML 1.1 reads as numbers."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


_LOW, _HIGH = FREQUENCIES
_frequency = _number(
    f"{_LOW:f} to {_HIGH:.0f} steps per second",
    lambda hertz: _LOW <= hertz <= _HIGH,
    "10 is usual, and `mode: on_change` steps at once when a message arrives",
)
_lease = _number(f"seconds above 0, up to {LONGEST_LEASE:g},", lambda s: 0 < s <= LONGEST_LEASE)
_promise = _number(f"seconds above 0, up to {_LONGEST:.0f},", lambda s: 0 < s <= _LONGEST)
_wait = _number(f"seconds from 0 to {_LONGEST:.0f}", lambda s: 0 <= s <= _LONGEST)
_max_age = _number(
    "seconds above 0, or the word none,", lambda s: 0 < s < math.inf, words=(None, "none")
)
_file_name = text(lambda name: name.strip() and "\0" not in name, "the name of a file")
_topic = text(is_ros_name, "a ROS name such as /rte/e0a (letters, digits, `_`, `/`)")
_version = text(re.compile(r"[0-9]+\.[0-9]+\.[0-9]+").fullmatch, "a version such as 0.1.0")
_maintainer = text(
    lambda line: _is_line(line) and _ADDRESS.fullmatch(line),
    "a name and address such as Ada Lovelace <ada@example.org>",
)
_digest = text(
    re.compile("[0-9a-f]{64}").fullmatch,
    "the SHA-256 of a model (64 digits of 0-9 and a-f)",
    "it is the `digest` in compiled.py of the package of that monitor",
)
Name = Annotated[StrictStr, BeforeValidator(_named), Field(min_length=1)]
MaxAge = Annotated[float | Literal["none"] | None, _max_age]
Lease = Annotated[float, _lease]  # seconds for which a word of another robot counts
FileName = Annotated[StrictStr, _file_name]
Line = Annotated[StrictStr, text(_is_line, "one line of text")]
Topic = Annotated[StrictStr, _topic]
MessageType = Annotated[StrictStr, AfterValidator(_message_type)]
FieldType = Annotated[StrictStr, AfterValidator(_field_type)]
Default = StrictBool | StrictInt | StrictFloat | StrictStr | None


class Section(BaseModel):
    """A map with the keys that stand here, and no others."""

    model_config = ConfigDict(extra="forbid", frozen=True)


USUAL_FREQUENCY = 10.0
"""Steps per second of a monitor whose configuration names none, or that has no configuration."""


class ModelSection(Section):
    """Which model runs, and how; further keys belong to the kind, which checks them."""

    model_config = ConfigDict(extra="allow", frozen=True)

    id: Name
    type: StrictStr
    frequency: Annotated[float, _frequency] = USUAL_FREQUENCY  # steps per second, in Hz
    # one step per period, or at once when a message comes (and per period)
    mode: Literal["rate", "on_change"] = "rate"
    # seconds from the start in which an input may wait for its first message before the diagnostics
    # call that an error; verdicts do not depend on it
    startup_grace: Annotated[float, _wait] = 10.0
    lifecycle: StrictBool = False  # on ROS 2, others say when the node monitors
    parameters: Any = None  # D7.2's list of maps; names the file of a kind that has one


class Entry(Section):
    """One entry of a list, known by its id."""

    id: Name


class InputQos(Section):
    """How a topic is read on ROS 2: what its publishers must offer, and how many messages wait."""

    reliability: Literal["best_effort", "reliable"] | None = None
    durability: Literal["volatile", "transient_local"] | None = None
    depth: Annotated[StrictInt, Field(ge=1, le=10_000)] | None = None


class OutputQos(InputQos):
    """How a topic is published on ROS 2."""

    # seconds between two messages that are promised
    deadline: Annotated[float, _promise] | None = None
    # seconds after which a message is not delivered any more
    lifespan: Annotated[float, _promise] | None = None


class PeersSection(Section):
    """Whose word a message must be, among the robots of ``Fleet``."""

    # names in the order in which they count, or `any` for any other robot
    robots: Annotated[tuple[Line, ...], Field(min_length=1)] | Literal["any"] = "any"
    model: Name  # name of the ConSert that must have given it
    digest: Annotated[StrictStr, _digest]  # SHA-256 of that ConSert's data
    guarantee: Name  # id of the guarantee that is wanted


MONITOR_AGE = 1.0
"""Seconds after which a message of a monitor is unknown: it says nothing of one that has died."""


class SimulatorOutput(Entry):
    """One topic of the robot that the monitor listens to."""

    type: MessageType
    topic: Topic
    # default of the inputs that require it, in seconds; `limit` is what counts
    max_age: MaxAge = None
    qos: InputQos = InputQos()  # quality of service, on ROS 2
    peers: PeersSection | None = None  # for the word of another robot: whose it must be

    @property
    def limit(self) -> float | str | None:
        """Its ``max_age``; what a monitor publishes has one where none is written."""
        is_of_monitor = self.type.startswith("eddi_messages/") and self.peers is None
        return MONITOR_AGE if self.max_age is None and is_of_monitor else self.max_age


class InputEntry(Entry):
    """One input of the monitor."""

    type: Literal["bool", "float", "int", "str", "state", "float[]", "bool[]"] | None = None
    requires: list[Name] = []  # ids of the simulator outputs it is made of
    default: Default = None  # value before the first message
    unit: StrictStr | None = None  # unit of the value, when it is not the model's
    field: StrictStr | None = None  # path into the message (`data`, `guarantees[G0].active`)
    # a condition or value over the messages (docs/reference/events.md), in place of `field`
    expression: StrictStr | None = None
    # file of events, relative to the configuration, that has it in place of `expression`
    expression_file: FileName | None = None
    event: Name | None = None  # which event of that file it is; the only one needs no name
    # for an input that is a state: state -> condition
    states: dict[StrictStr, StrictStr] | None = None
    # what an UNKNOWN condition gives: nothing (`EVIDENCE`) or true (`HAZARD`)
    polarity: Literal["EVIDENCE", "HAZARD"] = "EVIDENCE"
    max_age: MaxAge = None  # seconds after which the value is unknown, or `none` for never
    renamed_from: Name | None = None  # former id; its hand-written body moves along
    allow_unsafe_default: StrictBool = False

    @property
    def is_computed(self) -> bool:
        """Whether an expression gives the value."""
        return (self.expression, self.expression_file, self.states) != (None, None, None)


class OutputEntry(Entry):
    """One topic on which the result is published."""

    topic: Topic
    # path into the result (`guarantees[G0].active`): its value alone is published, as a message of
    # `std_msgs`; without it the whole result
    field: StrictStr | None = None
    # of a kind that gives several messages in a step: the id of the one that goes here
    event: Name | None = None
    qos: OutputQos = OutputQos()  # quality of service, on ROS 2


class PackageSection(Section):
    """The contents of the generated package.xml."""

    version: Annotated[StrictStr, _version] = "0.1.0"
    description: Line | None = None
    maintainer: Annotated[StrictStr, _maintainer] | None = None
    license: Line = "TODO"
    # whose ids and field names the messages have: `eddi`, or those of SESAME D7.2's monitors
    wire: Literal["eddi", "d7.2"] = "eddi"


PEERS_TOPIC, PEERS_LEASE = "/eddi/peers", 1.0
"""Where robots tell each other their guarantees, and the seconds for which these count."""


class FleetSection(Section):
    """The robots among which this one is."""

    robot: Line  # its name; the parameter `robot` of the node wins
    topic: Topic = PEERS_TOPIC  # on which each robot tells its guarantees to all
    lease: Lease = PEERS_LEASE  # seconds after which a word counts as unknown
    # all robots whose words count were checked together: no demand comes back to its own guarantee
    closed: StrictBool = False


FAULTS = ("drop", "nan", "delay", "duplicate", "freeze", "bias", "scale")
"""What ``inject`` does to a topic."""
_NUMBER = "[-+]?[0-9]{1,9}(?:[.][0-9]{1,9})?"
_fault = text(
    re.compile(
        f"drop|nan|duplicate|freeze|delay(?: {_NUMBER} ?m?s)?|bias {_NUMBER}|scale {_NUMBER}"
    ).fullmatch,
    "a fault",
    "drop, nan, delay, delay 0.2 s, duplicate, freeze, bias -2, scale 1000",
)
Fault = Annotated[StrictStr, _fault]


class Reaction(Section):
    """How soon a guarantee has to be gone after a fault, for ``inject``."""

    guarantee: Name
    hazard: Line | None = None  # what it keeps away, for people
    # seconds from a fault to the hazard: the fault tolerant time interval
    ftti: Annotated[float, _promise]
    reaction: Annotated[float, _wait] | None = None  # seconds of it that the robot needs to react
    faults: Annotated[list[Fault], Field(min_length=1)]
    topics: list[Topic] = []  # full names, by default all that the guarantee rests on
    accept: Line | None = None  # why these faults may have no bound, or not be exercised

    @property
    def within(self) -> float:
        """Seconds that are left to take the guarantee away."""
        return self.ftti - (self.reaction or 0.0)

    @model_validator(mode="after")
    def _leaves_time(self) -> Reaction:
        if self.within <= 0:
            raise HintedError("a reaction shorter than the ftti is expected")
        return self


class ConnectSection(Section):
    """What ``connect`` reads beside the rest."""

    # groups of words that mean the same in the names of this robot
    synonyms: list[list[StrictStr]] = []


class Config(Section):
    """The whole file, checked for form; whether it fits the model is checked with the model."""

    Model: ModelSection
    SimulatorOutputs: list[SimulatorOutput] = []
    declarations: list[StrictStr] = []  # VAR, CONST and ENUM for the expressions of inputs
    EDDIInputs: list[InputEntry] = []
    EDDIOutputs: list[OutputEntry] = []
    Fleet: FleetSection | None = None
    Package: PackageSection = PackageSection()
    Reactions: list[Reaction] = Field([], exclude=True)  # no package depends on it
    # message type -> field -> type, as in its `.msg` file: for types that eddi-scaffold does not
    # know
    MessageTypes: dict[MessageType, dict[StrictStr, FieldType]] = {}
    connect: ConnectSection = Field(ConnectSection(), exclude=True)  # no package depends on it
