"""How much work a call does, in lines of Python that run: the same on every machine."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any


def work(call: Callable[[], object]) -> int:
    """Return how many lines of our own code, and of difflib, a call runs."""
    count = 0

    def line(_: FrameType, __: str, ___: Any) -> Any:
        nonlocal count
        count += 1
        return line

    def entered(frame: FrameType, _: str, __: Any) -> Any:
        nonlocal count
        count += 1
        file = frame.f_code.co_filename
        return line if "/eddi_" in file or file.endswith("difflib.py") else None

    before = sys.gettrace()
    sys.settrace(entered)
    try:
        call()
    finally:
        sys.settrace(before)
    return count
