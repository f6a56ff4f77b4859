"""``expression:`` of an EDDI input, or the event of a file: checked against the messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from eddi_scaffold.common import units
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.conditions.analysis import ExpressionText, compile_input
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.scope import BOOL, NUMBER, TEXT, Type, Variable
from eddi_scaffold.conditions.syntax import File, Identifier, is_list_path
from eddi_scaffold.conditions.tokens import Locate, TextFindings, in_text
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import JsonValue, ModelInput
from eddi_scaffold.monitors.input_rules import check
from eddi_scaffold.monitors.message_types.documented import documented_at

EXPRESSION_KEYS = ("expression", "expression_file", "states")
"""Keys of an input, one of which defines how it is computed."""
_TYPES: Mapping[str | None, Type] = {"bool": BOOL, "int": NUMBER, "float": NUMBER, "str": TEXT}
_KEYED = (field_paths.ByKey, field_paths.ByName, field_paths.Every)
_Where = Callable[[], Place]  # the place of a name, which is looked for only if it is reported


@dataclass(frozen=True)
class CheckedExpression:
    """A checked expression."""

    requires: tuple[SimulatorOutput, ...]  # simulator outputs that it reads
    # for `EDDIInputBase` of the runtime: the compiled forms, and what the names are
    document: dict[str, JsonValue]
    text: str  # canonical form, for comments; an event of a file has its name before it
    unit: str | None  # of its value, `None` for none


class ExpressionBinder:
    """Checks the expression of an entry of ``EDDIInputs``; ``types``: input -> its type."""

    def __init__(
        self,
        item: ModelInput,
        index: int,
        config: ConfigFile,
        fields_of: field_paths.FieldsOf,
        types: Mapping[str, str],
    ) -> None:
        entries = config.config.EDDIInputs
        self.item, self.index, self.config, self.entry = item, index, config, entries[index]
        self.fields_of, self.types = fields_of, types
        self.problems: list[Problem] = []
        self.polarity = self.entry.polarity
        # names in expressions: of messages, of inputs above, and of those that are computed later
        self.sources = {attribute(entry.id): entry for entry in config.config.SimulatorOutputs}
        self.inputs = {attribute(entry.id): entry.id for entry in entries[:index]}
        self.below = {attribute(entry.id) for entry in entries[index + 1 :]}
        self.resolved: dict[str, field_paths.ResolvedPath] = {}  # name -> its path
        self.checks: dict[str, list[JsonValue]] = {}  # name -> when it is a measurement

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
        for name in compiled.names:  # some are not in the text: the angles of a scan
            source = self.sources.get(head_of(name))
            if source is None or "." not in name or name in self.resolved:
                continue
            if self._resolve(name, source, partial(texts[0].locate, 0)) is None:
                break
        if has_errors(self.problems):
            return None
        paths: dict[str, JsonValue] = {}
        for name in compiled.names:  # from those with keys the runtime cannot derive the path
            path = self.resolved[name].path if name in self.resolved else ()
            if any(isinstance(step, _KEYED) for step in path):
                paths[name] = [field_paths.plain_step(step) for step in path]
        checks = {name: self.checks[name] for name in compiled.names if name in self.checks}
        names: JsonValue = {  # first part of a name -> message or input, and its id
            name: ["message", self.sources[name].id] if name in self.sources else ["input", name]
            for name in compiled.requires
        }
        document = {**compiled.document, "names": names}
        document |= {k: v for k, v in {"checks": checks, "paths": paths}.items() if v}
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
        return CheckedExpression(requires, document, text, compiled.unit)

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
        findings = TextFindings(in_text(text, self.config.path(name)))
        events = {event.name: event for event in parse(text, findings).events}
        if has_errors(findings.problems):
            self.problems += findings.problems
            return []
        event = self.entry.event or (next(iter(events)) if len(events) == 1 else None)
        if event is None or event not in events:
            hint, key = (
                f"events: {', '.join(events) or 'none'}",
                "event" if event else "expression_file",
            )
            self._report("K020.no_event", key, hint=hint, file=name)
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
        declared = parse(text_of_all)
        known = _constants(declared)
        typed = {variable.name: variable.unit for variable in declared.variables}
        variables: dict[str, Variable] = {}
        for text in texts:
            findings = TextFindings(text.locate)
            file = parse(text.text, findings)
            if has_errors(findings.problems):
                self.problems += findings.problems
                continue
            file = file if text.event is None else file.reduced_to(text.event)
            local = {event.name for event in file.events if not event.anonymous}
            local_typed = typed | {variable.name: variable.unit for variable in file.variables}
            nodes = [node for event in file.events for node in file.nodes_of(event)]
            names = {node.text: node.start for node in reversed(nodes) if node.op == "name"}
            for name, start in names.items():
                where = partial(text.locate, start)
                if name in local_typed:
                    self._check_declared(name, local_typed[name], where)
                elif name not in {*known, *local, *_constants(file), *variables}:
                    variable = self._variable(name, where)
                    if variable is not None:
                        variables[name] = variable
        return variables

    def _check_declared(self, name: str, unit: Identifier | None, where: _Where) -> None:
        """Look up where a name with a VAR comes from; its keys are those of the message."""
        source = self._source(name, where)
        if source is None or head_of(name) == name:
            return
        resolved = self._resolve(name, source, where)
        documented = resolved and documented_at(resolved.path, source.type, self.fields_of)
        if documented and unit is not None and units.contradict(documented.units, unit.name):
            actual = " or ".join(documented.units)
            words = " or ".join(map(units.word, documented.units))
            fields = {"name": name, "actual": actual, "unit": unit.name, "words": words}
            self.problems.append(problem("E009.variable", where(), **fields))

    def _variable(self, name: str, where: _Where) -> Variable | None:
        """Return what a name is by the types of the messages, ``None`` after an error."""
        if name in self.inputs:
            of = self.types.get(self.inputs[name])
            return Variable(name, _TYPES.get(of), declared=of is not None)
        source = self._source(name, where)
        resolved = None if source is None else self._resolve(name, source, where)
        if source is None or resolved is None:
            return None
        ages = [age for age in (self.entry.max_age, source.limit) if age is not None]
        timeout = round(ages[0] * 1e9) if ages and not isinstance(ages[0], str) else None
        of = "float" if resolved.type in ("time", "duration") else resolved.type
        if of is not None and of not in _TYPES:
            self.problems.append(problem("K020.no_number", where(), name=name, type=of))
            return None
        advice = f"declare the fields of {source.type} below MessageTypes"
        is_known = of is not None
        variable = Variable(name, _TYPES.get(of), timeout=timeout, declared=is_known, advice=advice)
        documented = documented_at(resolved.path, source.type, self.fields_of)
        if documented is None or variable.type != NUMBER:
            return variable
        within, checks = None, self.checks.get(name, [])
        if documented.limits is not None:
            low, high = documented.limits
            within = f"{head_of(name)}.{low}", f"{head_of(name)}.{high}"
            if not is_list_path(name):
                checks = [*checks, ["within", _steps(low), _steps(high)]]
        if documented.unless is not None:
            field, value = documented.unless
            checks = [*checks, ["unless", _steps(field), value]]
        self.checks |= {name: checks} if checks else {}
        return replace(
            variable,
            unit=documented.units[0] if len(documented.units) == 1 else None,
            range=documented.range,
            infinite=documented.infinite,
            defined=documented.infinite,
            within=within,
        )

    def _source(self, name: str, where: _Where) -> SimulatorOutput | None:
        """Return the message that a name is a part of; ``None`` for an input, or after an error."""
        head = head_of(name)
        if head in self.sources or name in self.inputs:
            return self.sources.get(head)
        if head == name and head in self.below:
            self.problems.append(problem("E008.below", where(), input=head))
            return None
        names = [*self.sources, *self.inputs]
        hint = did_you_mean(head, names) or f"there are: {', '.join(names) or 'none'}"
        self.problems.append(problem("E008.no_source", where(), hint=hint, source=head))
        return None

    def _resolve(
        self, name: str, source: SimulatorOutput, where: _Where
    ) -> field_paths.ResolvedPath | None:
        """Return the path of a name in its message, ``None`` after an error."""
        try:
            resolved = field_paths.resolve(path_behind(name), source.type, self.fields_of)
        except field_paths.FieldPathError as failure:
            self.problems.append(problem("K020.path", where(), hint=failure.hint, reason=failure))
            return None
        known = check(resolved.path, source.type)
        if known and name not in self.resolved:
            self.checks.setdefault(name, []).append(known)
        self.resolved[name] = resolved
        return resolved

    def _report(self, case: str, key: str, /, *, hint: str | None = None, **fields: object) -> None:
        place = self.config.place("EDDIInputs", self.index, key)
        fault = problem(case, place, hint=hint, **fields)
        self.problems.append(fault.about(f"input {self.entry.id!r}"))


def _constants(file: File) -> set[str]:
    """Return the names of constants, and of the literals of an ENUM."""
    literals = {literal.name for enum in file.enums for literal in enum.literals}
    return literals | {constant.name for constant in file.constants}


def head_of(name: str) -> str:
    """Return the first word of a path: the id of a message or of an input."""
    return name.partition(".")[0].partition("[")[0]


def path_behind(name: str) -> field_paths.FieldPath:
    """Return the path behind the first word of a name; FieldPathError where it is none."""
    rest = name[len(head_of(name)) :].removeprefix(".")
    return field_paths.parse_field(rest, lists=True) if rest else ()


def _steps(field: str) -> list[JsonValue]:
    return [*map(field_paths.plain_step, field_paths.parse_field(field))]
