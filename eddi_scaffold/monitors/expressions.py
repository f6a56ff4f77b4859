"""``expression:`` of an EDDI input, or the event of a file: checked against the messages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.conditions.analysis import ExpressionText, compile_input
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.syntax import File
from eddi_scaffold.conditions.tokens import Locate, TextFindings, in_text
from eddi_scaffold.config.field_paths import FieldsOf
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.kinds import JsonValue, ModelInput
from eddi_scaffold.monitors.expression_names import ExpressionNames, KeyPaths

EXPRESSION_KEYS = ("expression", "expression_file", "states")
"""Keys of an input, one of which defines how it is computed."""


@dataclass(frozen=True)
class CheckedExpression:
    """A checked expression."""

    requires: tuple[SimulatorOutput, ...]  # simulator outputs that it reads
    # for `EDDIInputBase` of the runtime: the compiled forms, and what the names are
    document: dict[str, JsonValue]
    text: str  # canonical form, for comments; an event of a file has its name before it
    unit: str | None  # of its value, `None` for none
    key_paths: KeyPaths  # simulator output -> name with keys in brackets -> its path


class ExpressionBinder:
    """Checks the expression of one entry of ``EDDIInputs``.

    Args:
        item: the input in the model.
        index: of the entry.
        config: with the entry, and the messages that it may name.
        fields_of: message type -> fields.
        types: input of the model -> its type.

    Attributes:
        problems: those of the language (E, W), K003, K016, K020, K033.
    """

    def __init__(
        self,
        item: ModelInput,
        index: int,
        config: ConfigFile,
        fields_of: FieldsOf,
        types: Mapping[str, str],
    ) -> None:
        self.item, self.index, self.config = item, index, config
        self.entry: InputEntry = config.config.EDDIInputs[index]
        self.problems: list[Problem] = []
        self.sources = {attribute(entry.id): entry for entry in config.config.SimulatorOutputs}
        before = config.config.EDDIInputs[:index]
        self.inputs = {attribute(entry.id): entry for entry in before}
        self.polarity = self.entry.polarity
        below = {attribute(entry.id) for entry in config.config.EDDIInputs[index + 1 :]}
        self.names = ExpressionNames(
            self.entry, self.sources, self.inputs, types, fields_of, below, self.problems
        )

    def bind(self) -> CheckedExpression | None:
        """Return the checked expression, ``None`` after an error."""
        if self.item.type not in ("bool", "float", "int", "state"):
            self._report("K016.result_type", "expression", type=self.item.type)
            return None
        texts = self._texts()
        variables = self._variables(texts)
        if not texts or has_errors(self.problems):
            return None
        compiled, problems = compile_input(
            texts,
            self.item.type,
            rate=self.config.config.Model.frequency,
            variables=variables,
            declarations="\n".join(self.config.config.declarations),
            polarity=self.polarity,
        )
        if "polarity" in self.entry.model_fields_set:
            problems = [problem for problem in problems if problem.case != "W002.polarity"]
        self.problems += problems
        if compiled is None:
            return None
        self.names.check_unnamed(compiled.names, texts[0].locate)
        if has_errors(self.problems):
            return None
        names: dict[str, JsonValue] = {  # first part of a name -> message or input, and its id
            name: ["message", self.sources[name].id] if name in self.sources else ["input", name]
            for name in compiled.requires
        }
        document = {**compiled.document, "names": names}
        checks: dict[str, JsonValue] = {
            name: self.names.checks[name] for name in compiled.names if name in self.names.checks
        }
        if checks:
            document["checks"] = checks
        key_paths = self.names.key_paths(compiled.names)
        if key_paths:
            document["paths"] = {
                name: list(path) for paths in key_paths.values() for name, path in paths.items()
            }
        text = "; ".join(compiled.canonical)
        if self.entry.expression_file is not None:
            text = f"{texts[0].event} of {self.entry.expression_file}: {text}"
        used = [self.sources[name] for name in compiled.requires if name in self.sources]
        for source in used:
            if self.entry.requires and source.id not in self.entry.requires:
                self._report("K003.unknown_name", "requires", name=source.id)
        sources = {entry.id: entry for entry in self.config.config.SimulatorOutputs}
        listed = [sources[name] for name in self.entry.requires if name in sources]
        requires = tuple(dict.fromkeys([*listed, *used]))
        return CheckedExpression(requires, document, text, compiled.unit, key_paths)

    def _texts(self) -> list[ExpressionText]:
        entry = self.entry
        keys = [key for key in EXPRESSION_KEYS if getattr(entry, key) is not None]
        if len(keys) != 1 or (entry.states is not None and self.item.type != "state"):
            self._report("K003.no_expression", keys[-1])
            return []
        if entry.states is not None:
            return [
                ExpressionText(text, self._locate("states", state), state)
                for state, text in entry.states.items()
            ]
        if self.item.type == "state":
            self._report("K003.states", keys[0], key=keys[0])
            return []
        if entry.expression is not None:
            return [ExpressionText(entry.expression, self._locate("expression"))]
        assert entry.expression_file is not None
        return self._in_file(entry.expression_file)

    def _in_file(self, name: str) -> list[ExpressionText]:
        """Return the text of a file of events, and which event of it is meant."""
        text = self.config.event_files.get(name)
        if text is None:
            self._report("K033.no_text", "expression_file", name=name)
            return []
        findings = TextFindings(text, in_text(text, self.config.path(name)))
        events = {event.name: event for event in parse(text, findings).events}
        if has_errors(findings.problems):
            self.problems += findings.problems
            return []
        only = next(iter(events)) if len(events) == 1 else None
        event = self.entry.event or only
        if event is None or event not in events:
            there = ", ".join(events) or "none"
            hint = did_you_mean(event or "", events) or f"events: {there}"
            if event is None:
                self._report("K020.no_event", "expression_file", hint=hint, file=name)
            else:
                self._report("K020.unknown_event", "event", hint=hint, file=name, event=event)
            return []
        polarity, own = events[event].polarity, self.entry.polarity
        if polarity is not None:
            if "polarity" in self.entry.model_fields_set and own != polarity:
                self._report("K003.polarity", "polarity", name=name, polarity=polarity, actual=own)
            self.polarity = "HAZARD" if polarity == "HAZARD" else "EVIDENCE"
        return [ExpressionText(text, in_text(text, self.config.path(name)), event=event)]

    def _locate(self, *path: str) -> Locate:
        return self.config.inside("EDDIInputs", self.index, *path)

    def _variables(self, texts: Sequence[ExpressionText]) -> dict[str, Variable]:
        """Return what each name of the expressions is, by the types of the messages."""
        text_of_all = "\n".join(self.config.config.declarations)
        declared = parse(text_of_all, TextFindings("", lambda _: Place()))
        known = _constants(declared)
        typed = {variable.name: variable.unit for variable in declared.variables}
        variables: dict[str, Variable] = {}
        for text in texts:
            findings = TextFindings(text.text, text.locate)
            file = parse(text.text, findings)
            if has_errors(findings.problems):
                self.problems += findings.problems
                continue
            file = file if text.event is None else file.reduced_to(text.event)
            local = {event.name for event in file.events if not event.anonymous}
            local_typed = typed | {variable.name: variable.unit for variable in file.variables}
            nodes = [node for event in file.events for node in file.nodes_of(event)]
            names = {node.text: node.start for node in reversed(nodes) if node.op == "name"}
            for name, at in names.items():
                if name in local_typed:
                    self.names.declared(name, local_typed[name], text.locate, at)
                elif name not in {*known, *local, *_constants(file), *variables}:
                    variable = self.names.variable(name, text.locate, at)
                    if variable is not None:
                        variables[name] = variable
        return variables

    def _report(self, case: str, key: str, /, *, hint: str | None = None, **fields: object) -> None:
        place = self.config.place("EDDIInputs", self.index, key)
        fault = problem(case, place, hint=hint, **fields)
        self.problems.append(fault.about(f"input {self.entry.id!r}"))


def _constants(file: File) -> set[str]:
    """Return the names of constants, and of the literals of an ENUM."""
    literals = {literal.name for enum in file.enums for literal in enum.literals}
    return literals | {constant.name for constant in file.constants}
