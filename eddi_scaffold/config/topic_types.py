"""Message types of a configuration: do they exist, as far as their packages are known?"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from difflib import get_close_matches

from eddi_scaffold.common.problems import Problem, most_similar, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.config.message_types.installed import installed_message, installed_types

_LIKE = 0.9
"""Names of packages are alike already: they end in ``_msgs``."""
_WHAT_TO_DO = "give the models of the robot (--models), or declare it below MessageTypes"


def check_types(config: ConfigFile, used: Collection[str]) -> Iterator[Problem]:
    """Check the types of ``SimulatorOutputs``.

    What does not exist in a package that is wholly known is an error (K048). Of a package that is
    not known, it is reported what stays unchecked: a field, else the package, once (K039).

    Args:
        config: the configuration; its ``MessageTypes`` are known as well.
        used: ids of the outputs that an input is made of.
    """
    unchecked: dict[str, list[int]] = {}
    for index, source in enumerate(config.config.SimulatorOutputs):
        package = _package(source.type)
        there = _types_of(package)
        known = source.type in there or source.type in config.config.MessageTypes
        if known or installed_message(source.type) is not None:
            continue
        if there:
            hint = _exists_elsewhere(source.type) or _nearest(source.type, there)
            place = config.place("SimulatorOutputs", index, "type")
            yield problem("K048.type", place, hint=hint, type=source.type)
        elif source.id in used:
            unchecked.setdefault(package, []).append(index)
    for of_package in unchecked.values():
        fields = list(_unchecked_fields(config, of_package))
        yield from fields or [_unknown_package(config, of_package[0])]


def _package(type_: str) -> str:
    return type_.partition("/")[0]


def _types_of(package: str) -> frozenset[str]:
    """Return every type of a package that is wholly known; none for other packages."""
    table = frozenset(name for name in known_messages() if name.startswith(f"{package}/"))
    return table | installed_types(package)


def _exists_elsewhere(type_: str) -> str | None:
    """Return the hint at the same name in another package."""
    message = type_.partition("/")[2].casefold()
    found = [name for name in known_messages() if name.casefold().endswith(f"/{message}")]
    return f"did you mean {found[0]!r}?" if found else None


def _nearest(type_: str, there: Collection[str]) -> str | None:
    package, _, message = type_.partition("/")
    found = most_similar(message, [name.partition("/")[2] for name in there])
    return f"did you mean '{package}/{found}'?" if found is not None else None


def _unchecked_fields(config: ConfigFile, sources: Sequence[int]) -> Iterator[Problem]:
    types = {one.id: one.type for one in map(config.config.SimulatorOutputs.__getitem__, sources)}
    for index, entry in enumerate(config.config.EDDIInputs):
        type_ = next((types[name] for name in entry.requires if name in types), None)
        if entry.field is not None and type_ is not None:
            yield problem(
                "K039.fields",
                config.place("EDDIInputs", index, "field"),
                hint=_WHAT_TO_DO,
                type=type_,
                field=entry.field,
            )


def _unknown_package(config: ConfigFile, index: int) -> Problem:
    type_ = config.config.SimulatorOutputs[index].type
    package = _package(type_)
    place = config.place("SimulatorOutputs", index, "type")
    declared = [name for name in config.config.MessageTypes if _package(name) == package]
    if declared:
        return problem(
            "K039.undeclared", place, hint=_nearest(type_, declared) or _WHAT_TO_DO, type=type_
        )
    packages = sorted({_package(name) for name in known_messages() if "/" in name})
    near = get_close_matches(package, packages, n=1, cutoff=_LIKE)
    hint = f"did you mean {near[0]!r}? Else {_WHAT_TO_DO}" if near else _WHAT_TO_DO
    return problem("K039.package", place, hint=hint, package=package)
