"""The messages of an expected workspace as plain classes, made of its ``.msg`` files."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from eddi_runtime.node.topics import Converter

HERE = Path(__file__).parents[3]
WORKSPACE = HERE / "examples" / "two-conserts" / "expected" / "src" / "eddi_monitor"


class Message:
    """A message of any class: its fields by name, and a header where it has one."""

    FIELDS: tuple[tuple[str, str], ...] = ()

    def __init__(self, **fields: Any) -> None:
        if ("header", "std_msgs/Header") in self.FIELDS:
            self.header = SimpleNamespace(stamp=None)
        vars(self).update(fields)


def package(name: str, texts: dict[str, str]) -> SimpleNamespace:
    made = {
        one: type(one, (Message,), {"FIELDS": _fields(text), "TYPE": f"{name}/{one}"})
        for one, text in texts.items()
    }
    return SimpleNamespace(__name__=f"{name}.msg", **made)


def _fields(text: str) -> tuple[tuple[str, str], ...]:
    lines = (line.partition("#")[0].split() for line in text.splitlines())
    pairs = ((line[1], line[0]) for line in lines if len(line) == 2 and "=" not in line[1])
    return tuple(
        (name, kind if kind[0].islower() else f"eddi_messages/{kind}") for name, kind in pairs
    )


EDDI_MESSAGES = package(
    "eddi_messages",
    {
        path.stem: path.read_text("utf-8")
        for path in (WORKSPACE / "eddi_messages/msg").glob("*.msg")
    },
)
_PRIMITIVES = ("bool", "string", "int8", "uint64", "float32", "float64")
STD_MSGS = package(
    "std_msgs",
    {
        **{kind.title().replace("Uint", "UInt"): f"{kind} data" for kind in _PRIMITIVES},
        "Pair": "int8[2] data",
    },
)


def converter(module: SimpleNamespace = EDDI_MESSAGES, stamp: Any = lambda: 7.0) -> Converter:
    return Converter(module, lambda cls: cls.FIELDS, lambda message: message.TYPE, stamp)
