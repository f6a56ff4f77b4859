"""Monitors of a perception scope as models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from eddi_scaffold.common.claims import Claim, Element, Meaning, Meanings, ValidityField
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, has_errors, in_order, problem
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.kinds import Model, ModelDraft, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.safeml import VIOLATION_FIELD, VIOLATION_FIELDS, show
from eddi_scaffold.kinds.safeml.compile import compile_safeml
from eddi_scaffold.kinds.safeml.plan import plan
from eddi_scaffold.kinds.safeml.reference import read_named
from eddi_scaffold.kinds.safeml.scope import NAME, Plan, SafeMLFile, SafeMLOptions
from eddi_scaffold.kinds.safeml.settings import as_eddi_map, read_settings, settings_of_eddi
from eddi_scaffold.kinds.safeml.settings import export as settings_text
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration

DEFAULT_INPUT = "sample"
_PERIODS = 10  # Steps without a sample after which a window is too old, unless `max_age` is given


_IN_SCOPE, _VERDICT = "`field: in_scope` of SafeMLStatus", (("omission", False),)
_OMISSION = Meaning(
    (True,), refused="an omission is also silence", instead=f"NOT of it, or {_IN_SCOPE}"
)
_VIOLATION = Meaning(
    refused="`odd_violation` has no meaning while there is no verdict",
    instead=f"{_IN_SCOPE}, or `NOT omission` with it",
    known=_VERDICT,
)
MEANINGS: dict[str, dict[str, Meaning]] = {
    message: {
        "omission": _OMISSION,
        "odd_violation": replace(
            _VIOLATION, valid_where=(ValidityField(message, "omission", value=False),)
        ),
    }
    for message in ("SafeMLOutput", "SafeMLStatus")
}
MEANINGS["SafeMLStatus"]["in_scope"] = Meaning(
    (False,),
    refused="`in_scope` is false also when there is no verdict",
    instead="`NOT omission AND odd_violation`: known to be a violation",
    known=_VERDICT,
)


@dataclass(frozen=True)
class SafeMLModel(Model):
    """A reference, and how what is seen is compared with it."""

    kind: ClassVar[str] = NAME
    data: SafeMLFile = field(kw_only=True)
    # `None` before it is configured
    options: SafeMLOptions | None = field(default=None, kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        """Read ``safeml_config.yml`` and the reference that it names, relative to it."""
        settings, problems = read_settings(source)
        if settings is None:
            return ReadResult((), tuple(in_order(problems)))
        reference, problems = read_named(source.name, settings)
        if reference is None:
            return ReadResult((), tuple(in_order(problems)))
        file = SafeMLFile(settings, reference)
        return ReadResult((cls(source.stem, source, settings.place(""), data=file),), ())

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        files, problems = settings_of_eddi(document, source)
        models = (cls(of.model or "", part, of.place, data=file) for of, part, file in files)
        return ReadResult(tuple(models), tuple(problems))

    @classmethod
    def meanings(cls, claims: Sequence[Claim] | None) -> Meanings:
        return MEANINGS

    def check(self) -> Sequence[Problem]:
        return self._planned[1]

    def counts(self) -> Mapping[str, int]:
        settings, (rows, features) = self.data.settings, self.data.reference.rows.shape
        sizes = {"rows": rows, "features": features, "window_size": settings.window_size}
        return {**sizes, "components": settings.n_components or 0}

    def outline(self) -> Sequence[str]:
        return show.outline(self.data, self._planned[0])

    def write(self) -> Mapping[str, str]:
        if self.source.part is not None:  # of several, each with a reference of its own
            return settings_text(self.data, f"{self.safe_name}.safeml", f"{self.safe_name}.csv")
        return settings_text(self.data, self.safe_name)

    def as_eddi_map(self) -> tuple[str, Sequence[tuple[str, str]]]:
        return as_eddi_map(self.name, self.data)

    def diagram(self) -> Diagram:
        return show.picture(self.name, self.data, self._planned[0])

    def draft(self, options: Options) -> ModelDraft:
        name = options.inputs[0].id if options.inputs else DEFAULT_INPUT
        return ModelDraft([replace(input_, id=name) for input_ in self.inputs()])

    def configure(self, options: Options) -> tuple[SafeMLModel | None, list[Problem]]:
        """Find thresholds for the type of the messages; the configuration's id is the name."""
        settings, inputs = self.data.settings, options.inputs
        problems = [problem("K013.one_input", item.place, input=item.id) for item in inputs[1:]]
        if options.values.get(VIOLATION_FIELD, VIOLATION_FIELDS[0]) not in VIOLATION_FIELDS:
            place, allowed = options.place(VIOLATION_FIELD), " or ".join(VIOLATION_FIELDS)
            problems.append(
                problem("K003.violation_field", place, key=VIOLATION_FIELD, allowed=allowed)
            )
        # Numbers may come as float32, the usual type of messages. Rounding both the reference and
        # what comes as float64 does no harm; comparing what was rounded with what was not does.
        types = [name for item in inputs[:1] for name in item.messages]
        is_single = any(not name.startswith("std_msgs/Float64") for name in types)
        single = settings.input_dtype == "float32" or (settings.input_dtype == "auto" and is_single)
        planned, faults = plan(settings, self.data.reference, single=single)
        problems += faults
        if planned is None or has_errors(problems):
            return None, problems
        max_age = settings.max_age
        if max_age is None and options.frequency is not None:
            max_age = _PERIODS / options.frequency
        input_id = inputs[0].id if inputs else DEFAULT_INPUT
        connection = SafeMLOptions(planned, input_id, max_age, options.frequency)
        return replace(self, name=options.id or self.name, options=connection), problems

    def inputs(self) -> Sequence[ModelInput]:
        features = self.data.reference.rows.shape[1]
        return (
            ModelInput(
                DEFAULT_INPUT if self.options is None else self.options.input_id,
                "float[]",
                safety=False,  # the monitor itself empties a window that is too old
                description=f"Samples of {features} numbers, or rows of as many; each counts once",
                every_message=True,
            ),
        )

    def companion_messages(self) -> Mapping[str, str]:
        return {"status": "SafeMLStatus"}

    def readme(self) -> Sequence[str]:
        return show.readme(self.configured.plan, self.configured.frequency)

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_safeml(self.data.reference, self.configured, declaration)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        return [Claim("in_scope", frozenset(input_.id for input_ in inputs))]

    def input_timeouts(self) -> Mapping[str, float]:
        options = self.configured
        return {} if options.max_age is None else {options.input_id: options.max_age}

    def elements(self) -> Sequence[Element]:
        source = self.data.reference.source
        return [Element("reference", source.file_name, sha256=source.sha256)]

    @property
    def configured(self) -> SafeMLOptions:
        """The options of a model that was configured."""
        assert self.options is not None, "it was configured"
        return self.options

    @property
    def _planned(self) -> tuple[Plan | None, Sequence[Problem]]:
        """The configured plan, or that without a configuration; ``None`` on an error."""
        if self.options is not None:
            return self.options.plan, ()
        settings = self.data.settings
        return plan(settings, self.data.reference, single=settings.input_dtype == "float32")
