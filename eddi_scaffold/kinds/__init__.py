"""Monitor kinds: what the generator knows of ConSerts, Bayesian networks, ... and their models.

A kind is one folder below this one that offers ``KIND``. Kinds know neither each other nor a
platform.
"""

from __future__ import annotations

import importlib
import math
import pkgutil
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, TypeAlias, cast

from eddi_scaffold.common.claims import Acceptance, Element, Listen, Meaning, Meanings, Use
from eddi_scaffold.common.problems import EddiError, Place
from eddi_scaffold.common.toml_tables import read_toml

if TYPE_CHECKING:
    from typing_extensions import Self

    from eddi_scaffold.common.claims import Claim
    from eddi_scaffold.common.files import Source
    from eddi_scaffold.common.problems import Problem
    from eddi_scaffold.diagrams import Diagram
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.hazard_analysis import HazardAnalysis
    from eddi_scaffold.eddi_xml.links import Links
    from eddi_scaffold.evidence.emitted import Emitted
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

InputType = Literal["bool", "float", "int", "str", "state", "float[]", "bool[]"]
"""``state``: a text, the name of a state, or one number per state (likelihoods)."""
JsonValue: TypeAlias = (
    "bool | int | float | str | Sequence[JsonValue] | Mapping[str, JsonValue] | None"
)
"""What ``json`` reads and writes."""


@dataclass(frozen=True)
class ModelInput:
    """One input that a monitor needs at run time."""

    id: str
    type: InputType  # Python type of the value that `EDDIInput` holds
    safety: bool = True  # a value that stays when its publisher dies is dangerous: it has to age
    unit: str | None = None  # unit of the model for a number, `None` otherwise
    # unit that a configuration may declare -> exact factor (numerator, denominator) to `unit`
    units: Mapping[str, tuple[int, int]] | None = None
    description: str | None = None  # one line for generated comments
    covered: str | None = None  # which values count as good (`[0, 5) m`), for comments
    # whether a value, in `unit`, can make an output active: such a default is refused; `None` when
    # the kind has no such notion
    is_good: Callable[[object], bool] | None = None
    # where the ranges of good numbers begin; each of them is good unless it is empty
    starts: tuple[float, ...] = ()
    # its attribute holds the list of all values since the last step, not the latest one
    every_message: bool = False
    attribute: str | None = None  # its name in `EDDIInput`, by default made of the id
    sample: JsonValue = None  # a value while all is in order, for the example of a package
    states: tuple[str, ...] = ()  # names of the states of one that is a state, for a draft
    timeout: float | None = None  # seconds after which the model takes it as unknown, for a draft
    is_three_valued: bool = False  # UNKNOWN is a value of its own: no value of it is silence
    is_demand: bool = False  # what other systems have to fulfil
    # how its value can bring a claim of the monitor nearer; by default any value that is known may
    uses: tuple[Use, ...] = (Use(),)


@dataclass(frozen=True)
class ModelOutput:
    """A topic that a model itself asks for, in addition to ``EDDIOutputs``."""

    id: str
    topic: str  # where one value of a message is published, as a message of `std_msgs`
    # fields of the message; a pair is the element of a list by a field and its value
    path: tuple[str | tuple[str, str], ...]
    place: Place
    # the additional message that contains the value (`evidence`), empty for the result itself
    of: str = ""


@dataclass(frozen=True)
class ReadResult:
    """What a reader found: models and everything that is wrong with them."""

    models: tuple[Model, ...]
    problems: tuple[Problem, ...]
    unread: tuple[Problem, ...] = ()  # what else is in the file, of which no monitor is made
    hazards: HazardAnalysis | None = None  # of an EDDI


@dataclass(frozen=True)
class DeclaredInput:
    """One entry of ``EDDIInputs``: for kinds whose inputs are not in the model."""

    id: str
    type: InputType | None
    unit: str | None
    default: JsonValue
    place: Place
    messages: tuple[str, ...] = ()  # types of the messages that it is made of


