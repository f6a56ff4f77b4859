"""What configurations add to models, and what they accept of silence, for ``show``."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.joining import join
from eddi_scaffold.deployments.wiring.acceptances import Accepted, acceptances
from eddi_scaffold.deployments.wiring.check import members_of
from eddi_scaffold.kinds import Model
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.problems import Problem


def accepted_of(
    models: Sequence[Model], configs: Sequence[ConfigFile], marks: Sequence[str] = ()
) -> tuple[list[Accepted], list[Model], list[Problem]]:
    """Return what configurations accept, with the claims that rest on it, or the errors.

    Between them are the models as they are configured; those that no configuration is about stay.

    Args:
        models: those of the file that is shown; a configuration may name another one.
        configs: the configurations.
        marks: the default guarantees that are marked.
    """
    if not configs:
        return [], list(models), []
    monitors, problems = join(models, configs, partial(checked_models, default_guarantees=marks))
    wrong = [problem for problem in problems if problem.level == "error"]
    if wrong:
        return [], list(models), wrong
    accepted = acceptances([member.participant for member in members_of(monitors)])
    made = {_identity(one.model): one.model for one in monitors}
    return accepted, [made.get(_identity(one), one) for one in models], []


def _identity(model: Model) -> tuple[str, str, str]:
    return model.kind, model.source.name, model.place.path or model.name  # may be named anew
