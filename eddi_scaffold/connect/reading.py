"""What a configuration says that may be half decided, without its schema."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.config.block import ConfigText
from eddi_scaffold.config.message_types import Fields, declared
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.connect.words import Synonyms, words
from eddi_scaffold.kinds import TODO
from eddi_scaffold.positioned_yaml.nodes import Map, Node, Scalar, items_of, read_map, value_11
from eddi_scaffold.problems import EddiError
from eddi_scaffold.source import Source


def content(document: ConfigText) -> Map:
    """Return the content of a configuration, empty where it says nothing.

    Raises:
        EddiError: it is no YAML map (K001).
    """
    lines = (line.strip() for line in document.text.splitlines())
    if all(not line or line.startswith("#") for line in lines):
        return Map(())
    node, problems = read_map(Source(document.name, document.text.encode()), "K001")
    if node is None or problems:
        raise EddiError(*problems)
    return node


def section_of(root: Map) -> Mapping[str, Any]:
    """Return the values of ``Model:``."""
    section = root.get("Model")
    return value_11(section) if isinstance(section, Map) else {}


def model_id(root: Map) -> str | None:
    """Return the id of the model that a configuration is of, ``None`` while that is open."""
    section = root.get("Model")
    name = text_of(section, "id") if section is not None else None
    return name if name and name != TODO else None


def text_of(node: Node, key: str) -> str | None:
    """Return the text of a key, ``None`` where there is none."""
    value = node.get(key) if isinstance(node, Map) else None
    return value.text if isinstance(value, Scalar) else None


def topics_of(root: Map) -> list[RobotTopic]:
    """Return the topics of a configuration, the first of each id."""
    section = root.get("SimulatorOutputs") or root.get("SimulatorOutput")
    found: dict[str, RobotTopic] = {}
    for one in items_of(section):
        id_, type_, topic = (text_of(one, key) for key in ("id", "type", "topic"))
        if id_ and type_ and topic:
            name = type_.replace("/msg/", "/").replace(".", "/")
            found.setdefault(id_, RobotTopic(id_, name, topic))
    return list(found.values())


def declared_types(root: Map) -> dict[str, Fields]:
    """Return the message types that a configuration declares itself."""
    given = root.get("MessageTypes")
    return {
        name.text: declared(
            ((text_of(fields, one) or "", one) for one in fields.keys()),  # noqa: SIM118 - no dict
            name.text.partition("/")[0],
        )
        for name, fields in (given.entries if isinstance(given, Map) else ())
        if isinstance(fields, Map)
    }


def synonyms_of(root: Map) -> Synonyms:
    """Return the words that a configuration says mean the same."""
    section = root.get("connect")
    groups = items_of(section.get("synonyms")) if isinstance(section, Map) else ()
    return frozenset(
        frozenset(
            word for one in items_of(group) if isinstance(one, Scalar) for word in words(one.text)
        )
        for group in groups
    )
