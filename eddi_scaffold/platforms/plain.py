"""Plain Python: pip-installable packages, one for each monitor and one with the runtime."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from eddi_scaffold.common.escaping import python_literal, toml_text
from eddi_scaffold.common.identifiers import taken_by_python
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.monitors.answers import files_of, shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.platforms import (
    RUNTIME,
    RUNTIME_PACKAGE,
    VENDORED,
    PackageAnswers,
    Platform,
    Templates,
)
from eddi_scaffold.platforms.ros_packages import GENERATED, runtime_packages
from eddi_scaffold.program.runtime_parts import requirements_of, runtime_parts_of

_TEMPLATES = Templates("plain_monitor", ("plain_runtime",))


def _monitor(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    files = files_of(monitor)
    answers = shared_answers(monitor, _TEMPLATES.monitor, files)
    answers["description_literal"] = toml_text(str(answers["description"]))
    answers["requirements"] = needs = requirements_of(runtime_parts_of(monitor.compiled.text))
    answers["requirements_text"] = ", ".join(needs) or "no other packages"
    samples = {  # as the example in the README sets them; None is unknown
        binding.attribute: binding.model.sample if binding.factor is None else None
        for binding in monitor.inputs
    }
    answers["sample_inputs"] = [f"{of}={python_literal(value)}" for of, value in samples.items()]
    answers["package_data"] = sorted(monitor.compiled.tables)
    answers[RUNTIME] = VENDORED
    return PackageAnswers(monitor.package, answers, files), []


def _taken_names(_root: Path | None) -> Mapping[str, str]:
    return {**taken_by_python(), "numpy": "it would hide numpy", RUNTIME_PACKAGE: GENERATED}


PLATFORM = Platform(
    name="plain",
    templates=_TEMPLATES,
    needs_config=False,
    monitor=_monitor,
    support=partial(runtime_packages, "plain_runtime"),
    taken_names=_taken_names,
)
