"""Reductions of lists: the nearest obstacle of a scan, the share of a condition that holds.

A reduction sees the lists and numbers of one message and gives one value. Every operation is done
on whole columns, one after the other. The text below the imports is copied into generated modules
unchanged.
"""

from __future__ import annotations

import math
from typing import Any, List, Mapping, Optional, Sequence, Tuple, Union

from .elements import AGGREGATES, CONVERSIONS, OPERATIONS, Value, finite, number_of

MAX_ELEMENTS = 100_000
"""A longer list is UNKNOWN, so that one message cannot stop a monitor."""
TRUTHS = ("list_count", "list_any", "list_all")
"""Reductions of truth values."""
_EMPTY = {"list_sum": 0.0, "list_count": 0.0, "list_any": 0}
"""Value of an empty list of messages; any other empty list is UNKNOWN."""


class Reduction:
    """One value of the lists of a message.

    Attributes:
        row: what it is made of, as JSON.
        op: ``list_min``, ``list_count``, ...
        inputs: what it reads, by name: lists first or last as they come.
    """

    def __init__(self, row: Mapping[str, Any]) -> None:
        """Take over what the generator made.

        Raises:
            KeyError, TypeError, ValueError, IndexError: it is damaged.
        """
        self.row = row
        self.op: str = row["op"]
        if self.op not in AGGREGATES and self.op not in TRUTHS:
            raise ValueError(f"there is no reduction {self.op!r}")
        self.inputs: Tuple[Mapping[str, Any], ...] = tuple(row["inputs"])
        self._lists = [k for k, one in enumerate(self.inputs) if one.get("list")]
        self._nodes = [_checked(node, k, len(self.inputs)) for k, node in enumerate(row["nodes"])]
        self._value: int = row["value"]
        self._limits: List[List[int]] = row.get("limits", [])
        used = [self._value, *(node for limit in self._limits for node in limit[1:])]
        if not self._lists or not all(0 <= node < len(self._nodes) for node in used):
            raise IndexError("a reduction without a list, or of a node that is not there")
        self._coverage: Optional[float] = row.get("coverage")
        self._length: Optional[Sequence[int]] = row.get("length")
        self._sector: Optional[Sequence[float]] = row.get("sector")
        self._angles: Sequence[int] = row.get("angles", ())
        self._messages = row.get("messages") is True

    def value(self, raws: Sequence[Any]) -> Tuple[Union[float, bool, None], str]:
        """Return the value, None for UNKNOWN, and why it is not known; never raises.

        Args:
            raws: for each input the list or the number, None when it is not there.
        """
        try:
            return self._reduced([_read(one, raw) for one, raw in zip(self.inputs, raws)])
        except _Unknown as reason:
            return None, str(reason)
        except Exception as problem:  # noqa: BLE001 - messages are what the robot sends
            return None, type(problem).__name__

    def _reduced(self, columns: List[Any]) -> Tuple[Union[float, bool, None], str]:
        count = self._checked_length(columns)
        chosen = self._in_sector(count, columns)
        if chosen is not None:
            for k in self._lists:
                columns[k] = columns[k][chosen[0] : chosen[1]]
            count = chosen[1] - chosen[0]
        if count == 0:
            if self._messages and self.op in _EMPTY:
                return _plain(self.op, _EMPTY[self.op]), ""
            raise _Unknown("the list is empty")
        self._limit(columns)
        values = self._columns(columns)[self._value]
        return self._aggregated(list(values))

    def _checked_length(self, columns: Sequence[Any]) -> int:
        lengths = {len(columns[k]) for k in self._lists}
        if len(lengths) > 1:
            raise _Unknown(f"lists of different lengths: {sorted(lengths)}")
        (count,) = lengths
        if count > MAX_ELEMENTS:
            raise _Unknown(f"{count} elements are more than {MAX_ELEMENTS}")
        if self._length is not None and not self._length[0] <= count <= self._length[1]:
            wanted = "..".join(str(n) for n in dict.fromkeys(self._length))
            raise _Unknown(f"{count} elements instead of {wanted}")
        return count

    def _in_sector(self, count: int, columns: Sequence[Any]) -> Optional[Tuple[int, int]]:
        """Return the first element in the sector and the one behind the last; None for all."""
        if self._sector is None or count == 0:
            return None
        start, end, step = (columns[k] for k in self._angles)
        low, high = self._sector
        half = abs(step) / 2
        last = start + (count - 1) * step
        if not (half > 0.0 and finite(half) == half and abs(last - end) <= 3 * half):
            raise _Unknown("the angles of the scan contradict its length")
        if not (min(start, last) - half <= low and high <= max(start, last) + half):
            raise _Unknown("the sector is not wholly within the scan")
        ends = sorted(int((angle - start) / step) for angle in (low - half, high + half))
        near = range(max(0, ends[0] - 1), min(count, ends[1] + 2))
        inside = [k for k in near if low - half <= start + k * step <= high + half]
        return (inside[0], inside[-1] + 1) if inside else (0, 0)

    def _limit(self, columns: List[Any]) -> None:
        """Make elements UNKNOWN that are finite and outside of their limits."""
        scalars = self._columns(columns, only_scalars=True) if self._limits else []
        for k, low_node, high_node in self._limits:
            low, high = scalars[low_node], scalars[high_node]
            if math.isnan(low) or math.isnan(high):
                raise _Unknown("the limits are not known")
            columns[k] = [x if low <= x <= high or x - x != 0.0 else math.nan for x in columns[k]]

    def _columns(self, columns: Sequence[Any], *, only_scalars: bool = False) -> List[Any]:
        """Return the value of each node: a list with one value per element, or one value."""
        count = len(columns[self._lists[0]])
        found: List[Any] = []
        for op, args, value in self._nodes:
            if op == "input":
                found.append(columns[value])
            elif op == "constant":
                found.append(value)
            elif any(isinstance(found[k], list) for k in args):
                if only_scalars:
                    found.append([])
                    continue
                of = (found[k] if isinstance(found[k], list) else [found[k]] * count for k in args)
                found.append(list(map(OPERATIONS[op], *of)))
            else:
                found.append(OPERATIONS[op](*(found[k] for k in args)))
        return found

    def _aggregated(self, values: Sequence[Value]) -> Tuple[Union[float, bool, None], str]:
        truths = self.op in TRUTHS
        known = (
            [x for x in values if x != 1] if truths else [x for x in values if not math.isnan(x)]
        )
        missing = len(values) - len(known)
        if self.op in ("list_any", "list_all") and (2 if self.op == "list_any" else 0) in known:
            return self.op == "list_any", ""
        if self._coverage is None:
            enough = missing == 0
        else:
            enough = bool(known) and len(known) / len(values) >= self._coverage
        if not enough:
            raise _Unknown(f"{missing} of {len(values)} elements are not known")
        if self.op == "list_count":
            return float(sum(x == 2 for x in known)), ""
        if truths:
            return self.op == "list_all", ""
        try:
            result = AGGREGATES[self.op](known)
        except (OverflowError, ValueError):  # sums of infinities, or beyond doubles
            result = math.nan
        if math.isnan(result):
            raise _Unknown("the value is not finite")
        return float(result), ""