@dataclass(frozen=True)
class Options:
    """Options that a configuration gives to a kind; without a configuration, the defaults."""

    id: str | None = None  # `Model: id:`, for models that have no name of their own
    values: Mapping[str, JsonValue] = field(default_factory=dict)  # the keys of `Model:`
    inputs: tuple[DeclaredInput, ...] = ()  # the entries of `EDDIInputs`
    frequency: float | None = None  # steps per second
    parts: tuple[str | None, ...] = ()  # of the result that each output publishes, `None` for all
    # path into `values` (`"outputs", 0`) -> its place, or that of what encloses it
    place: Callable[..., Place] = lambda *_: Place()
    # the same -> offset in the text there -> its place
    inside: Callable[..., Callable[[int], Place]] = lambda *_: lambda _: Place()


@dataclass(frozen=True)
class ModelDraft:
    """What a configuration says of a model before a person has decided."""

    inputs: Sequence[ModelInput]  # what the monitor will read, as far as that is decided
    # further keys of `Model:`; those that are there already are left out
    options: Mapping[str, JsonValue] = field(default_factory=dict)
    # key path of an option -> what there is to decide, in one line
    notes: Mapping[tuple[str, ...], str] = field(default_factory=dict)


@dataclass(frozen=True)
class EditableMethod:
    """A method with one region in which a person may write."""

    name: str
    about: str  # id of the element of the model
    body: tuple[str, ...]  # default lines inside the region
    arguments: tuple[str, ...] = ()  # names behind `self`
    returns: str | None = None
    comments: tuple[str, ...] = ()  # lines below the signature, without `#`
    before: tuple[str, ...] = ()  # lines of Python before the region
    was: tuple[str, ...] = ()  # former ids, whose body moves along
    uses: tuple[str, ...] = ()  # what a body may use; a change asks for a look at it
    after: tuple[str, ...] = ()  # lines of Python after the region
    is_needed: bool = False  # nothing else gives what it returns


@dataclass(frozen=True)
class EditableModule:
    """An editable module of the kind, other than ``EDDIInput.py``.

    Every text is Python already: checked identifiers, literals and comments by ``escaping``, in
    lines of the few forms that ``copier_templates/shapes.jinja`` takes.
    """

    file: str  # file name; it ends in `_config.py`, or is `actions.py`
    docstring: str
    class_name: str  # its class, of which the monitor gets an instance
    class_docstring: str
    methods: tuple[EditableMethod, ...]
    imports: tuple[str, ...] = ()
    plain_methods: tuple[str, ...] = ()  # lines of those without a region, as in the class


@dataclass(frozen=True)
class Alias:
    """A generated module that offers names of the runtime where SESAME D7.2 had them."""

    name: str  # of the module, without `.py`; it ends in `_monitor` (`bn_monitor`)
    module: str  # module of the runtime (`bayesian_network`)
    names: tuple[str, ...]
    monitor_names: tuple[str, ...] = ()  # further ones for the package's `EDDIMonitor`


@dataclass(frozen=True)
class CrossCheck:
    """How the compiled model compares with an independent tool."""

    text: str  # one sentence for the package's README, the same on every machine
    problems: tuple[Problem, ...] = ()  # an error keeps the package from being written


