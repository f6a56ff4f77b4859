"""Plain Python: pip-installable packages, one for each monitor and one with the runtime."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.common.identifiers import taken_by_python
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.platforms import RUNTIME_PACKAGE, PackageAnswers, Platform
from eddi_scaffold.platforms.ros_packages import GENERATED, distribution, runtime_packages

_TEMPLATES = ("plain_monitor", "plain_runtime")


def _monitor(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    answers, files = distribution(monitor, _TEMPLATES[0])
    samples = {  # as the example in the README sets them; None is unknown
        binding.attribute: binding.model.sample if binding.factor is None else None
        for binding in monitor.inputs
    }
    answers["sample_inputs"] = [f"{of}={python_literal(value)}" for of, value in samples.items()]
    return PackageAnswers(monitor.package, answers, files), []


def _taken_names(_root: Path | None) -> Mapping[str, str]:
    return {**taken_by_python(), "numpy": "it would hide numpy", RUNTIME_PACKAGE: GENERATED}


PLATFORM = Platform(
    name="plain",
    templates=_TEMPLATES,
    needs_config=False,
    monitor=_monitor,
    support=partial(runtime_packages, _TEMPLATES[1]),
    taken_names=_taken_names,
)