class _Unknown(Exception):  # noqa: N818 - no error: a reason
    """Why a reduction gives nothing."""


def _plain(op: str, value: Value) -> Union[float, bool]:
    return value == 2 if op in ("list_any", "list_all") else float(value)


def _checked(node: Mapping[str, Any], number: int, inputs: int) -> Tuple[str, List[int], Any]:
    op, args, value = str(node["op"]), list(node.get("args", ())), node.get("value")
    if op == "input" and not (type(value) is int and 0 <= value < inputs):
        raise IndexError(f"node {number} reads what is not there")
    if op not in ("input", "constant") and op not in OPERATIONS:
        raise ValueError(f"node {number} has the unknown operation {op!r}")
    if not all(type(k) is int and 0 <= k < number for k in args):
        raise IndexError(f"node {number} works on what is not before it")
    return op, args, math.nan if op == "constant" and value is None else value


def _read(said: Mapping[str, Any], raw: Any) -> Any:
    """Return an input as a column of floats or truth values, or as one of them."""
    convert = CONVERSIONS[said["type"]]
    if not said.get("list"):
        return _valid(said, [convert(raw)])[0]
    if raw is None:
        raise _Unknown(f"no {said['name']}")
    items = raw.tolist() if hasattr(raw, "tolist") else raw
    if isinstance(items, str) or not hasattr(items, "__len__"):
        raise _Unknown(f"{said['name']} is no list")
    if len(items) > MAX_ELEMENTS:
        raise _Unknown(f"{len(items)} elements are more than {MAX_ELEMENTS}")
    if convert is number_of:  # most are floats: no call for them
        return _valid(said, [x if type(x) is float else number_of(x) for x in items])
    return _valid(said, list(map(convert, items)))


def _valid(said: Mapping[str, Any], column: List[Any]) -> List[Any]:
    """Return a column with NaN for what does not count."""
    if said["type"] == "bool":
        return column
    if not said.get("infinite"):
        column = [x if x - x == 0.0 else math.nan for x in column]
    if said.get("range") is not None:
        low, high = said["range"]
        column = [x if low <= x <= high or x - x != 0.0 else math.nan for x in column]
    missing = said.get("unknown")
    if missing:
        column = [math.nan if any(low <= x <= high for low, high in missing) else x for x in column]
    return column
