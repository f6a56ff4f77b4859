"""Message types of a configuration: do they exist, as far as their packages are known?"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.monitors.message_types import installed_message, known_messages


def check_types(config: ConfigFile, used: Collection[str]) -> Iterator[Problem]:
    """Check the types of ``SimulatorOutputs``; inputs are made of those with the ids ``used``.

    What does not exist in a package that we know is an error (K048). Another type that is not known
    stays unchecked, which is reported once (K039).
    """
    known = {*known_messages(), *config.config.MessageTypes}
    packages, unchecked = {name.partition("/")[0] for name in known_messages()}, set[str]()
    for index, source in enumerate(config.config.SimulatorOutputs):
        package, type_ = source.type.partition("/")[0], source.type
        place = config.place("SimulatorOutputs", index, "type")
        if type_ in known or installed_message(type_) is not None:
            continue
        if package in packages:
            yield problem("K048.type", place, hint=did_you_mean(type_, known), type=type_)
        elif source.id in used and type_ not in unchecked:
            unchecked.add(type_)
            yield problem("K039", place, type=type_)
