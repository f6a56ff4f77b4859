"""Documented properties of the fields of common messages: unit, range, no measurement."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from eddi_scaffold.config.field_paths import Attribute, ByName, FieldPath, FieldsOf, Index
from eddi_scaffold.config.field_types import Fields, element

_ROW = re.compile(
    r"(?P<unit>\S+)(?: (?P<low>[^.\s]+)\.\.(?P<high>[^.\s]+))?(?P<inf> inf)?"
    r"(?: unless (?P<field>\S+)=(?P<value>\S+))?"
)
_ELEMENTS = re.compile(r"\[([0-9,]+)\]")
NONE = "none"


@dataclass(frozen=True)
class Documented:
    """What is known of a field."""

    # one, or those of which the joint decides; none when the field has no unit
    units: tuple[str, ...] = ()
    range: tuple[float, float] | None = None  # least and greatest measurement
    limits: tuple[str, str] | None = None  # the same as paths of fields in the message
    infinite: bool = False  # infinities are measurements
    # path of a field and the value by which it marks that there is no measurement
    unless: tuple[str, float] | None = None


def documented(
    message: str, path: Sequence[str], fields_of: Callable[[str], Fields | None]
) -> Documented | None:
    """Return what is known of the field at the end of a path, ``None`` for nothing.

    The path has the names of fields, each with ``[]`` or ``[2]`` behind it where an element is
    taken. The outermost message with an entry counts: an ``Imu`` knows more of its
    ``angular_velocity.x`` than a ``Vector3`` of its ``x``.
    """
    of: str | None = message
    for start in range(len(path)):
        if of is None:
            return None
        row = _row(of, path[start:])
        if row is not None:
            return _seen_from(row, path[:start])
        inner = (fields_of(of) or {}).get(path[start].partition("[")[0])
        of = None if inner is None else element(inner) or inner
    return None


def documented_at(path: FieldPath, message: str, fields_of: FieldsOf) -> Documented | None:
    """Return the documentation of the field at the end of a path that has its keys."""
    names: list[str] = []
    for step in path:
        if isinstance(step, Attribute):
            names.append(step.name)
        elif isinstance(step, ByName):
            names.append(f"{step.values}[]")
        else:
            names[-1] += f"[{step.position}]" if isinstance(step, Index) else "[]"
    return documented(message, names, fields_of)


def _row(message: str, path: Sequence[str]) -> Documented | None:
    rows = _rows().get(message, {})
    exact = ".".join(path)
    every = re.sub(r"\[[0-9]+\]", "[]", exact)
    parent, _, _ = every.rpartition(".")
    return next((rows[name] for name in (exact, every, f"{parent}.*") if name in rows), None)


def _seen_from(row: Documented, before: Sequence[str]) -> Documented:
    """Return a row of an inner message with the paths of the outer one."""
    if not before:
        return row
    inside_a_list = any("[" in name for name in before)
    head = ".".join(before)
    if inside_a_list or (row.limits is None and row.unless is None):
        return Documented(row.units, row.range, None, row.infinite)
    limits = row.limits and (f"{head}.{row.limits[0]}", f"{head}.{row.limits[1]}")
    unless = row.unless and (f"{head}.{row.unless[0]}", row.unless[1])
    return Documented(row.units, row.range, limits, row.infinite, unless)


@cache
def _rows() -> Mapping[str, Mapping[str, Documented]]:
    """Return message type -> path -> its documentation."""
    rows: dict[str, dict[str, Documented]] = {}
    of = ""
    for line in (files(__package__) / "units.txt").read_text("utf-8").splitlines():
        if line.startswith("    "):
            paths, _, text = line.strip().partition(": ")
            documented = _parse_row(text)
            rows[of].update((path, documented) for name in paths.split() for path in _paths(name))
        elif line and not line.startswith("#"):
            of = line
            rows[of] = {}
    return rows


def _paths(name: str) -> Iterator[str]:
    match = _ELEMENTS.search(name)
    if match is None:
        yield name
        return
    for number in match[1].split(","):
        yield f"{name[: match.start()]}[{number}]{name[match.end() :]}"


def _parse_row(text: str) -> Documented:
    match = _ROW.fullmatch(text)
    assert match is not None, text
    units = () if match["unit"] == NONE else tuple(match["unit"].split("|"))
    low, high = match["low"], match["high"]
    fixed = low is not None and re.fullmatch(r"-?[0-9]+", low) is not None
    return Documented(
        units,
        (float(low), float(high)) if fixed else None,
        (low, high) if low is not None and not fixed else None,
        match["inf"] is not None,
        (match["field"], float(match["value"])) if match["field"] else None,
    )