@dataclass(frozen=True)
class Model:
    """One model of a kind, checked as far as it could be, and what is done with it.

    The base itself stands for a model of which only its package is there: it has a name.
    """

    kind: ClassVar[str] = ""
    name: str
    source: Source
    place: Place
    # of its own file, for the package of a model without a configuration; empty: its name
    file_stem: str = field(default="", compare=False)
    links: Links = field(default_factory=dict, compare=False)  # of paths of elements in the EDDI
    # elements of the EDDI that name it as what observes them, each with the event or threshold;
    # empty for the only one
    observes: tuple[tuple[str, str], ...] = field(default=(), compare=False)

    @property
    def safe_name(self) -> str:
        """Its name as that of a file."""
        return re.sub(r"[^\w.-]", "_", self.name).lstrip(".")[:60] or self.kind

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        """Return the models of a file of the kind's own, and what is wrong with it."""
        raise NotImplementedError

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        """Return the models of the kind in an EDDI, and what is wrong with them."""
        raise NotImplementedError

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:  # noqa: ARG003 - of an event
        """Return what the fields of its messages express of the claims on a topic, if known."""
        return _meanings(cls.kind)

    def check(self) -> Sequence[Problem]:
        """Return the problems that the readers do not see (static checks)."""
        return ()

    def counts(self) -> Mapping[str, int]:
        """Return what ``show`` prints, in order (``{"guarantees": 2, ...}``)."""
        raise NotImplementedError

    def outline(self) -> Sequence[str]:
        """Return the tree that ``show`` prints: lines with two blanks per level."""
        raise NotImplementedError

    def write(self) -> Mapping[str, str]:
        """Return file name -> text in a format of the kind.

        The first file reads back as a model that, called by this one's name, has its digest; it
        names the others.

        Raises:
            EddiError: the format cannot say something of the model (G004).
        """
        raise NotImplementedError

    def export(self) -> Mapping[str, str]:
        """Return what ``write`` does, and the same for other tools."""
        return self.write()

    def named(self, name: str) -> Self:
        """Return the model by another name, which its own files do not all hold."""
        return replace(self, name=name)

    def as_eddi_map(self) -> tuple[str, Sequence[tuple[str, str]]] | None:
        """Return key and values (tag, text) by which an EDDI holds a model of no class of its own.

        Raises:
            EddiError: an EDDI cannot hold it.
        """
        return None

    def diagram(self) -> Diagram | None:
        """Return its picture, ``None`` for a kind that has none."""
        return None

    def draft(self, options: Options) -> ModelDraft:
        """Return what a configuration with these options, of which some are ``TODO``, has to say.

        Raises:
            EddiError: no monitor can be made of the model.
        """
        configured, problems = self.configure(Options())
        if configured is None:
            raise EddiError(*problems)
        return ModelDraft(configured.inputs())

    def configure(self, options: Options) -> tuple[Self | None, list[Problem]]:
        """Return the model with the options of a configuration; what follows needs it."""
        return self, []

    def inputs(self) -> Sequence[ModelInput]:
        """Return the inputs that the monitor needs."""
        raise NotImplementedError

    def companion_messages(self) -> Mapping[str, str]:
        """Return name -> message that is published in addition, on ``<topic>/<name>``.

        In the runtime the monitor has a method ``<name>_message()`` for each.
        """
        return {}

    def separate_outputs(self) -> Sequence[str]:
        """Return the ids of results that are messages of their own, which an output may choose."""
        return ()

    def own_topics(self) -> Sequence[ModelOutput]:
        """Return the topics that the model itself asks for."""
        return ()

    def element_keys(self) -> Mapping[str, Sequence[str]]:
        """Return path of a list in a message of the kind -> the known keys of its elements."""
        return {}

    def editable_modules(self) -> Sequence[EditableModule]:
        """Return the modules in which people write, other than ``EDDIInput.py``."""
        return ()

    def readme(self) -> Sequence[str]:
        """Return lines of Markdown for the package's README; what comes of a model is escaped."""
        return ()

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        """Return the monitor."""
        raise NotImplementedError

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        """Return the test vectors of the configured model, made without what compiles it.

        ``inputs`` are those of the monitor, ``about`` names the file of the model and its digest.
        """
        raise NotImplementedError

    def verify(self, emitted: Emitted) -> Iterator[str]:
        """Compare the text of a monitor with the configured model, without what compiles it.

        What differs is noted in the text; what is proved is yielded, in a line each.

        Raises:
            UnprovedError: a statement has no form.
        """
        raise NotImplementedError

    def cross_check(self, running: Callable[[], Any]) -> CrossCheck | None:
        """Compare the running monitor with an independent tool, where there is one."""
        return None

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        """Return its claims, of a monitor with these inputs and so many steps per second."""
        raise NotImplementedError

    def acceptances(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Acceptance]:
        """Return what the model and its options accept in place of what is not known."""
        return ()

    def lag(self, output: str, input_: str) -> float:
        """Return the seconds beyond one step after which a bad value that lasts ends a claim.

        Infinite where nothing bounds them. The times of ``Claim.hold_s`` are not in it.
        """
        return math.inf

    def input_timeouts(self) -> Mapping[str, float]:
        """Return input -> seconds after which the model itself takes it as unknown."""
        return {}

    def elements(self) -> Sequence[Element]:
        """Return what can be traced, in order."""
        return ()

    def why_not_fulfilled(self, output: str, user: Model, item: str) -> str | None:
        """Return why one of its outputs does not fulfil what an input of another model asks for."""
        return None


