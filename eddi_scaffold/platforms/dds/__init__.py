"""DDS: a pip-installable package for each monitor, which joins a ROS 2 graph without ROS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote

from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import parse_model
from eddi_scaffold.compiling.parts import PEERS, needed_by
from eddi_scaffold.escaping import toml_text
from eddi_scaffold.identifiers import taken_by_python
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to
from eddi_scaffold.monitors.nodes import node_of
from eddi_scaffold.platforms import (
    RUNTIME,
    VENDORED,
    Meeting,
    MeetingPlace,
    PackageAnswers,
    Platform,
    Templates,
)
from eddi_scaffold.platforms.dds.definitions import definitions_of, hashes_of
from eddi_scaffold.problems import Problem
from eddi_scaffold.ros.ros2_types import types_of

_TEMPLATES = Templates("dds_monitor")


def _monitor(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    known = types_of(monitor)
    monitor, errors = bound_to(monitor, known)
    node = node_of(monitor)
    definitions, unknown = definitions_of(node, known)
    answers = shared_answers(monitor, _TEMPLATES.monitor)
    answers["description_literal"] = toml_text(str(answers["description"]))
    needs = list(monitor.kind.requirements)
    answers["requirements"] = needs
    answers["requirements_text"] = ", ".join(["cyclonedds", *needs])
    files = dict(monitor.kind.functions.data_files(monitor.model))
    answers["package_data"] = ["model.json", *sorted(files)]
    answers |= node.answers(lambda of: f"messages.{of.replace('/', '_')}", has_qos=True)
    answers["definitions"] = definitions
    answers["hashes"] = hashes_of(node, known)
    answers[RUNTIME] = VENDORED
    needed = needed_by(compile_model(parse_model(monitor.model_json)))
    answers["parts"] = [*needed, PEERS] if answers["fleet"] else [*needed]
    return PackageAnswers(monitor.package, answers, files), [*node.problems, *errors, *unknown]


def _support(_monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    return []


def _taken_names(_root: Path | None) -> Mapping[str, str]:
    used = {name: f"it would hide {name}" for name in ("numpy", "cyclonedds", "rich_click")}
    return {**taken_by_python(), **used}


def _next_steps(place: Path, monitors: Sequence[str]) -> Sequence[str]:
    return [f"pip install {' '.join(quote(str(place / one)) for one in monitors)}", *monitors]


def _steps_of_robot(
    at: MeetingPlace, place: Path, namespace: str, monitors: Sequence[str]
) -> Sequence[str]:
    packages = " ".join(quote(str(place / name)) for name in monitors)
    given = [f"-r __ns:={namespace}"] if namespace else []
    given += [f"-p partition:={at.partition}"] if at.partition else []
    below = " ".join([" --ros-args", *given]) if given else ""
    return [
        f"pip install {packages}",
        *(f"ROS_DOMAIN_ID={at.name} {name}{below}" for name in monitors),
    ]


PLATFORM = Platform(
    name="dds",
    templates=_TEMPLATES,
    workspace=None,
    needs_config=True,
    monitor=_monitor,
    support=_support,
    taken_names=_taken_names,
    next_steps=_next_steps,
    meeting=Meeting("domain", "0", _steps_of_robot, has_partitions=True),
)
