"""Message types as models write them: ``pkg.T``, ``pkg/T`` and ``pkg/msg/T``."""

from __future__ import annotations

import re

_NAME = r"[A-Za-z][A-Za-z0-9_]*"
_TYPE = re.compile(rf"({_NAME})(?:\.|/(?:(?:msg|srv|action)/)?)({_NAME})")


def type_of(written: str) -> tuple[str, str] | None:
    """Return package and name of a type; ``None`` when it is none."""
    match = _TYPE.fullmatch(written)
    return (match[1], match[2]) if match else None
