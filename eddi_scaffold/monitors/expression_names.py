"""Names of an expression in a configuration: fields of messages, and other inputs."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common import units
from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.conditions.scope import BOOL, NUMBER, TEXT, Type, Variable
from eddi_scaffold.conditions.syntax import Identifier, is_list_path
from eddi_scaffold.conditions.tokens import Locate
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.input_rules import check
from eddi_scaffold.monitors.message_types.documented import documented_at

_TYPES: Mapping[str, Type] = {"bool": BOOL, "int": NUMBER, "float": NUMBER, "str": TEXT}
KeyPaths = Mapping[str, Mapping[str, Sequence[field_paths.PlainStep]]]
"""Simulator output -> name with keys in brackets -> its path."""


class ExpressionNames:
    """What the names of one input's expressions are.

    Args:
        entry: the input.
        sources: name -> message.
        inputs: name -> other input.
        types: input of the model -> its type.
        fields_of: message type -> fields.
        below: names of the inputs that are computed later.
        problems: takes up what is wrong with them (E008, E009, K020).

    Attributes:
        checks: name -> when it is a measurement, for the runtime.
    """

    def __init__(
        self,
        entry: InputEntry,
        sources: Mapping[str, SimulatorOutput],
        inputs: Mapping[str, InputEntry],
        types: Mapping[str, str],
        fields_of: field_paths.FieldsOf,
        below: Container[str],
        problems: list[Problem],
    ) -> None:
        self._below, self._problems = below, problems
        self.checks: dict[str, list[JsonValue]] = {}
        self._entry, self._sources, self._inputs = entry, sources, inputs
        self._types, self._fields_of = types, fields_of
        self._resolved: dict[str, field_paths.ResolvedPath] = {}

    def declared(self, name: str, unit: Identifier | None, locate: Locate, at: int) -> None:
        """Look up where a name with a VAR comes from; its keys are those of the message."""
        source = self._source(name, locate, at)
        if source is None or head_of(name) == name:
            return
        resolved = self._resolve(name, source, locate, at)
        documented = resolved and documented_at(resolved.path, source.type, self._fields_of)
        if documented and unit is not None and units.contradict(documented.units, unit.name):
            actual = " or ".join(documented.units)
            words = " or ".join(map(units.word, documented.units))
            fields = {"name": name, "actual": actual, "unit": unit.name, "words": words}
            self._problems.append(problem("E009.variable", locate(at), **fields))

    def variable(self, name: str, locate: Locate, at: int) -> Variable | None:
        """Return what a name is by the types of the messages, ``None`` after an error."""
        head = head_of(name)
        if head in self._inputs and head == name:
            of = self._types.get(self._inputs[head].id)
            return Variable(name, _TYPES.get(of or "", None), declared=of is not None)
        source = self._source(name, locate, at)
        resolved = None if source is None else self._resolve(name, source, locate, at)
        if source is None or resolved is None:
            return None
        ages = [age for age in (self._entry.max_age, source.limit) if age is not None]
        timeout = round(ages[0] * 1e9) if ages and not isinstance(ages[0], str) else None
        of = "float" if resolved.type in ("time", "duration") else resolved.type
        if of is not None and of not in _TYPES:
            hint = f"its elements: MIN({name}[*])"
            if not of.endswith("]"):  # a message
                known_fields = ", ".join(f"{name}.{field}" for field in self._fields_of(of) or ())
                hint = f"there are: {known_fields}" if known_fields else ""
            place = locate(at)
            self._problems.append(
                problem("K020.no_number", place, hint=hint or None, name=name, type=of)
            )
            return None
        advice = f"declare the fields of {source.type} below MessageTypes"
        type_, known = _TYPES.get(of or ""), of is not None
        variable = Variable(name, type_, timeout=timeout, declared=known, advice=advice)
        documented = documented_at(resolved.path, source.type, self._fields_of)
        if documented is None or variable.type != NUMBER:
            return variable
        within, checks = None, list[list[JsonValue]]()
        if documented.limits is not None:
            within = f"{head}.{documented.limits[0]}", f"{head}.{documented.limits[1]}"
            if not is_list_path(name):
                checks.append(["within", *map(_steps, documented.limits)])
        if documented.unless is not None:
            field, value = documented.unless
            checks.append(["unless", _steps(field), value])
        if checks:
            self.checks.setdefault(name, []).extend(checks)
        return replace(
            variable,
            unit=documented.units[0] if len(documented.units) == 1 else None,
            range=documented.range,
            infinite=documented.infinite,
            defined=documented.infinite,
            within=within,
        )

    def check_unnamed(self, names: Sequence[str], locate: Locate) -> None:
        """Check what is read without a name in the text: the angles of a scan."""
        for name in names:
            source = self._sources.get(head_of(name))
            if source is None or name in self._resolved or "." not in name:
                continue
            if self._resolve(name, source, locate, 0) is None:
                return

    def key_paths(self, names: Sequence[str]) -> KeyPaths:
        """Return the paths that the runtime cannot derive from the names: those with keys."""
        paths: dict[str, dict[str, list[field_paths.PlainStep]]] = {}
        for name in names:
            path = self._resolved[name].path if name in self._resolved else ()
            if any(
                isinstance(step, field_paths.ByKey | field_paths.ByName | field_paths.Every)
                for step in path
            ):
                of = self._sources[head_of(name)].id
                paths.setdefault(of, {})[name] = [field_paths.plain_step(step) for step in path]
        return paths

    def _source(self, name: str, locate: Locate, at: int) -> SimulatorOutput | None:
        """Return the message that a name is a part of; ``None`` for an input, or after an error."""
        head = head_of(name)
        if head not in self._sources and not (head in self._inputs and head == name):
            names = [*self._sources, *self._inputs]
            fields = [
                f"{source_name}.{name}"
                for source_name, source in self._sources.items()
                if head in (self._fields_of(source.type) or {})
            ]
            hint = f"did you mean {fields[0]!r}?" if fields else did_you_mean(head, names)
            hint = hint or f"there are: {', '.join(names) or 'none'}"
            if head == name and head in self._below:
                self._problems.append(problem("E008.below", locate(at), input=head))
            else:
                self._problems.append(problem("E008.no_source", locate(at), hint=hint, source=head))
        return self._sources.get(head)

    def _resolve(
        self, name: str, source: SimulatorOutput, locate: Locate, at: int
    ) -> field_paths.ResolvedPath | None:
        """Return the path of a name in its message, ``None`` after an error."""
        try:
            resolved = field_paths.resolve(path_behind(name), source.type, self._fields_of)
        except field_paths.FieldPathError as failure:
            place, hint = locate(at), failure.hint
            self._problems.append(problem("K020.path", place, hint=hint, reason=failure))
            return None
        known = check(resolved.path, source.type)
        if known and name not in self._resolved:
            self.checks.setdefault(name, []).append(known)
        self._resolved[name] = resolved
        return resolved


def head_of(name: str) -> str:
    """Return the first word of a path: the id of a message or of an input."""
    return name.partition(".")[0].partition("[")[0]


def path_behind(name: str) -> field_paths.FieldPath:
    """Return the path behind the first word of a name.

    Raises:
        FieldPathError: it is not a path.
    """
    rest = name[len(head_of(name)) :].removeprefix(".")
    return field_paths.parse_field(rest, lists=True) if rest else ()


def _steps(field: str) -> list[JsonValue]:
    return [*map(field_paths.plain_step, field_paths.parse_field(field))]
