"""Monitors without a runtime: a program with names for everything, as both languages print it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.common.files import inputs_noted, read_source
from eddi_scaffold.common.identifiers import RESERVED, free_name
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.program.instructions import HostInput, Program, Sampling
from eddi_scaffold.regions.marked_file import MarkedFile, parse
from eddi_scaffold.regions.markers import Style, begin_marker, end_marker

Target = Literal["python", "c"]

_C_WORDS = """auto break case char const continue default do double else enum extern float for goto
if inline int long main register restrict return short signed sizeof static struct switch typedef
union unsigned void volatile while bool true false"""
_C_TYPES = "clock fpos intmax intptr off ptrdiff size ssize time uintmax uintptr wchar wint"
"""Names that are a type of the C library with ``_t`` behind them, as a monitor's struct has; with
``ring`` the functions would have the names of those for windows."""
_TAKEN = {"ring", *_C_WORDS.split(), *_C_TYPES.split(), *(name.lower() for name in RESERVED)}
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
    def literals(self) -> dict[str, list[str]]:
        """Name of an ENUM -> an identifier for each of its literals."""
        pairs = sorted(zip(self.enums, self.program.reads, strict=True))
        return {enum: unique_names(read.literals) for enum, read in pairs if enum}

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
    decomposed = unicodedata.normalize("NFKD", name.casefold())
    base = "".join(char for char in decomposed if not unicodedata.combining(char))
    plain = re.sub(r"[^a-z0-9]+", "_", base).strip("_")
    if not plain or plain[0].isdigit():
        plain = f"event_{plain}".rstrip("_")
    return f"{plain}_monitor" if plain in _TAKEN or _C_INTEGER.fullmatch(plain) else plain


def check_module_name(name: str) -> None:
    """Refuse a name that files and functions cannot begin with as it is (EddiError, G002)."""
    usable = module_name(name)
    if usable != name:
        raise EddiError(problem("G002.unusable_name", name=name, usable=usable))


HEADER = "generated by eddi-scaffold event"
"""Stands in the first lines of every file that may be overwritten."""
_C_MARKER = re.compile(r"(?m)^(\s*)// (?=-{3,}\s*Manual edit (?:begin|end))")
_HASH_MARKER = re.compile(r"(?m)^(\s*)#  (?=-{3,}\s*Manual edit (?:begin|end))")
_DEFAULT = re.compile(
    r"raise NotImplementedError\([^\n]*\)|pass|\(void\)t_ns;"
    r"|(?:\(void\)stamp;[^\n]*\n\s*)?return (?:NAN|EVENT_UNKNOWN|-1|NULL);"
)
"""Default bodies: a region that is removed with one of them is not a loss."""


def region(region_id: str, body: list[str], *, c: bool = False, indent: str = "") -> list[str]:
    """Return the lines of an editable region with its default body, which is indented already."""
    style: Style = "hash" if c else "python"
    begin, end = begin_marker(region_id, style), end_marker(region_id, style)
    if c:
        begin, end = (f"//{line[1:]}" for line in (begin, end))
    return [f"{indent}{begin}", *body, f"{indent}{end}"]


def keep_in_folder(files: Mapping[str, str], folder: Path) -> tuple[dict[str, str], list[str]]:
    """Return the files with the hand-written bodies of those that lie in a folder.

    Bodies without a region in the new files go to files of their own, whose names are returned too.

    Raises:
        EddiError: a file there is not ours, is not text, or its markers are broken (E020).
    """
    kept: dict[str, str] = {}
    lost: list[str] = []
    for name, text in files.items():
        path = folder / name
        if not path.is_file():
            kept[name] = text
            continue
        kept[name], bodies = _with_bodies_of(_text(path), text, str(path))
        if bodies:
            lost.append(f"{name}.kept.txt")
            before = folder / lost[-1]
            earlier = _text(before) if before.is_file() else ""
            rows = (f"region {region_id}\n{body}\n" for region_id, body in sorted(bodies.items()))
            kept[lost[-1]] = earlier + "".join(rows)
    return kept, lost


def _with_bodies_of(old: str, new: str, name: str) -> tuple[str, dict[str, str]]:
    """Return a new text with the bodies of the old one, and those for which it has no region."""
    if HEADER not in "\n".join(old.split("\n")[:5]):
        raise EddiError(problem("E020.exists", Place(name)))
    before, after = _parsed(old, name), _parsed(new, name)
    text = ""
    for part in after.parts:
        if isinstance(part, str):
            text += part
        else:
            body = before.regions.get(part.id, part).body
            text += f"{part.begin}\n{body}{part.end}\n"
    bodies = {
        region_id: part.body
        for region_id, part in before.regions.items()
        if region_id not in after.regions and not _DEFAULT.fullmatch(part.body.strip())
    }
    return _HASH_MARKER.sub(r"\1// ", text), bodies


def _parsed(text: str, name: str) -> MarkedFile:
    document, faults = parse(_C_MARKER.sub(r"\1#  ", text))
    places = [(Place(name, fault.line), fault.reason) for fault in faults]
    if faults:
        raise EddiError(*(problem("E020.markers", place, reason=why) for place, why in places))
    return document


def _text(path: Path) -> str:
    with inputs_noted():  # an output of the run before, and of this one
        return read_source(path).text("E020")
