"""The newest view, for all who look at it, and what of it is new for each of them."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.watch.fleet import Snapshot
from eddi_scaffold.watch.page import Group, View


@dataclass(frozen=True)
class Shown:
    """A snapshot and its view.

    Attributes:
        number: of views so far.
        at: when it was made, on the monotonic clock.
    """

    number: int
    at: float
    snapshot: Snapshot
    view: View


class Feed:
    """Holds what is shown.

    Attributes:
        closed: there will be no more.

    Args:
        snapshot: the first one.
        view: of it.
    """

    def __init__(self, snapshot: Snapshot, view: View) -> None:
        self._news = threading.Condition()
        self._shown = Shown(0, time.monotonic(), snapshot, view)
        self.closed = False

    @property
    def shown(self) -> Shown:
        """The newest."""
        return self._shown

    def show(self, snapshot: Snapshot, view: View) -> None:
        """Replace what is shown, and wake who waits for it."""
        with self._news:
            self._shown = Shown(self._shown.number + 1, time.monotonic(), snapshot, view)
            self._news.notify_all()

    def after(self, number: int, seconds: float) -> Shown:
        """Return the newest, and wait for it as long as it is not newer than a number."""
        with self._news:
            self._news.wait_for(lambda: self.closed or self._shown.number > number, seconds)
            return self._shown

    def close(self) -> None:
        """Let everybody who waits go."""
        with self._news:
            self.closed = True
            self._news.notify_all()


class Sent:
    """What was sent over one connection."""

    def __init__(self) -> None:
        self._rows: dict[str, tuple[str, str, str]] = {}
        self._groups: dict[str, Group] = {}
        self._change = 0

    def news(self, view: View) -> dict[str, Any]:
        """Return what of a view was not sent yet, and take it as sent."""
        rows = {row.id: row.parts for group in view.groups for row in group.rows}
        new_rows = {id_: parts for id_, parts in rows.items() if self._rows.get(id_) != parts}
        groups = [_heading(group) for group in view.groups if self._groups.get(group.id) != group]
        changes = [change for change in view.changes if change[0] > self._change]
        self._rows = rows
        self._groups = {group.id: group for group in view.groups}
        self._change = changes[0][0] if changes else self._change
        return {
            "time": view.time,
            "shape": view.shape,
            "rows": new_rows,
            "groups": groups,
            "changes": changes,
            "notes": view.notes,
        }


def _heading(one: Group) -> dict[str, Any]:
    return {
        "id": one.id,
        "number": one.number,
        "summary": one.summary,
        "facts": one.facts,
        "graph": one.graph,
    }
