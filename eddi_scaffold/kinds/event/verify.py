"""Whether the text of a monitor of events is what was read: its conditions, all else as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.evidence.conditions import of_inputs, parts_of
from eddi_scaffold.evidence.emitted import Call, Emitted

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Program


def verify(
    program: Program,
    units: Mapping[str, str],
    accepted: Mapping[str, Sequence[str]],
    emitted: Emitted,
) -> Iterator[str]:
    """Compare a text with events; yield what is proved.

    Args:
        program: the events as they were read.
        units: of the inputs.
        accepted: event -> what it accepts of silence.
        emitted: the text.
    """
    monitor = emitted.monitor("event.EventMonitor")
    ids = [input_.id for input_ in emitted.declared.inputs]
    order = [*dict.fromkeys(name for read in program.reads for name in parts_of(read))]
    rests: list[set[int]] = []  # of each operation, the places of its inputs in this order
    for of in program.operations:
        names = parts_of(program.reads[of.value]) if of.op in ("variable", "age") else ()
        rests.append({*map(order.index, names)}.union(*(rests[k] for k in of.args)))
    events = [
        Call(
            "event.Event",
            (
                result.id,
                result.hazard,
                tuple(ids.index(order[k]) for k in sorted(rests[result.operation])),
            ),
            {"accepts": tuple(accepted[result.id])} if accepted[result.id] else {},
        )
        for result in program.results
    ]
    emitted.attribute(monitor, "events", tuple(events))
    of_inputs(emitted, monitor, program, units)
    emitted.end(monitor)
    yield f"{', '.join(result.id for result in program.results)} (its conditions, each window)"
