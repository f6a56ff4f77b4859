"""Whether a message of a monitor is there again before it counts as unknown."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.wiring.deployment import Deployment
from eddi_scaffold.deployments.wiring.support import Participant
from eddi_scaffold.problems import Problem, error, warning

_PERIODS = 2
"""Of a publisher that a limit must allow; a little more is what is advised."""
_ADVISED = 2.5


def check_ages(together: Deployment) -> Iterator[Problem]:
    """Report inputs that give up on a monitor between two of its steps (K029).

    Nobody has decided on a limit that is not written: where it does not fit, that is an error.
    """
    publishers: dict[str, list[Participant]] = {}
    for one in together.participants:
        for topic in one.published():
            publishers.setdefault(topic, []).append(one)
    there = set(map(id, together.others))  # what is between these was told when they were made
    for reader in together.participants:
        for index, source in _reads(reader):
            for provider in publishers.get(reader.topic(source.topic), ()):
                if not there.issuperset((id(reader), id(provider))):
                    yield from _check(reader, index, source, provider)


def _reads(reader: Participant) -> Iterator[tuple[int, SimulatorOutput]]:
    """Yield each entry of ``EDDIInputs``, by its index, with each message that it reads."""
    config = reader.config.config
    required = {spec["id"]: spec["requires"] for spec in reader.document["inputs"]}
    for index, entry in enumerate(config.EDDIInputs):
        for source in config.SimulatorOutputs:
            if source.id in required.get(entry.id, ()):
                yield index, source


def _check(
    reader: Participant, index: int, source: SimulatorOutput, provider: Participant
) -> Iterator[Problem]:
    entry, period = reader.config.config.EDDIInputs[index], 1 / provider.frequency
    limit = source.limit if entry.max_age is None else entry.max_age
    if not isinstance(limit, float) or limit >= _PERIODS * period:
        return
    message = (
        f"input {entry.id!r} is unknown after {limit:g} s, but {provider.name} publishes only "
        f"every {period:g} s"
    )
    place = reader.config.place("EDDIInputs", index, "max_age")
    if entry.max_age is None and source.max_age is None:
        hint = f"write `max_age: {_ADVISED * period:g}` in its entry of EDDIInputs"
        yield error("K029", message, place, hint)
    else:
        hint = f"at least {_PERIODS} periods: max_age: {_PERIODS * period:g}"
        yield warning("K029", message, place, hint)
