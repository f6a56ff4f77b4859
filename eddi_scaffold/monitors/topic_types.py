"""Message types of a configuration: do they exist, as far as their packages are known?"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from difflib import get_close_matches

from eddi_scaffold.common.problems import Problem, most_similar, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.monitors.message_types import installed_message, installed_types, known_messages

_WHAT_TO_DO = "give the models of the robot (--models), or declare it below MessageTypes"


def check_types(config: ConfigFile, used: Collection[str]) -> Iterator[Problem]:
    """Check the types of ``SimulatorOutputs``; inputs are made of those with the ids ``used``.

    What does not exist in a package that is known with all its types is an error (K048). Of another
    package, it is reported what stays unchecked: a field, else the package, once (K039).
    """
    unchecked: dict[str, list[int]] = {}
    for index, source in enumerate(config.config.SimulatorOutputs):
        package, _, message = source.type.partition("/")
        types = installed_types(package) | _of_package(package, known_messages())
        is_known = source.type in types or source.type in config.config.MessageTypes
        if is_known or installed_message(source.type) is not None:
            continue
        if types:
            message = f"/{message}".casefold()
            others = [name for name in known_messages() if name.casefold().endswith(message)]
            hint = f"did you mean {others[0]!r}?" if others else _most_similar(source.type, types)
            place = config.place("SimulatorOutputs", index, "type")
            yield problem("K048.type", place, hint=hint, type=source.type)
        elif source.id in used:
            unchecked.setdefault(package, []).append(index)
    for package, sources in unchecked.items():
        fields = list(_unchecked_fields(config, sources))
        yield from fields or [_unknown_package(config, sources[0], package)]


def _of_package(package: str, names: Collection[str]) -> set[str]:
    return {name for name in names if name.startswith(f"{package}/")}


def _most_similar(type_: str, known: Collection[str]) -> str | None:
    package, _, message = type_.partition("/")
    name = most_similar(message, [other.partition("/")[2] for other in known])
    return f"did you mean '{package}/{name}'?" if name is not None else None


def _unchecked_fields(config: ConfigFile, sources: Sequence[int]) -> Iterator[Problem]:
    outputs = [config.config.SimulatorOutputs[index] for index in sources]
    types = {source.id: source.type for source in outputs}
    for index, entry in enumerate(config.config.EDDIInputs):
        type_ = next((types[name] for name in entry.requires if name in types), None)
        if entry.field is not None and type_ is not None:
            place = config.place("EDDIInputs", index, "field")
            yield problem("K039.fields", place, hint=_WHAT_TO_DO, type=type_, field=entry.field)


def _unknown_package(config: ConfigFile, index: int, package: str) -> Problem:
    type_ = config.config.SimulatorOutputs[index].type
    place = config.place("SimulatorOutputs", index, "type")
    declared = _of_package(package, config.config.MessageTypes)
    if declared:
        hint = _most_similar(type_, declared) or _WHAT_TO_DO
        return problem("K039.undeclared", place, hint=hint, type=type_)
    packages = sorted({name.partition("/")[0] for name in known_messages() if "/" in name})
    # names of packages are alike already: they end in `_msgs`
    similar = get_close_matches(package, packages, n=1, cutoff=0.9)
    hint = f"did you mean {similar[0]!r}? Else {_WHAT_TO_DO}" if similar else _WHAT_TO_DO
    return problem("K039.package", place, hint=hint, package=package)
