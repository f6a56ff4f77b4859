"""Monitor kinds: what the generator knows of ConSerts, Bayesian networks, ... as plain functions.

A kind is one folder below this one that offers ``KIND``. Kinds know neither each other nor a
platform.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, Generic, Literal, NoReturn, TypeAlias, TypeVar

from eddi_scaffold.common.claims import Acceptance, Element, Listen, Meanings, Use
from eddi_scaffold.common.problems import EddiError, Place, problem

if TYPE_CHECKING:
    from eddi_scaffold.common.claims import Claim
    from eddi_scaffold.common.files import Source
    from eddi_scaffold.common.problems import Problem
    from eddi_scaffold.compiling.monitor import BoundInput, CompiledMonitor, Declaration
    from eddi_scaffold.diagrams import Diagram
    from eddi_scaffold.eddi_xml.document import EddiDocument
    from eddi_scaffold.eddi_xml.links import Links

InputType = Literal["bool", "float", "int", "str", "state", "float[]", "bool[]"]
"""``state``: a text, the name of a state, or one number per state (likelihoods)."""
JsonValue: TypeAlias = (
    "bool | int | float | str | Sequence[JsonValue] | Mapping[str, JsonValue] | None"
)
"""What ``json`` reads and writes."""
JsonObject: TypeAlias = Mapping[str, JsonValue]
"""What is written as an object."""
TODO = "TODO"
"""In a configuration, without quotes: what a person has still to decide."""


@dataclass(frozen=True)
class ModelInput:
    """One input that a monitor needs at run time.

    Attributes:
        id: as in the model (``RtE_A_E0``).
        type: Python type of the value that ``EDDIInput`` holds.
        safety: a value that stays forever when its publisher dies would be dangerous, so a
            missing ``max_age`` is a warning.
        unit: unit of the model for a number, ``None`` otherwise.
        units: unit -> exact factor (numerator, denominator) from that unit to ``unit``: the
            units in which a configuration may declare the input.
        description: one line for generated comments.
        covered: short text that describes which values count as good (``[0, 5) m``), for comments.
        is_good: would this value, in ``unit``, be evidence that can make an output active? Used to
            refuse unsafe defaults; ``None`` when the kind has no such notion.
        starts: where the ranges of good numbers begin; each of them is good unless it is empty.
        every_message: no message may be skipped or counted twice: the attribute holds the list of
            all values since the last step, not the latest one.
        attribute: its name in ``EDDIInput`` where the kind keeps names apart; by default it is
            made of the id.
        sample: a value that it has while all is in order, for the example of a package.
        states: names of the states of one that is a state, for a draft.
        timeout: seconds after which the model takes it as unknown, for a draft.
        is_demand: what other systems have to fulfil.
        uses: how its value can bring a claim of the monitor nearer; by default any value that is
            known may.
    """

    id: str
    type: InputType
    safety: bool = True
    unit: str | None = None
    units: Mapping[str, tuple[int, int]] | None = None
    description: str | None = None
    covered: str | None = None
    is_good: Callable[[object], bool] | None = None
    starts: tuple[float, ...] = ()
    every_message: bool = False
    attribute: str | None = None
    sample: JsonValue = None
    states: tuple[str, ...] = ()
    timeout: float | None = None
    is_demand: bool = False
    uses: tuple[Use, ...] = (Use(),)


@dataclass(frozen=True)
class ModelOutput:
    """A topic that a model itself asks for, in addition to ``EDDIOutputs``.

    Attributes:
        id: of the value that it carries.
        topic: where one value of a message is published, as a message of ``std_msgs``.
        path: fields of the message; a pair is the element of a list by a field and its value.
        place: where the topic is named.
        of: the additional message that contains the value (``evidence``), empty for the
            result itself.
    """

    id: str
    topic: str
    path: tuple[str | tuple[str, str], ...]
    place: Place
    of: str = ""


D_co = TypeVar("D_co", covariant=True)
C_co = TypeVar("C_co", covariant=True)


@dataclass(frozen=True)
class TypedModel(Generic[D_co, C_co]):
    """One model of a kind, checked as far as it could be.

    Attributes:
        kind: name of the kind (``consert``).
        name: name of the model in its file.
        data: the kind's own typed model; only the kind looks inside.
        source: the file it was read from.
        place: its place in that file.
        options: what the kind made of the configuration, ``None`` before; only the kind looks
            inside.
        file_stem: what the model's own file is called, empty where that has several, or is known
            by the model's name: the package of a model without a configuration.
        links: path of an element -> what is linked with it in the EDDI.
        observes: elements of the EDDI that name this model as what observes them, each with the
            event or threshold that it names; empty for the only one.
    """

    kind: str
    name: str
    data: D_co
    source: Source
    place: Place
    options: C_co | None = None
    file_stem: str = ""
    links: Links = field(default_factory=dict)
    observes: tuple[tuple[str, str], ...] = ()


Model = TypedModel[object, object]
"""A model of any kind, whose content is not inspected."""
M = TypeVar("M", bound=Model)


@dataclass(frozen=True)
class ReadResult:
    """What a reader found: models and everything that is wrong with them.

    Attributes:
        models: those that could be read.
        problems: of the whole file.
        unread: what else is in the file, of which no monitor is made.
    """

    models: tuple[Model, ...]
    problems: tuple[Problem, ...]
    unread: tuple[Problem, ...] = ()


@dataclass(frozen=True)
class DeclaredInput:
    """One entry of ``EDDIInputs``: for kinds whose inputs are not in the model.

    Attributes:
        messages: types of the messages it is made of (``std_msgs/Float32MultiArray``).
    """

    id: str
    type: InputType | None
    unit: str | None
    default: JsonValue
    place: Place
    messages: tuple[str, ...] = ()


def _nowhere(*_: str | int) -> Place:
    return Place()


def _no_files(name: str) -> Source:
    raise EddiError(problem("K033.no_folder", name=name))


@dataclass(frozen=True)
class Options:
    """Options that a configuration gives to a kind; without a configuration, the defaults.

    Attributes:
        id: ``Model: id:``, for models that have no name of their own.
        values: the keys of ``Model:`` that the kind declares, and ``parameters``; plain values.
        inputs: the entries of ``EDDIInputs``.
        frequency: steps per second.
        parts: of each output, the part of the result that it publishes; ``None`` for all.
        place: path into ``values`` (``"outputs", 0``) -> its place, or that of what encloses it.
        read: opens a file that is named relative to the configuration; raises EddiError.
    """

    id: str | None = None
    values: Mapping[str, JsonValue] = field(default_factory=dict)
    inputs: tuple[DeclaredInput, ...] = ()
    frequency: float | None = None
    parts: tuple[str | None, ...] = ()
    place: Callable[..., Place] = _nowhere
    read: Callable[[str], Source] = _no_files


@dataclass(frozen=True)
class Skeleton:
    """What a configuration says of a model before a person has decided.

    Attributes:
        inputs: what the monitor will read, as far as that is decided.
        options: further keys of ``Model:``; those that are there already are left out.
        notes: key path of an option -> what there is to decide, in one line.
    """

    inputs: Sequence[ModelInput]
    options: Mapping[str, JsonValue] = field(default_factory=dict)
    notes: Mapping[tuple[str, ...], str] = field(default_factory=dict)


@dataclass(frozen=True)
class EditableMethod:
    """A method with one region in which a person may write.

    Attributes:
        name: an identifier.
        about: id of the element of the model.
        arguments: names behind ``self``.
        returns: annotation, ``None`` for none.
        comments: lines below the signature, without ``#``.
        before: lines of Python before the region.
        was: former ids, whose body moves along.
        uses: what a body may use; a change asks for a look at a hand-written one.
        body: default lines inside the region.
        after: lines of Python after the region.
        is_needed: nothing else gives what it returns.
    """

    name: str
    about: str
    body: tuple[str, ...]
    arguments: tuple[str, ...] = ()
    returns: str | None = None
    comments: tuple[str, ...] = ()
    before: tuple[str, ...] = ()
    was: tuple[str, ...] = ()
    uses: tuple[str, ...] = ()
    after: tuple[str, ...] = ()
    is_needed: bool = False


@dataclass(frozen=True)
class EditableModule:
    """An editable module of the kind, other than ``EDDIInput.py``.

    Every text is Python already: checked identifiers, literals and comments by ``escaping``, in
    lines of the few forms that ``copier_templates/shapes.jinja`` takes.

    Attributes:
        file: file name; it ends in ``_config.py``.
        docstring: what the module is for, one sentence.
        class_name: its class, of which the monitor gets an instance.
        imports: lines.
        class_docstring: one sentence.
        plain_methods: lines of the methods without a region, indented as in the class.
        methods: those with a region.
    """

    file: str
    docstring: str
    class_name: str
    class_docstring: str
    methods: tuple[EditableMethod, ...]
    imports: tuple[str, ...] = ()
    plain_methods: tuple[str, ...] = ()


@dataclass(frozen=True)
class Alias:
    """A generated module that offers names of the runtime where SESAME D7.2 had them.

    Attributes:
        name: of the module, without ``.py``; it ends in ``_monitor`` (``bn_monitor``).
        module: module of the runtime (``bayesian_network``).
        names: what it offers of it.
        monitor_names: further names under which it offers the package's ``EDDIMonitor``.
    """

    name: str
    module: str
    names: tuple[str, ...]
    monitor_names: tuple[str, ...] = ()


@dataclass(frozen=True)
class CrossCheck:
    """How the compiled model compares with an independent tool.

    Attributes:
        text: one sentence for the package's README, the same on every machine.
        problems: what was found; an error keeps the package from being written.
    """

    text: str
    problems: tuple[Problem, ...] = ()


def _as_it_is(model: M, _: Options) -> tuple[M | None, list[Problem]]:
    return model, []


def _nothing(_: object) -> Mapping[str, NoReturn]:
    return {}


def _none(*_: object) -> Sequence[NoReturn]:
    return ()


def with_status(message: str) -> Callable[[Model], Mapping[str, str]]:
    """Return the ``beside`` of a kind that publishes the facts behind its result only."""
    return lambda _: {"status": message}


@dataclass(frozen=True)
class Functions(Generic[M]):
    """What a kind does with its models, which are of the type ``M``.

    Attributes:
        read_eddi: EDDI document -> models and problems, of a kind that has an ``in_eddi``.
        read_file: such a file -> models and problems.
        check: problems of one model that the readers do not see (static checks).
        counts: what ``show`` prints, in order (``{"guarantees": 2, ...}``).
        outline: the tree that ``show`` prints: lines with two blanks per level.
        export: file name -> text of the kind's own formats.
        in_map: key and values (tag, text) by which an EDDI holds such a model, of a kind that is
            no part of the metamodel; raises EddiError.
        inputs: the inputs that the monitor needs.
        compile: the monitor, of a configured model and its bound inputs.
        claims: of a configured model, its bound inputs, and the steps per second: its claims.
        field_meanings: what the fields of its messages express of what is known, where a topic
            has these claims; ``None``: they are not known.
        beside: name -> message that it publishes in addition, on ``<topic>/<name>``; in the
            runtime the monitor has a method ``<name>_message()`` for each.
        parts: ids of results that are messages of their own, which an output may choose.
        outputs: topics that a configured model itself asks for.
        configure: applies the options of the configuration to the model; comes before ``inputs``
            and all below.
        modules: modules in which people write.
        cross_check: compares the running monitor with an independent tool before a package is
            written.
        readme: lines of Markdown for the package's README; what comes of a model is escaped.
        diagram: the picture of a model.
        ids: path of a list in a message of the kind -> the keys of its elements, as far as they are
            known (``output_nodes[Collision].outcomes`` -> ``High``, ...).
        unfulfilled: why an output of a model does not fulfil an input of another one of this
            kind, ``None`` where it does, or where nothing is asked of that input.
        acceptances: of the same as ``claims``: what the model and its options accept in place of
            what is not known.
        input_timeouts: input -> seconds after which the kind itself takes it as unknown, for those
            that have such a limit.
        elements: of a configured model: what can be traced, in order.
        skeleton: what a configuration with these options has still to say, for kinds whose inputs
            are not all in the model; an option may still be ``TODO``.
    """

    read_file: Callable[[Source, Sequence[str]], ReadResult]
    counts: Callable[[M], Mapping[str, int]]
    outline: Callable[[M], Sequence[str]]
    export: Callable[[M], Mapping[str, str]]
    inputs: Callable[[M], Sequence[ModelInput]]
    compile: Callable[[M, Declaration], CompiledMonitor]
    claims: Callable[[M, Sequence[BoundInput], float], Sequence[Claim]]
    field_meanings: Callable[[Sequence[Claim] | None], Meanings]
    in_map: Callable[[M], tuple[str, Sequence[tuple[str, str]]]] | None = None
    read_eddi: Callable[[EddiDocument, Source, Sequence[str]], ReadResult] | None = None
    check: Callable[[M], Sequence[Problem]] = _none
    beside: Callable[[M], Mapping[str, str]] = _nothing
    configure: Callable[[M, Options], tuple[M | None, list[Problem]]] = _as_it_is
    modules: Callable[[M], Sequence[EditableModule]] = _none
    cross_check: Callable[[M, Any], CrossCheck] | None = None
    readme: Callable[[M], Sequence[str]] = _none
    diagram: Callable[[M], Diagram] | None = None
    parts: Callable[[M], Sequence[str]] = _none
    outputs: Callable[[M], Sequence[ModelOutput]] = _none
    ids: Callable[[M], Mapping[str, Sequence[str]]] = _nothing
    unfulfilled: Callable[[M, str, M, str], str | None] | None = None
    skeleton: Callable[[M, Options], Skeleton] | None = None
    acceptances: Callable[[M, Sequence[BoundInput], float], Sequence[Acceptance]] = _none
    input_timeouts: Callable[[M], Mapping[str, float]] = _nothing
    elements: Callable[[M], Sequence[Element]] = _none


@dataclass(frozen=True)
class Kind(Generic[M]):
    """What is known of a monitor kind before any of its models is looked at: cheap to import.

    Attributes:
        name: module-like name, the same in the runtime (``consert``).
        title: for people (``ConSert``).
        config_types: spellings of ``Model: type:`` in a configuration, compared without case.
        sniff: does this file, by its first bytes and name, hold a model of this kind by itself?
        in_eddi: XPath, below a root of an EDDI, of all that its models may be read from; empty
            for a kind of which an EDDI has none.
        messages: ROS message name -> ``.msg`` text; field names fit ROS 1 and ROS 2.
        between_robots: the same for what robots tell each other, of a kind that has guarantees.
        output_message: name of the message that the monitor publishes.
        topic: last part of the topic that a drafted configuration publishes it on.
        options: keys of ``Model:`` in a configuration that this kind understands.
        respelt: of these keys: message -> its text, where they ask for another one.
        inputs_of_model: the inputs are in the model, not in the configuration.
        without_input: what becomes of an output while an input that it needs is not known.
        aliases: generated modules with the names of SESAME D7.2.
        requirements: what the runtime of this kind needs from PyPI.
        named_by_config: its files hold one model without a name; the configuration's id is one.
        verdicts: ROS message name -> what a message of it says, for who only looks on.
        load: imports the functions of the kind, with all that they need.
    """

    name: str
    title: str
    config_types: tuple[str, ...]
    sniff: Callable[[Source], bool]
    messages: Mapping[str, str]
    output_message: str
    load: Callable[[], Functions[M]]
    topic: str = "result"
    in_eddi: str = ""
    options: tuple[str, ...] = ()
    between_robots: Mapping[str, str] = field(default_factory=dict)
    respelt: Callable[[Mapping[str, object]], Mapping[str, str]] = _nothing
    inputs_of_model: bool = True
    without_input: str = "nothing that needs it becomes known"
    aliases: tuple[Alias, ...] = ()
    requirements: tuple[str, ...] = ()
    named_by_config: bool = False
    verdicts: Mapping[str, Listen] = field(default_factory=dict)

    @property
    def all_messages(self) -> Mapping[str, str]:
        """The messages of its monitors, and those between robots."""
        return {**self.messages, **self.between_robots}

    @property
    def functions(self) -> Functions[M]:
        """What the kind does with its models; imported when it is first asked for."""
        return self.load()


@cache
def kinds() -> Mapping[str, Kind[Model]]:
    """Return every kind by name, sorted: each is a folder here that offers ``KIND``."""
    found = {}
    for module in pkgutil.iter_modules(__path__):
        if module.ispkg:
            # A function of it is given models of its own only: those whose `kind` is its name.
            kind: Kind[Model] = importlib.import_module(f"{__name__}.{module.name}").KIND
            found[kind.name] = kind
    return dict(sorted(found.items()))
