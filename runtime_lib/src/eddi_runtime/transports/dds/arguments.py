"""What a person gives a node: its names, remaps and parameters, spelt as for any node of ROS 2.

``--ros-args -r __ns:=/robot1 -r /rte/e0:=/sim/e0 -p frequency:=5.0``.
"""

from __future__ import annotations

import contextlib
import re
from typing import Mapping, NamedTuple, Sequence, Union

from ...node.start import StartError

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_TOPIC = re.compile(r"(?:~/|/)?[A-Za-z_][A-Za-z0-9_]*(?:/[A-Za-z_][A-Za-z0-9_]*)*")
_DOMAINS = 233
Parameter = Union[bool, int, float, str]


class Arguments(NamedTuple):
    """Names, remaps and parameters of a node."""

    name: str  # of the node
    namespace: str  # ``/``, or such as ``/robot1``
    remaps: Mapping[str, str]  # full name of a topic -> the full name that is meant
    parameters: Mapping[str, Parameter]  # private parameters by name

    @property
    def full_name(self) -> str:
        """Return the node's name with its namespace."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    def topic(self, name: str) -> str:
        """Return the full name of a topic."""
        full = self._expanded(name)
        return self.remaps.get(full, full)

    def _expanded(self, name: str) -> str:
        if name.startswith("/"):
            return name
        if name.startswith("~/"):
            return f"{self.full_name}/{name[2:]}"
        return f"{self.namespace.rstrip('/')}/{name}"


def arguments(words: Sequence[str], name: str) -> Arguments:
    """Return what the words of a command line say; only options are read.

    Args:
        words: of the command line, without the program.
        name: of the node, unless another one is given.

    Raises:
        StartError: a word is not understood, or no name of ROS 2.
    """
    remaps: dict[str, str] = {}
    parameters: dict[str, Parameter] = {}
    for option, assignment in _pairs(words):
        key, found, value = assignment.partition(":=")
        if not found:
            raise StartError(f"{option} {assignment}: NAME:=VALUE is expected")
        if option in ("-p", "--param"):
            parameters[key] = _scalar(value)
        else:
            remaps[key] = value
    namespace = "/" + remaps.pop("__ns", "/").strip("/")
    name = remaps.pop("__node", remaps.pop("__name", name))
    if not _NAME.fullmatch(name):
        raise StartError(f"{name!r} is no name for a node")
    if namespace != "/" and not _TOPIC.fullmatch(namespace):
        raise StartError(f"{namespace!r} is no namespace")
    for topic in (one for pair in remaps.items() for one in pair):
        if not _TOPIC.fullmatch(topic):
            raise StartError(f"{topic!r} is no name of a topic")
    plain = Arguments(name, namespace, {}, parameters)
    full = {plain.topic(old): plain.topic(new) for old, new in remaps.items()}
    return plain._replace(remaps=full)


def _pairs(words: Sequence[str]) -> list[list[str]]:
    """Return option and value of all between ``--ros-args`` and ``--``."""
    given = list(words)
    begin = given.index("--ros-args") if "--ros-args" in given else len(given)
    for word in given[:begin]:
        if word.startswith("-"):  # such as --help, or -p: to ignore it would be to start otherwise
            raise StartError(f"{word}: --ros-args -r NAME:=NAME -p NAME:=VALUE is expected")
    given = given[begin + 1 :]
    given = given[: given.index("--")] if "--" in given else given
    pairs = [given[k : k + 2] for k in range(0, len(given), 2)]
    for pair in pairs:
        if pair[0] not in ("-p", "--param", "-r", "--remap") or len(pair) < 2:
            raise StartError(f"{' '.join(pair)}: -r NAME:=NAME or -p NAME:=VALUE is expected")
    return pairs


def _scalar(text: str) -> Parameter:
    if text in ("true", "false"):
        return text == "true"
    for number in (int, float):
        with contextlib.suppress(ValueError):
            return number(text)
    return text


def domain_id(text: str) -> int:
    """Return the domain of ``ROS_DOMAIN_ID``.

    Raises:
        StartError: it is none.
    """
    if text.isdecimal() and int(text) < _DOMAINS:
        return int(text)
    raise StartError(f"ROS_DOMAIN_ID is {text!r}, a number from 0 to {_DOMAINS - 1} is expected")
