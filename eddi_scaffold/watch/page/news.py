"""What is new for one who looks on: the rest was sent."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.watch.page.view import Group, View


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
        groups = [_heading(one) for one in view.groups if self._groups.get(one.id) != one]
        changes = [one for one in view.changes if one[0] > self._change]
        self._rows = rows
        self._groups = {one.id: one for one in view.groups}
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
