"""Inputs that grow: one thing many times, for each reader.

They stand in `tests/data/texts/growth/inputs.txt`, below lines `#### READER | FILE | NAME`. What is
between `⟪` and `⟫` comes n times (behind `⟪-1:` n - 1 times), with `#` for the number and `%` for
the next.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from tests.cli.command import XML_HEAD, XML_TAIL
from tests.data_files import data_text
from tests.package_texts import INPUT, eddi_input

_DIMENSION = (
    '<dependabilityProperty><dimension xsi:type="consert_:BinaryDimension">'
    '<dimensionType name="T"/></dimension></dependabilityProperty>'
)


@dataclass(frozen=True)
class Growing:
    """A family of inputs: what of `tests.fuzz.readers` reads them, a file, number -> text."""

    reader: str
    file: str
    text: Callable[[int], str]


def _text(template: str, n: int) -> str:
    def many(part: re.Match[str]) -> str:
        numbers = range(n - 1 if part[1] else n)
        return "".join(part[2].replace("#", str(k)).replace("%", str(k + 1)) for k in numbers)

    parts = {"head": XML_HEAD, "tail": XML_TAIL, "dimension": _DIMENSION}
    for name, text in parts.items():
        template = template.replace(f"⟦{name}⟧", text)
    template = re.sub(r"(?s)⟪(-1:)?(.*?)⟫", many, template)
    for name, value in {"⟦n⟧": n, "⟦n-1⟧": n - 1, "⟦1/n⟧": 1 / n, "♯": "#"}.items():
        template = template.replace(name, str(value))
    return template


def _package(n: int) -> str:
    return eddi_input([f"E{k}" for k in range(n)])


GROWING = {
    "sync: regions": Growing("sync", INPUT, _package),
    "sync: regions that were edited": Growing(
        "sync", INPUT, lambda n: _package(n).replace("message.data", "not message.data")
    ),
    "robot models: deep blocks": Growing(
        "robot models", "r.ros", lambda n: "".join(" " * k + "a:\n" for k in range(n))
    ),
}
for _family in re.split(r"(?m)^#### ", data_text("growth/inputs.txt"))[1:]:
    _head, _, _template = _family.partition("\n")
    _reader, _file, _name = _head.split(" | ")
    GROWING[f"{_reader}: {_name}"] = Growing(
        _reader, _file, lambda n, template=_template[:-1]: _text(template, n)
    )
