"""Evidence judged in Python: common values by the text, all others by the runtime's function."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.compiling.program.instructions import Interval, Operation
from eddi_scaffold.compiling.text import number, text_literal

JUDGEMENTS = ("is_true", "is_false", "is_covered", "is_within")

_MAX_RANGES = 8
"""Ranges that are written out; more are judged by the general function."""


def judgement(one: Operation, place: int, value: str, target: str) -> list[str]:
    """Return the lines that judge a raw value.

    Args:
        one: the operation.
        place: number of what is read.
        value: name of the raw value.
        target: name of the truth value.
    """
    judged = f"1 if {value} is None else self.judge({place}, {value})"
    if one.op in ("is_true", "is_false"):
        good, bad = ("True", "False") if one.op == "is_true" else ("False", "True")
        return [
            f"if {value} is {good}:",
            f"    {target} = 2",
            "else:",
            f"    {target} = 0 if {value} is {bad} else {judged}",
        ]
    if one.op == "is_covered":
        return _covered(one.value, value, target, judged)
    if not 0 < len(one.value) <= _MAX_RANGES:
        return [f"{target} = {judged}"]
    lines = [f"if type({value}) is float or type({value}) is int:"]
    for k, interval in enumerate(one.value):
        lines.append(f"    {'elif' if k else 'if'} {_inside(value, interval)}:")
        lines.append(f"        {target} = 2")
    lines += ["    else:", f"        {target} = 0 if {value} == {value} else 1  # NaN is unknown"]
    return [*lines, "else:", f"    {target} = {judged}"]


def _covered(texts: Sequence[str], value: str, target: str, judged: str) -> list[str]:
    known = f"{target} = 2 if {value} in {{{', '.join(map(text_literal, texts))}}} else 0"
    if not texts or len(known) > 88:
        return [f"{target} = {judged}"]
    return [f"if type({value}) is str:", f"    {known}", "else:", f"    {target} = {judged}"]


def _inside(value: str, interval: Interval) -> str:
    end = "<=" if interval.closed else "<"
    return f"{number(interval.start)} <= {value} {end} {number(interval.end)}"
