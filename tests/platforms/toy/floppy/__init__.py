"""A transport that takes messages as they are: uses what all transports share."""

from ...node.health import Health  # noqa: TID252 - the folder is vendored
from ...node.report import GraphFact  # noqa: TID252 - the same
from ...node.topics import Receipt  # noqa: TID252 - the same


def step(monitor, eddi_input, messages, now=0.0):
    """Return the output of one step, and what a diagnosis says of it."""
    eddi_input.bind(monitor.monitor.inputs)
    receipts = {name: Receipt(message, now, 1) for name, message in messages.items()}
    eddi_input.begin_step({name: one.age_at(now) for name, one in receipts.items()}, None, 0)
    eddi_input.processing(messages)
    output = monitor.execute_step(eddi_input, 0)
    health = Health(monitor.monitor, eddi_input, 1.0, 0.0)
    health.after_step(output, receipts, "", 0.0)
    nothing = {"overruns": 0, "graph": GraphFact()}
    said = health.collect(receipts=receipts, periodic=True, **nothing)
    return output, said.message
