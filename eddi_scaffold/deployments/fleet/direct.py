"""A fleet as if each robot read the guarantees of the others from topics: for checks of its wiring.

How guarantees travel does not matter to what they rest on: rings, meanings and ages are found by
the same checks as within one robot.
"""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import OutputEntry, SimulatorOutput
from eddi_scaffold.deployments.fleet.fleet import Fleet
from eddi_scaffold.deployments.fleet.offers import Seat
from eddi_scaffold.deployments.fleet.sources import GuaranteeSource, fed
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE


def read_directly(fleet: Fleet, seat: Seat) -> ConfigFile:
    """Return the configuration of a monitor that publishes for others, and reads them, by topic."""
    config, shared = seat.config, fleet.file.form.Fleet
    topic, lease = shared.topic, shared.lease
    if seat.guarantees:
        own = OutputEntry.model_construct(id="peers", topic=_topic(seat, topic))
        outputs = [*config.config.EDDIOutputs, own]
        config = replace(config, config=config.config.model_copy(update={"EDDIOutputs": outputs}))
    for bond in fleet.bonds_of(seat):
        sources = [
            GuaranteeSource(
                SimulatorOutput(
                    id=f"peer_{one.seat.robot.name}_{attribute(one.guarantee)}",
                    type=f"{MESSAGE_PACKAGE}/{one.seat.monitor.kind.output_message}",
                    topic=_topic(one.seat, topic),
                ),
                one.guarantee,
            )
            for one in bond.offers
        ]
        if sources:
            config = fed(config, bond.demand, sources, lease, bond.place)
    return config


def _topic(seat: Seat, topic: str) -> str:
    return f"{topic}/{seat.robot.name}/{seat.monitor.package}"
