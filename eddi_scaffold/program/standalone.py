"""Monitors without a runtime: a program with names for everything, as both languages print it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.common.identifiers import RESERVED, free_name
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.program.instructions import HostInput, Program, Sampling

Target = Literal["python", "c"]

_C_WORDS = """auto break case char const continue default do double else enum extern float for goto
if inline int long main register restrict return short signed sizeof static struct switch typedef
union unsigned void volatile while bool true false"""
_C_TYPES = "clock fpos intmax intptr off ptrdiff size ssize time uintmax uintptr wchar wint"
"""Names that are a type of the C library with ``_t`` behind them, as a monitor's struct has."""
_TAKEN = {*_C_WORDS.split(), *_C_TYPES.split(), *(name.lower() for name in RESERVED)}
_C_INTEGER = re.compile(r"u?int(_least|_fast)?[0-9]+")


@dataclass(frozen=True)
class HostArgument:
    """One value that the host gives."""

    input: HostInput  # its name and type
    name: str  # an identifier
    description: str  # one line on it
    stamped: bool  # the time of its sample is asked for


@dataclass(frozen=True)
class StandaloneMonitor:
    """One monitor to print."""

    name: str  # what files and functions begin with
    kind: str  # of its model, `event` or `consert`
    program: Program  # what it does
    source: tuple[str, ...]  # lines of the text, for comments
    units: Mapping[str, str] = field(default_factory=dict)  # value of the host -> its unit
    enums: tuple[str, ...] = ()  # name of the ENUM of each variable, empty for none

    @cached_property
    def variables(self) -> list[str]:
        """An identifier for each variable."""
        return unique_names(read.name for read in self.program.reads)

    @cached_property
    def events(self) -> list[str]:
        """An identifier for each result."""
        return unique_names(result.id for result in self.program.results)

    @property
    def numeric(self) -> bool:
        """Whether the only result is a number."""
        types = [self.program.operations[result.operation].type for result in self.program.results]
        return types == ["number"]

    @cached_property
    def sampling(self) -> Sampling:
        """From what the host gives to the variables."""
        return Sampling(self.program)

    @property
    def has_lists(self) -> bool:
        """Whether a variable is made of lists."""
        return any(variable.reduction is not None for variable in self.program.reads)

    @cached_property
    def arguments(self) -> list[HostArgument]:
        """What the host gives: variables as they are, and the parts of reductions."""
        return [*self._arguments()]

    def describe(self, number: int) -> str:
        """Return one line on a variable: type, unit, range, timeout."""
        variable = self.program.reads[number]
        parts = [variable.name, self.enums[number] or variable.type]
        if self.units.get(variable.name):
            parts.append(f"in {self.units[variable.name]}")
        if variable.range is not None:
            parts.append(f"from {variable.range[0]!r} to {variable.range[1]!r}")
        if variable.infinite:
            parts.append("may be infinite")
        if variable.about:
            parts.append(variable.about)
        if variable.timeout is not None:
            parts.append(f"UNKNOWN after {variable.timeout / 1e9:g} s without a new sample")
        return c_comment(", ".join(parts))

    def _arguments(self) -> Iterator[HostArgument]:
        reads = self.program.reads
        numbers = {read.name: k for k, read in enumerate(reads) if read.reduction is None}
        taken = [*self.variables]
        for number, input_ in enumerate(self.sampling.inputs):
            uses = zip(reads, self.sampling.uses, strict=True)
            stamped = any(read.stamped and number in used for read, used in uses)
            if input_.name in numbers:
                k = numbers[input_.name]
                yield HostArgument(input_, self.variables[k], self.describe(k), stamped)
                continue
            taken.append(unique_names([*taken, input_.name])[-1])
            unit = f", in {self.units[input_.name]}" if self.units.get(input_.name) else ""
            shown = f"{input_.name}, {'list of ' if input_.list else ''}{input_.type}{unit}"
            yield HostArgument(input_, taken[-1], c_comment(shown), stamped)


def named(
    program: Program,
    name: str,
    source: Sequence[str],
    *,
    kind: str = "event",
    units: Mapping[str, str] | None = None,
    enums: Mapping[str, str] | None = None,
) -> StandaloneMonitor:
    """Return what is printed of a program."""
    names_of_enums = tuple((enums or {}).get(read.name, "") for read in program.reads)
    lines = tuple(map(c_comment, source))
    return StandaloneMonitor(module_name(name), kind, program, lines, units or {}, names_of_enums)


def unique_names(names: Iterable[str]) -> list[str]:
    """Return an identifier for each name, in order; ``a.b`` and ``a_b`` get different ones."""
    identifiers: dict[str, None] = {}
    for name in names:
        base = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        base = base if base and not base[0].isdigit() else f"v_{base}"
        identifiers[free_name(base, identifiers)] = None
    return [*identifiers]


def module_name(name: str) -> str:
    """Return a name in lower case that files and functions of both targets can begin with."""
    plain = _plain_name(name)
    return f"{plain}_monitor" if plain in _TAKEN or _C_INTEGER.fullmatch(plain) else plain


def check_module_name(name: str) -> None:
    """Refuse a name that files and functions cannot begin with as it is.

    Raises:
        EddiError: with one that they can begin with (G002).
    """
    usable = module_name(name)
    if usable == name:
        return
    reason = "lower-case ASCII letters, digits and single underscores are expected"
    if name == _plain_name(name):
        reason = "it means something else in C or Python"
    raise EddiError(problem("G002.unusable_name", name=name, reason=reason, usable=usable))


def _plain_name(name: str) -> str:
    decomposed = unicodedata.normalize("NFKD", name.casefold())
    base = "".join(char for char in decomposed if not unicodedata.combining(char))
    plain = re.sub(r"[^a-z0-9]+", "_", base).strip("_")
    return f"event_{plain}".rstrip("_") if not plain or plain[0].isdigit() else plain
