"""Which of our messages a workspace needs: what its monitors publish, and what they listen to."""

from __future__ import annotations

from collections.abc import Mapping

from eddi_scaffold.config.file import from_json
from eddi_scaffold.kinds import JsonValue, kinds
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, read_respelt
from eddi_scaffold.problems import EddiError, Place


def messages_of(monitors: Mapping[str, Mapping[str, JsonValue]]) -> dict[str, str]:
    """Return message name -> text.

    Args:
        monitors: package -> its answers.

    Raises:
        EddiError: a monitor listens to a message that another one wants spelt otherwise (G026).
    """
    texts = {name: text for kind in kinds().values() for name, text in kind.all_messages.items()}
    wanted: list[str] = []
    heard: dict[str, str] = {}
    respelt: dict[str, str] = {}
    for package, answers in monitors.items():
        kind = kinds()[str(answers["kind"])]
        wanted += kind.messages
        if answers["config_json"]:
            config = from_json(str(answers["config_json"]), "the configuration of a package").config
            wanted += kind.between_robots if config.Fleet is not None else ()
            respelt |= kind.respelt(config.Model.model_extra or {})
            types = (one.type.partition("/") for one in config.SimulatorOutputs)
            heard |= {name: package for of, _, name in types if of == MESSAGE_PACKAGE}
    for name in heard.keys() & respelt.keys():
        raise EddiError(read_respelt(name, Place(heard[name])))
    texts |= respelt
    wanted += heard
    found: dict[str, str] = {}
    while wanted:
        name = wanted.pop()
        if name in texts and name not in found:
            found[name] = texts[name]
            wanted += [line.partition(" ")[0].partition("[")[0] for line in texts[name].split("\n")]
    return found
