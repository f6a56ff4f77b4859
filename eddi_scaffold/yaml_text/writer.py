"""Plain data as YAML text that readers of YAML 1.1 and 1.2 take alike.

Written by hand because the layout is that of SESAME D7.2 Fig 6 (which PyYAML cannot write) and
because a generated file must not change with the version of a library.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import yaml


class Verbatim(str):
    """A text that :func:`dump_plain` writes as it is: a number with its own digits."""

    __slots__ = ()


_PLAIN = re.compile(
    r"[A-Za-z_/\u00a1-\u2027\u202a-\ud7ff]"
    r"(?:[A-Za-z0-9_ ./+()\-\u00a1-\u2027\u202a-\ud7ff]*"
    r"[A-Za-z0-9_./+()\-\u00a1-\u2027\u202a-\ud7ff])?"
)
_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})
_ESCAPED = re.compile('["\\\\\x00-\x1f\x7f-\xa0\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff]')
_SHORT = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def quoted(text: str) -> str:
    """Return a text as a YAML scalar that readers of YAML 1.1 and 1.2 both take as this text."""
    if _PLAIN.fullmatch(text) and text.casefold() not in _WORDS:
        return text
    escaped = _ESCAPED.sub(lambda at: _SHORT.get(at[0]) or f"\\u{ord(at[0]):04x}", text)
    return f'"{escaped}"'


def dump_plain(data: Any) -> str:
    """Write None, Booleans, numbers, texts, and lists and maps of these, as any reader reads them.

    Block style, lists indented by two blanks, keys in their order, one line per scalar.
    """
    return "".join(f"{line}\n" for line in _lines(data))


def dump_11(data: dict[str, str]) -> str:
    """Write a flat map as Copier's filter ``to_nice_yaml`` writes it into an answers file."""
    text = yaml.safe_dump(data, indent=4, allow_unicode=True, default_flow_style=False)
    return str(text)


def _lines(data: Any) -> list[str]:
    lines: list[str] = []
    if isinstance(data, Mapping) and data:
        for key, value in data.items():
            first, *rest = _lines(value)
            if isinstance(value, Mapping | list | tuple) and value:
                lines += [f"{quoted(key)}:", *(f"  {line}" for line in (first, *rest))]
            else:
                lines.append(f"{quoted(key)}: {first}")
        return lines
    if isinstance(data, Sequence) and not isinstance(data, str) and data:
        for value in data:
            first, *rest = _lines(value)
            lines += [f"- {first}", *(f"  {line}" for line in rest)]
        return lines
    return [_scalar(data)]


def _scalar(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, Verbatim):
        return str(value)
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, Mapping):
        return "{}"
    if isinstance(value, Sequence):
        return "[]"
    if isinstance(value, int):
        return str(int(value))
    text = repr(float(value))
    if text in ("inf", "-inf", "nan"):
        return text.replace("inf", ".inf").replace("nan", ".nan")
    # YAML 1.1 takes 1e+16 as text: its numbers need a point before the exponent
    return text if "." in text or "e" not in text else text.replace("e", ".0e")
