"""Which of our messages a workspace needs: what its monitors publish, and what they listen to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.config.file import from_json
from eddi_scaffold.kinds import JsonValue, kinds
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE


def messages_of(monitors: Iterable[Mapping[str, JsonValue]]) -> dict[str, str]:
    """Return message name -> text.

    Args:
        monitors: the answers of each monitor package.
    """
    texts = {name: text for kind in kinds().values() for name, text in kind.messages.items()}
    wanted: list[str] = []
    for answers in monitors:
        wanted += kinds()[str(answers["kind"])].messages
        if answers["config_json"]:
            config = from_json(str(answers["config_json"]), "the configuration of a package").config
            heard = (one.type.partition("/") for one in config.SimulatorOutputs)
            wanted += [name for package, _, name in heard if package == MESSAGE_PACKAGE]
    found: dict[str, str] = {}
    while wanted:
        name = wanted.pop()
        if name in texts and name not in found:
            found[name] = texts[name]
            wanted += [line.partition(" ")[0].partition("[")[0] for line in texts[name].split("\n")]
    return found
