"""What a command was given of a robot beside its configurations."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eddi_scaffold.config.reading import RobotAdditions
from eddi_scaffold.problems import EddiError, Problem


@contextmanager
def beside_configs(
    system: Path | None, folder: Path | None
) -> Iterator[tuple[RobotAdditions | None, list[Problem]]]:
    """Add what a command was given beside configurations: a system, models, both or none.

    What does not resolve in the system is a warning here: only what an input requires must.

    Yields:
        What the models add, and what is wrong with them: it may be the reason for what is refused
        inside, and is told with it.

    Raises:
        EddiError: one of the two cannot be read, or the models of a system are missing (G017).
    """
    if system is None and folder is None:
        yield None, []
        return
    # reading MROS takes a while to import, and most commands are given none
    from eddi_scaffold.robot.robot_models import additions  # noqa: PLC0415

    robot, problems = additions(system, folder)
    try:
        yield robot, problems
    except EddiError as refused:
        raise EddiError(*problems, *refused.problems) from None
