"""The functions of the kind: reading, checks and reports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.claims import Claim, Element
from eddi_scaffold.common.files import PartSource, Source
from eddi_scaffold.common.problems import Problem, has_errors, in_order, problem
from eddi_scaffold.compiling.monitor import BoundInput
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.kinds import (
    DeclaredInput,
    Functions,
    ModelInput,
    Options,
    ReadResult,
    Skeleton,
    with_status,
)
from eddi_scaffold.kinds.safeml import show
from eddi_scaffold.kinds.safeml.compile import compile_safeml
from eddi_scaffold.kinds.safeml.messages import MEANINGS, VIOLATION_FIELD, VIOLATION_FIELDS
from eddi_scaffold.kinds.safeml.plan import plan
from eddi_scaffold.kinds.safeml.read_eddi import in_map, read_eddi
from eddi_scaffold.kinds.safeml.reference import read_named
from eddi_scaffold.kinds.safeml.scope import (
    NAME,
    Plan,
    Planned,
    SafeMLFile,
    SafeMLModel,
    SafeMLOptions,
)
from eddi_scaffold.kinds.safeml.settings import export as settings_text
from eddi_scaffold.kinds.safeml.settings import read_settings

DEFAULT_INPUT = "sample"
_PERIODS = 10
"""Steps without a sample after which a window is too old, unless ``max_age`` is given."""

_DOUBLE = "std_msgs/Float64"


def read_file(source: Source, _: Sequence[str]) -> ReadResult:
    """Read ``safeml_config.yml`` and the reference that it names, relative to it."""
    settings, problems = read_settings(source)
    if settings is None:
        return ReadResult((), tuple(in_order(problems)))
    reference, problems = read_named(source.name, settings)
    if reference is None:
        return ReadResult((), tuple(in_order(problems)))
    file = SafeMLFile(settings, reference)
    return ReadResult((SafeMLModel(NAME, source.stem, file, source, settings.place("")),), ())


def check(model: SafeMLModel) -> Sequence[Problem]:
    """Return what is wrong with tests and thresholds, regardless of the configuration."""
    return _planned(model, single=model.data.settings.input_dtype == "float32").problems


def configure(model: SafeMLModel, options: Options) -> tuple[SafeMLModel | None, list[Problem]]:
    """Find thresholds for the type of the messages; the configuration's id becomes the name."""
    settings = model.data.settings
    problems = [problem("K013.one_input", item.place, input=item.id) for item in options.inputs[1:]]
    problems += _wrong_field(options)
    single = settings.input_dtype == "float32" or (
        settings.input_dtype == "auto" and _is_single(options.inputs[:1])
    )
    planned = _planned(model, single=single)
    problems += planned.problems
    if planned.plan is None or has_errors(problems):
        return None, problems
    max_age = settings.max_age
    if max_age is None and options.frequency is not None:
        max_age = _PERIODS / options.frequency
    input_id = options.inputs[0].id if options.inputs else DEFAULT_INPUT
    connection = SafeMLOptions(planned.plan, input_id, max_age, options.frequency)
    return replace(model, name=options.id or model.name, options=connection), problems


def _wrong_field(options: Options) -> Iterator[Problem]:
    if options.values.get(VIOLATION_FIELD, VIOLATION_FIELDS[0]) not in VIOLATION_FIELDS:
        yield problem(
            "K003.violation_field",
            options.place(VIOLATION_FIELD),
            key=VIOLATION_FIELD,
            allowed=" or ".join(VIOLATION_FIELDS),
        )


def _is_single(inputs: Sequence[DeclaredInput]) -> bool:
    """Return whether numbers may come as float32, the usual type of messages.

    Rounding both the reference and what comes as float64 does no harm; comparing what was rounded
    with what was not does.
    """
    types = [name for item in inputs for name in item.messages]
    return any(not name.startswith(_DOUBLE) for name in types)


def inputs(model: SafeMLModel) -> Sequence[ModelInput]:
    """Return the one input, which takes every message."""
    connection = model.options
    return _input(model, connection.input_id if connection is not None else DEFAULT_INPUT)


def skeleton(model: SafeMLModel, options: Options) -> Skeleton:
    """Return the one input, by the name that it has already."""
    return Skeleton(_input(model, options.inputs[0].id if options.inputs else DEFAULT_INPUT))


def _input(model: SafeMLModel, name: str) -> Sequence[ModelInput]:
    features = model.data.reference.rows.shape[1]
    return (
        ModelInput(
            name,
            "float[]",
            safety=False,  # the monitor itself empties a window that is too old
            description=f"Samples of {features} numbers, or rows of as many; each counts once",
            every_message=True,
        ),
    )


def claims(_model: SafeMLModel, inputs: Sequence[BoundInput], _frequency: float) -> Sequence[Claim]:
    """Return what "in scope" rests on: the samples."""
    return [Claim("in_scope", frozenset(input_.id for input_ in inputs))]


def input_timeouts(model: SafeMLModel) -> Mapping[str, float]:
    """Return the age after which a sample is an omission."""
    options = _connection(model)
    return {} if options.max_age is None else {options.input_id: options.max_age}


def export(model: SafeMLModel) -> Mapping[str, str]:
    """Return configuration and reference."""
    if isinstance(model.source, PartSource):  # of several, each with a reference of its own
        return settings_text(model.data, f"{model.name}.safeml", f"{model.name}.csv")
    return settings_text(model.data, model.source.stem)


def counts(model: SafeMLModel) -> Mapping[str, int]:
    """Return what ``show`` counts."""
    return show.counts(model.data)


def outline(model: SafeMLModel) -> Sequence[str]:
    """Return the lines that ``show`` prints."""
    return show.outline(model.data, _plan(model))


def diagram(model: SafeMLModel) -> Diagram:
    """Return what a picture of the monitor shows."""
    return show.picture(model.name, model.data, _plan(model))


def readme(model: SafeMLModel) -> Sequence[str]:
    """Return lines of Markdown for the package's README."""
    connection = _connection(model)
    return show.readme(connection.plan, connection.frequency)


def _plan(model: SafeMLModel) -> Plan | None:
    """Return the configured plan, or the one without a configuration; ``None`` on an error."""
    if model.options is not None:
        return _connection(model).plan
    return _planned(model, single=model.data.settings.input_dtype == "float32").plan


def _connection(model: SafeMLModel) -> SafeMLOptions:
    assert model.options is not None, "it was configured"
    return model.options


def _planned(model: SafeMLModel, *, single: bool) -> Planned:
    return plan(model.data.settings, model.data.reference, single=single)


def elements(model: SafeMLModel) -> Sequence[Element]:
    """Return the reference, which is a file of its own."""
    source = model.data.reference.source
    return [Element("reference", source.file_name, sha256=source.sha256)]


FUNCTIONS = Functions(
    in_map=in_map,
    read_eddi=read_eddi,
    read_file=read_file,
    check=check,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    beside=with_status("SafeMLStatus"),
    configure=configure,
    readme=readme,
    diagram=diagram,
    compile=compile_safeml,
    claims=claims,
    input_timeouts=input_timeouts,
    field_meanings=lambda _claims: MEANINGS,
    elements=elements,
    skeleton=skeleton,
)
"""What is done with SafeML monitors."""
