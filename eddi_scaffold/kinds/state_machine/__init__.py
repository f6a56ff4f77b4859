"""The kind ``state_machine``: in which states a system may be, by what is known.

The state machines of an EDDI are made to be executed. A monitor keeps the set of all states that
are possible, and claims what holds in each of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.eddi_xml.vocabulary import MACHINES
from eddi_scaffold.kinds import ClaimField, Kind, messages_in

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

SUFFIX = ".machine"
"""Before that of the format: of a file of which only the state machine counts."""
KEYS = ("start", "reset", "observe", "triggers", "transitions", "evidence", "max_gap")
_UNKNOWN = 1


def _status(output: Any) -> StatusReading:
    unknown = tuple(output.unknown_inputs) or ((output.reason,) if output.reason else ())
    place = f"in {output.state or ' or '.join(output.possible)}"
    state = state_of(active=output.failed == 0, known=output.failed != _UNKNOWN)
    why = ((), place) if state == "active" else ((place, *unknown), "")
    verdicts = [Verdict("not failed", state, *why)]
    for evidence in output.evidence:
        known = not unknown and bool(output.state)
        state = state_of(active=evidence.active, known=known)
        verdicts.append(Verdict(evidence.id, state, () if evidence.active else (place, *unknown)))
    accepted = tuple(output.accepted)
    return StatusReading(tuple(verdicts), output.id, accepted=accepted, situation=place)


def _recognises(source: Source) -> bool:
    return source.name.lower().endswith((f"{SUFFIX}.xml", f"{SUFFIX}.json"))


KIND = Kind(
    name="state_machine",
    title="State machine",
    config_types=("StateMachine",),
    recognises=_recognises,
    messages=messages_in(__path__[0]),
    output_message="StateMachineOutput",
    verdicts={"StateMachineOutput": _status},
    model="state_machine_model.StateMachineModel",
    topic="state",
    claim=ClaimField("StateMachineOutput", "evidence[{}].active"),
    in_eddi=MACHINES,
    options=KEYS,
    without_input="its triggers are unknown, and every state that they may lead to is possible",
    inputs_of_model=False,  # triggers of a configuration make inputs
)
"""What the generator knows of state machines."""
