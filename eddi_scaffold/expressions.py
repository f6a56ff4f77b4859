"""``expression:`` of an EDDI input: checked against the messages, with places inside the YAML."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold import fields
from eddi_scaffold.config import ConfigFile, Input, SimulatorOutput
from eddi_scaffold.events.diagnostics import Findings, Locate
from eddi_scaffold.events.inputs import CompiledExpression, ExpressionText, compile_input
from eddi_scaffold.events.parser import parse
from eddi_scaffold.events.scope import BOOL, NUMBER, Type, Variable
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.kinds import JsonValue, ModelInput
from eddi_scaffold.message_types import Fields
from eddi_scaffold.problems import Place, Problem, did_you_mean, error, has_errors

_TYPES: Mapping[str, Type | None] = {"bool": BOOL, "int": NUMBER, "float": NUMBER, "str": None}
FieldsOf = Callable[[str], Fields | None]


@dataclass(frozen=True)
class InputExpression:
    """A checked expression.

    Attributes:
        requires: simulator outputs that it reads.
        document: for ``EDDIInputBase`` of the runtime: the compiled forms, and what the names are.
        text: canonical form, for comments.
    """

    requires: tuple[SimulatorOutput, ...]
    document: dict[str, JsonValue]
    text: str


def bind_expression(
    item: ModelInput,
    index: int,
    config: ConfigFile,
    fields_of: FieldsOf,
    types: Mapping[str, str],
) -> tuple[InputExpression | None, list[Problem]]:
    """Check the expression of one entry of ``EDDIInputs`` (E and W codes, K020, K042 to K044).

    Args:
        item: the input in the model.
        index: of the entry.
        config: with the entry, and the messages that it may name.
        fields_of: message type -> fields.
        types: input of the model -> its type.
    """
    return _Binder(item, index, config, fields_of, types).bind()


class _Binder:
    def __init__(
        self,
        item: ModelInput,
        index: int,
        config: ConfigFile,
        fields_of: FieldsOf,
        types: Mapping[str, str],
    ) -> None:
        self.item, self.index, self.config, self.fields_of = item, index, config, fields_of
        self.types = types
        self.entry: Input = config.config.EDDIInputs[index]
        self.problems: list[Problem] = []
        self.sources = {attribute(one.id): one for one in config.config.SimulatorOutputs}
        before = config.config.EDDIInputs[:index]
        self.inputs = {attribute(one.id): one for one in before}

    def bind(self) -> tuple[InputExpression | None, list[Problem]]:
        if self.item.type not in ("bool", "float", "int", "state"):
            self._error("K044", f"an expression cannot give a {self.item.type}", "expression")
            return None, self.problems
        texts = self._texts()
        if not texts:
            return None, self.problems
        variables = self._variables(texts)
        if has_errors(self.problems):
            return None, self.problems
        compiled, problems = compile_input(
            texts,
            self.item.type,
            rate=self.config.config.Model.frequency,
            variables=variables,
            declarations="\n".join(self.config.config.declarations),
            polarity=self.entry.polarity,
        )
        self.problems += problems
        if compiled is None:
            return None, self.problems
        requires = self._requires(compiled)
        document = {**compiled.document, "names": self._names(compiled)}
        return InputExpression(requires, document, "; ".join(compiled.canonical)), self.problems

    def _texts(self) -> list[ExpressionText]:
        entry = self.entry
        if (entry.expression is None) == (entry.states is None) or (
            entry.states is not None and self.item.type != "state"
        ):
            message = "give `expression:`, or for a state `states:` with one expression for each"
            self._error("K043", message, "expression")
            return []
        if entry.expression is not None:
            if self.item.type == "state":
                self._error("K043", "a state needs `states:`, not `expression:`", "expression")
                return []
            return [ExpressionText(entry.expression, self._locate("expression"))]
        return [
            ExpressionText(text, self._locate("states", state), state)
            for state, text in (entry.states or {}).items()
        ]

    def _locate(self, *path: str) -> Locate:
        return self.config.inside("EDDIInputs", self.index, *path)

    def _variables(self, texts: Sequence[ExpressionText]) -> dict[str, Variable]:
        """Return what each name of the expressions is, by the types of the messages."""
        declared = parse(
            "\n".join(self.config.config.declarations), Findings("", lambda _: Place())
        )
        known = {one.name for one in (*declared.variables, *declared.constants)}
        known |= {literal.name for one in declared.enums for literal in one.literals}
        found: dict[str, Variable] = {}
        for one in texts:
            findings = Findings(one.text, one.locate)
            file = parse(one.text, findings)
            if has_errors(findings.problems):
                self.problems += findings.problems
                continue
            local = {event.name for event in file.events if not event.anonymous}
            local |= {v.name for v in (*file.variables, *file.constants)}
            for node in file.nodes:
                if node.op == "name" and node.text not in {*known, *local, *found}:
                    variable = self._variable(node.text, one.locate, node.start)
                    if variable is not None:
                        found[node.text] = variable
        return found

    def _variable(self, name: str, locate: Locate, at: int) -> Variable | None:
        head = name.partition(".")[0].partition("[")[0]
        if head in self.inputs and head == name:
            of = self.types.get(self.inputs[head].id)
            return Variable(name, _TYPES.get(of or "", None), declared=of is not None)
        source = self.sources.get(head)
        if source is None:
            names = [*self.sources, *self.inputs]
            hint = did_you_mean(head, names) or f"there are: {', '.join(names) or 'none'}"
            message = f"there is no simulator output {head!r}"
            self.problems.append(error("E008", message, locate(at), hint))
            return None
        timeout = _nanoseconds(self.entry.max_age, source.max_age)
        try:
            of = fields.type_at(
                fields.parse_field(name[len(head) :].removeprefix(".")), source.type, self.fields_of
            )
        except ValueError as problem:
            text, _, hint = str(problem).partition("; ")
            self.problems.append(error("K020", text, locate(at), hint or None))
            return None
        if of in ("time", "duration"):
            of = "float"
        if of is not None and of not in _TYPES:
            message = f"{name} is a {of}; an expression needs a number or a boolean"
            self.problems.append(error("K020", message, locate(at)))
            return None
        return Variable(name, _TYPES.get(of or ""), timeout=timeout, declared=of is not None)

    def _requires(self, compiled: CompiledExpression) -> tuple[SimulatorOutput, ...]:
        used = [self.sources[name] for name in compiled.requires if name in self.sources]
        given = {one.id: one for one in self.config.config.SimulatorOutputs}
        for one in used:
            if self.entry.requires and one.id not in self.entry.requires:
                message = f"the expression uses {one.id!r}, which `requires` does not name"
                self._error("K042", message, "requires", "add it, or leave `requires` out")
        listed = [given[name] for name in self.entry.requires if name in given]
        return tuple(dict.fromkeys([*listed, *used]))

    def _names(self, compiled: CompiledExpression) -> dict[str, list[str]]:
        """Return first word of a name -> whether it is a message or an input, and its id."""
        return {
            name: ["message", self.sources[name].id] if name in self.sources else ["input", name]
            for name in compiled.requires
        }

    def _error(self, code: str, message: str, key: str, hint: str | None = None) -> None:
        place = self.config.place("EDDIInputs", self.index, key)
        self.problems.append(error(code, f"input {self.entry.id!r}: {message}", place, hint))


def _nanoseconds(*ages: float | str | None) -> int | None:
    for age in ages:
        if isinstance(age, float | int):
            return round(age * 1e9)
        if age is not None:
            return None
    return None
