"""Monitors of a perception scope as models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from eddi_scaffold.common.claims import Claim, Element
from eddi_scaffold.common.escaping import markdown_text
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, has_errors, in_order, problem
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.evidence.emitted import Emitted
from eddi_scaffold.kinds import Model, ModelDraft, ModelInput, Options, ReadResult
from eddi_scaffold.kinds.safeml import VIOLATION_FIELD, VIOLATION_FIELDS
from eddi_scaffold.kinds.safeml.compile import compile_safeml
from eddi_scaffold.kinds.safeml.plan import plan
from eddi_scaffold.kinds.safeml.scope import METRIC_NAMES, Plan, SafeMLFile, SafeMLOptions
from eddi_scaffold.kinds.safeml.settings import as_eddi_map, read_settings, settings_of_eddi
from eddi_scaffold.kinds.safeml.settings import export as settings_text
from eddi_scaffold.kinds.safeml.thresholds import critical_values
from eddi_scaffold.kinds.safeml.vectors import safeml_vectors
from eddi_scaffold.kinds.safeml.verify import verify
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration
from eddi_scaffold.yaml_text.nodes import read_map

DEFAULT_INPUT = "sample"
_PERIODS = 10  # Steps without a sample after which a window is too old, unless `max_age` is given


@dataclass(frozen=True)
class SafeMLModel(Model):
    """A reference, and how what is seen is compared with it."""

    kind: ClassVar[str] = "safeml"
    data: SafeMLFile = field(kw_only=True)
    # `None` before it is configured
    options: SafeMLOptions | None = field(default=None, kw_only=True)

    @classmethod
    def read_file(cls, source: Source, default_guarantees: Sequence[str]) -> ReadResult:
        """Read ``safeml_config.yml`` and the reference that it names, relative to it."""
        root, problems = read_map(source, "L001")
        if root is None:
            return ReadResult((), tuple(problems))
        file, more = read_settings(root, source.name)
        problems += more
        if file is None or problems:
            return ReadResult((), tuple(in_order(problems)))
        return ReadResult((cls(source.stem, source, root.place, data=file),), ())

    @classmethod
    def read_eddi(
        cls, document: EddiDocument, source: Source, default_guarantees: Sequence[str]
    ) -> ReadResult:
        files, problems = settings_of_eddi(document, source)
        models = (cls(of.model or "", part, of.place, data=file) for of, part, file in files)
        return ReadResult(tuple(models), tuple(problems))

    def check(self) -> Sequence[Problem]:
        return self._planned[1]

    def counts(self) -> Mapping[str, int]:
        settings, (rows, features) = self.data.settings, self.data.reference.rows.shape
        sizes = {"rows": rows, "features": features, "window_size": settings.window_size}
        return {**sizes, "components": settings.n_components or 0}

    def outline(self) -> Sequence[str]:
        plan = self._planned[0]
        settings, name = self.data.settings, self.data.reference.source.file_name
        rows, features = self.data.reference.rows.shape
        facts = ["no thresholds: see `check`"] if plan is None else _facts(plan)
        return [
            f"{METRIC_NAMES[settings.metric]} of the last {settings.window_size} samples",
            f"  reference {name}: {rows} rows, {features} features",
            *(f"  {fact}" for fact in facts),
        ]

    def write(self) -> Mapping[str, str]:
        if self.source.part is not None:  # of several, each with a reference of its own
            return settings_text(self.data, f"{self.safe_name}.safeml", f"{self.safe_name}.csv")
        return settings_text(self.data, self.safe_name)

    def as_eddi_map(self) -> tuple[str, Sequence[tuple[str, str]]]:
        return as_eddi_map(self.name, self.data)

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
        plan, frequency = self.configured.plan, self.configured.frequency
        settings, level = plan.settings, plan.settings.significance_level
        alarms = f"of correct steps, at most about {_percent(level)} are false violations"
        if frequency is not None:
            alarms += f": {level * frequency * 3600:,.0f} per hour at {frequency:g} Hz, in episodes"
        metric = METRIC_NAMES[settings.metric]
        lines = [
            f"{metric} of the last {settings.window_size} samples to {plan.n} reference samples:",
            "",
            *(f"- {markdown_text(fact)}" for fact in _facts(plan)),
            f"- {alarms}",
        ]
        held = "the last one" if settings.on_omission == "hold" else "false"
        verdict = (
            f"`omission` means that there is no verdict; then `odd_violation` is {held}. Evidence "
            "is `NOT omission AND NOT odd_violation` (`in_scope` of the status message), never "
            "`NOT odd_violation` alone."
        )
        return [*lines, "", verdict, ""]

    def compile(self, declaration: Declaration) -> CompiledMonitor:
        return compile_safeml(self.data.reference, self.configured, declaration)

    def vectors(self, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
        return safeml_vectors(self.configured, inputs, about)

    def verify(self, emitted: Emitted) -> Iterator[str]:
        plan, metric, critical = self.configured.plan, self.data.settings.metric, None
        if metric != "ks":
            critical = critical_values(metric, plan.n, plan.settings.window_size)
        return verify(self.data.reference, self.configured, critical, emitted)

    def claims(self, inputs: Sequence[BoundInput], frequency: float) -> Sequence[Claim]:
        return [Claim("in_scope", frozenset(input_.id for input_ in inputs))]

    def input_timeouts(self) -> Mapping[str, float]:
        options = self.configured
        if options.max_age is None:
            return {}
        # it counts from the step that took the last sample
        step_s = 0.0 if options.frequency is None else 1 / options.frequency
        return {options.input_id: options.max_age + step_s}

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


def _facts(plan: Plan) -> Sequence[str]:
    tests = f"{plan.tests} tests" if plan.tests > 1 else "one test"
    kinds = "features" if plan.design.table is None else "principal components"
    residual = " and the residual" if plan.design.floor is not None else ""
    how = f" ({plan.method}, for independent samples)"
    if plan.calibration:
        theoretical = f"{plan.scale(plan.theoretical):.4g}, {plan.method}"
        ratio = f"{plan.threshold / plan.theoretical:.2f} times"
        windows = plan.calibration.windows
        how = f", calibrated with {windows} windows (theoretical: {theoretical}; {ratio})"
    value, test = plan.autocorrelation
    together = _percent(plan.settings.significance_level)
    return (
        f"{tests} ({kinds}{residual}) at {plan.level:.3g} each: {together} together",
        f"threshold {plan.scale(plan.threshold):.4g}{how}",
        f"largest autocorrelation of neighbouring samples: {value:.2f} ({plan.labels[test]})",
    )


def _percent(level: float) -> str:
    return f"{100 * level:.3g} %"
