"""Whether each demand is fulfilled by the guarantee that it is really wired to."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.config.fields import ByKey
from eddi_scaffold.deployments.wiring.deployment import Deployment, Publisher
from eddi_scaffold.deployments.wiring.readings import FieldReading, readings
from eddi_scaffold.problems import Problem, error


def check_composition(deployment: Deployment) -> Iterator[Problem]:
    """Report demands that are wired to a guarantee which does not fulfil them (D004)."""
    for member in deployment.members:
        user = member.monitor
        seen: set[tuple[str, str]] = set()
        for reading in readings(user).fields:
            publisher = deployment.publisher(member, reading.source)
            output = None if publisher is None else _output(publisher, reading)
            if publisher is None or output is None or (reading.input, output) in seen:
                continue
            seen.add((reading.input, output))
            provider = publisher.member.monitor
            if provider.kind is not user.kind or user.kind.functions.unfulfilled is None:
                continue
            reason = user.kind.functions.unfulfilled(
                provider.model, output, user.model, reading.input
            )
            if reason is not None:
                message = f"demand {reading.input!r} is not fulfilled: {reason}"
                hint = "`eddi-scaffold compose` shows which guarantees would"
                yield error("D004", message, reading.place, hint)


def _output(publisher: Publisher, reading: FieldReading) -> str | None:
    """Return the id of the output that a field names."""
    path = publisher.publication.path or reading.path
    return next((str(step.wanted) for step in path if isinstance(step, ByKey)), None)