@cache
def _meanings(kind: str) -> Meanings:
    """Return the meanings in the folder of a kind."""
    from pydantic import TypeAdapter  # noqa: PLC0415 - to know the kinds needs none

    tables = read_toml(Path(__path__[0], kind, "meanings.toml"))
    return TypeAdapter(dict[str, dict[str, Meaning]]).validate_python(tables)


class ClaimField(NamedTuple):
    """Where others find a claim in what a monitor publishes."""

    message: str
    field: str = "active"  # with {} for the id of the claim
    behind: str = ""  # what follows the topic of the result
    apart: bool = False  # where there are several, each is a message of its own
    options: tuple[str, ...] = ()  # keys of `Model:` that make claims, where the model does not
    d72: Callable[[str], str] = str  # its id as monitors of SESAME D7.2 publish it


@dataclass(frozen=True)
class Kind:
    """What is known of a monitor kind before any of its models is looked at: cheap to import."""

    name: str  # module-like name, the same in the runtime (`consert`)
    title: str  # for people (`ConSert`)
    config_types: tuple[str, ...]  # spellings of `Model: type:`, compared without case
    recognises: Callable[[Source], bool]  # does this file hold a model by itself?
    messages: Mapping[str, str]  # ROS message name -> `.msg` text; field names fit ROS 1 and ROS 2
    output_message: str  # name of the message that the monitor publishes
    model: str  # module and name of the class of its models
    topic: str = "result"  # last part of the topic that a drafted configuration publishes it on
    in_eddi: str = ""  # XPath, below a root of an EDDI, of all that its models may be read from
    claim: ClaimField | None = None
    options: tuple[str, ...] = ()  # keys of `Model:` in a configuration that this kind understands
    # of these, the values with which its messages are those of SESAME D7.2's monitors
    wire_of_d72: Mapping[str, str] = field(default_factory=dict)
    between_robots: Mapping[str, str] = field(default_factory=dict)  # messages of fleets
    # of these keys: message -> its text, where they ask for another one
    respelt: Callable[[Mapping[str, object]], Mapping[str, str]] = lambda _: {}
    inputs_of_model: bool = True  # the inputs are in the model, not in the configuration
    # what becomes of an output while an input that it needs is not known
    without_input: str = "nothing that needs it becomes known"
    aliases: tuple[Alias, ...] = ()  # generated modules with the names of SESAME D7.2
    named_by_config: bool = False  # its files hold one model without a name
    # ROS message name -> what a message of it says, for who only looks on
    verdicts: Mapping[str, Listen] = field(default_factory=dict)

    @property
    def all_messages(self) -> Mapping[str, str]:
        """The messages of its monitors, and those between robots."""
        return {**self.messages, **self.between_robots}

    @property
    def model_class(self) -> type[Model]:
        """The class of its models; imported, with all that it needs, when it is first asked for."""
        module, _, name = self.model.rpartition(".")
        loaded = importlib.import_module(f"{__name__}.{self.name}.{module}")
        return cast("type[Model]", getattr(loaded, name))


def messages_in(kind: str, group: str = "") -> Mapping[str, str]:
    """Return ROS message name -> text of the ``.msg`` files in the folder of a kind."""
    files = sorted(Path(kind, "messages", group).glob("*.msg"))
    return {path.stem: path.read_text("utf-8") for path in files}


COMMON = messages_in(__path__[0])
"""Messages of monitors of every kind: why their claims are as they are."""
WHY = "eddi_messages/Why"


@cache
def texts_of_messages() -> Mapping[str, str]:
    """Return ROS message name -> text of all messages of ``eddi_messages``."""
    of_kinds = (kind.all_messages for kind in kinds().values())
    return {name: text for texts in (*of_kinds, COMMON) for name, text in texts.items()}


@cache
def kinds() -> Mapping[str, Kind]:
    """Return every kind by name, sorted: each is a folder here that offers ``KIND``."""
    folders = (module.name for module in pkgutil.iter_modules(__path__) if module.ispkg)
    return {name: importlib.import_module(f"{__name__}.{name}").KIND for name in sorted(folders)}
