"""Names of a model as identifiers of a target: all are different, whatever the model contains."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.common.identifiers import RESERVED
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.program.instructions import HostInput, Program, Sampling

_C_WORDS = frozenset(
    re.findall(
        r"\w+",
        """auto break case char const continue default do double else enum extern float for goto if
        inline int long main register restrict return short signed sizeof static struct switch
        typedef union unsigned void volatile while bool true false""",
    )
)
_C_TYPES = frozenset(
    re.findall(
        r"\w+",
        """clock fpos intmax intptr off ptrdiff size ssize time uintmax uintptr wchar wint""",
    )
)
"""Names that are a type of the C library with ``_t`` behind them, as a monitor's struct has."""
_TAKEN = _C_WORDS | _C_TYPES | {word.lower() for word in RESERVED}
_C_INTEGER = re.compile(r"u?int(_least|_fast)?[0-9]+")


def unique_names(names: Iterable[str]) -> list[str]:
    """Return an identifier for each name, in order; ``a.b`` and ``a_b`` get different ones."""
    taken: set[str] = set()
    found = []
    for name in names:
        base = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
        if not base or base[0].isdigit():
            base = f"v_{base}"
        word, number = base, 2
        while word in taken:
            word, number = f"{base}_{number}", number + 1
        taken.add(word)
        found.append(word)
    return found


def module_name(name: str) -> str:
    """Return a name in lower case that files and functions of both targets can begin with."""
    word = _plain_word(name)
    return f"{word}_monitor" if _is_taken(word) else word


def check_module_name(name: str) -> None:
    """Refuse a name that files and functions cannot begin with as it is.

    Raises:
        EddiError: with one that they can begin with (G002).
    """
    usable = module_name(name)
    if usable == name:
        return
    why = (
        "it means something else in C or Python"
        if name == _plain_word(name)
        else "lower-case ASCII letters, digits and single underscores are expected"
    )
    raise EddiError(problem("G002.unusable_name", name=name, reason=why, usable=usable))


def _plain_word(name: str) -> str:
    decomposed = unicodedata.normalize("NFKD", name.casefold())
    base = "".join(char for char in decomposed if not unicodedata.combining(char))
    word = re.sub(r"[^a-z0-9]+", "_", base).strip("_")
    return f"event_{word}".rstrip("_") if not word or word[0].isdigit() else word


def _is_taken(word: str) -> bool:
    return word in _TAKEN or _C_INTEGER.fullmatch(word) is not None


Target = Literal["python", "c"]


@dataclass(frozen=True)
class HostArgument:
    """One value that the host gives.

    Attributes:
        input: its name and type.
        word: an identifier.
        description: one line on it.
        stamped: the time of its sample is asked for.
    """

    input: HostInput
    word: str
    description: str
    stamped: bool


@dataclass(frozen=True)
class StandaloneMonitor:
    """One monitor to print.

    Attributes:
        name: what files and functions begin with.
        kind: of its model, ``event`` or ``consert``.
        program: what it does.
        variables: an identifier for each variable.
        events: an identifier for each output.
        numeric: the only output is a number.
        source: lines of the text, for comments.
        units: value of the host -> its unit.
        enums: name of the ENUM of each variable, empty for none.
        sampling: from what the host gives to the variables.
        given: what the host gives.
    """

    name: str
    kind: str
    program: Program
    variables: tuple[str, ...]
    events: tuple[str, ...]
    numeric: bool
    source: tuple[str, ...]
    units: Mapping[str, str]
    enums: tuple[str, ...]
    sampling: Sampling
    given: tuple[HostArgument, ...] = ()

    @property
    def has_lists(self) -> bool:
        """Whether a variable is made of lists."""
        return any(variable.reduction is not None for variable in self.program.reads)


def named(
    program: Program,
    name: str,
    source: Sequence[str],
    *,
    kind: str = "event",
    units: Mapping[str, str] | None = None,
    enums: Mapping[str, str] | None = None,
) -> StandaloneMonitor:
    """Return what is printed of a program.

    Args:
        kind: of its model, ``event`` or ``consert``.
        program: what it does.
        name: of the monitor; any text.
        source: lines on what it was made of.
        kind: of its model.
        units: value of the host -> its unit.
        enums: what is read -> name of its ENUM.
    """
    model = StandaloneMonitor(
        name=module_name(name),
        kind=kind,
        program=program,
        variables=tuple(unique_names(read.name for read in program.reads)),
        events=tuple(unique_names(result.id for result in program.results)),
        numeric=[program.operations[result.operation].type for result in program.results]
        == ["number"],
        source=tuple(map(c_comment, source)),
        units=units or {},
        enums=tuple((enums or {}).get(read.name, "") for read in program.reads),
        sampling=Sampling(program),
    )
    return replace(model, given=_given(model))


def _given(model: StandaloneMonitor) -> tuple[HostArgument, ...]:
    """Return what the host gives: variables as they are, and the parts of reductions."""
    inputs = model.sampling.inputs
    plain = {
        read.name: (model.variables[k], describe(model, k))
        for k, read in enumerate(model.program.reads)
        if read.reduction is None
    }
    taken = [*model.variables]
    found = []
    for number, input_ in enumerate(inputs):
        if input_.name not in plain:
            taken.append(unique_names([*taken, input_.name])[-1])
            unit = f", in {model.units[input_.name]}" if model.units.get(input_.name) else ""
            shown = f"{input_.name}, {'list of ' if input_.list else ''}{input_.type}{unit}"
            plain[input_.name] = taken[-1], c_comment(shown)
        stamped = any(
            read.stamped and number in used
            for read, used in zip(model.program.reads, model.sampling.uses, strict=True)
        )
        found.append(HostArgument(input_, *plain[input_.name], stamped))
    return tuple(found)


def describe(model: StandaloneMonitor, number: int) -> str:
    """Return one line on a variable: type, unit, range, timeout."""
    variable = model.program.reads[number]
    parts = [variable.name, variable.type if not model.enums[number] else model.enums[number]]
    if model.units.get(variable.name):
        parts.append(f"in {model.units[variable.name]}")
    if variable.range is not None:
        parts.append(f"from {variable.range[0]!r} to {variable.range[1]!r}")
    if variable.infinite:
        parts.append("may be infinite")
    if variable.about:
        parts.append(variable.about)
    if variable.timeout is not None:
        parts.append(f"UNKNOWN after {variable.timeout / 1e9:g} s without a new sample")
    return c_comment(", ".join(parts))
