"""Packages of a workspace: the shared ones, their names, what they say in MROS."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any

import rospkg

from eddi_scaffold import __version__
from eddi_scaffold.common.identifiers import taken_by_python
from eddi_scaffold.config.field_types import element, fields_of, is_primitive
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import identity_answers
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, Publication
from eddi_scaffold.program.runtime_parts import LIFE_CYCLE, PEERS, runtime_parts_of, with_needed
from eddi_scaffold.regions.package import LINK, entries

_DIAGNOSTICS = ("/diagnostics", "diagnostic_msgs/DiagnosticArray")
_ARROWS = {"publishers": "pub", "subscribers": "sub"}


def interfaces_of(
    published: Iterable[Publication],
    heard: Iterable[SimulatorOutput],
    between_robots: dict[str, str],
) -> list[JsonValue]:
    """Return the sections of a node that are not empty: its topics, each once, sorted."""
    sections = {
        "publishers": dict([*((one.output.topic, one.type) for one in published), _DIAGNOSTICS])
        | between_robots,
        "subscribers": {one.topic: one.type for one in heard} | between_robots,
    }
    return [
        {
            "section": section,
            "topics": [{"topic": name, "type": _named(of)} for name, of in sorted(topics.items())],
        }
        for section, topics in sections.items()
        if topics
    ]


def nodes_of(monitors: Mapping[str, Mapping[str, Any]]) -> list[JsonValue]:
    """Return the nodes of a workspace, but for those that an earlier release made."""
    return [
        {
            "name": name,
            "interfaces": [
                {"direction": _ARROWS[part["section"]], "topic": topic["topic"]}
                for part in answers["interfaces"]
                for topic in part["topics"]
            ],
        }
        for name, answers in sorted(monitors.items())
        if answers.get("interfaces")
    ]


def specs_of(messages: Mapping[str, str]) -> Sequence[JsonValue]:
    """Return the fields of messages, without comments and constants."""
    return [
        {"name": name, "fields": [_field(*one) for one in fields_of(text, MESSAGE_PACKAGE).items()]}
        for name, text in sorted(messages.items())
    ]


def _field(name: str, type_: str) -> str:
    item = element(type_) or type_
    if item == "std_msgs/Header":
        written = "Header"  # a word of the language, which needs no model of std_msgs
    else:
        written = item if is_primitive(item) else f"'{_named(item)}'"
    return f"{written}{type_.removeprefix(item)} {name}"


def _named(type_: str) -> str:
    """Return a type as in the models: ``std_msgs/msg/Bool``."""
    return type_.replace("/", "/msg/")


RUNTIME = "eddi_runtime"
ROSDEP_KEY = "python3-eddi-runtime-pip"
"""The runtime library as a distribution that is installed."""
LAUNCHER = "eddi_monitor_launcher"
_MANIFESTS = frozenset(["package.xml", "manifest.xml"])


def taken_names(
    root: Path | None,
    environment: Iterable[str],
    ignoring: str,
    imported: Iterable[str],
    own: Iterable[str] = (),
) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason.

    Packages of the environment and of the workspace count, those below ``root`` do not: they are
    our own. Without ``root`` no package of ours counts: it may be the one that is meant.
    """
    inside = _manifests(root.parent, ignoring) if root is not None else ()
    ours = root.resolve() if root is not None else None
    taken: dict[str, str] = {}
    sourced = "; a terminal in which its workspace is not sourced does not see it"
    for paths, end in ((inside, ""), (environment, sourced)):
        for name, place in _packages(paths):
            if not (place.is_relative_to(ours) if ours is not None else _is_ours(place)):
                taken.setdefault(name, f"the ROS package {name} is in {place}{end}")
    taken |= taken_by_python()
    taken |= dict.fromkeys(imported, "it would hide a module that every ROS node imports")
    generated = (MESSAGE_PACKAGE, LAUNCHER, RUNTIME, *own)
    return taken | dict.fromkeys(generated, "eddi-scaffold generates a package of this name itself")


def _packages(paths: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """Yield the packages of ROS paths; a path with a damaged manifest has none."""
    for path in paths:
        found = rospkg.RosPack([path])
        with suppress(rospkg.InvalidManifest):
            yield from ((name, Path(found.get_path(name)).resolve()) for name in found.list())


def _manifests(source: Path, ignoring: str) -> Iterator[str]:
    """Yield the folders of a workspace that hold a manifest, as rospkg finds them.

    It would follow every link, and one to `/` is the whole machine: here a link leads to one
    package, or to a repository with packages directly in it.
    """
    found = {PurePosixPath(name): kind for name, kind in entries(source, {".git"})}
    leaves = {path.parent for path in found if path.name in {*_MANIFESTS, ignoring}}
    for path, kind in sorted(found.items()):
        inner = path if kind == LINK else path.parent
        if leaves.isdisjoint(inner.parents):
            if kind is None and path.name in _MANIFESTS:
                yield str(source / path.parent)
            elif kind == LINK:
                near = [
                    *(source / path).glob("package.xml"),
                    *(source / path).glob("*/package.xml"),
                ]
                yield from (str(manifest.parent) for manifest in near if manifest.is_file())


def _is_ours(package: Path) -> bool:
    """Return whether a package was generated, also where it is installed."""
    try:
        manifest = (package / "package.xml").read_text("utf-8", "replace")
    except OSError:  # of the time before catkin, which is older than ours
        return False
    return any(f"<exec_depend>{one}</exec_depend>" in manifest for one in (RUNTIME, ROSDEP_KEY))


_RELEASE = ".".join(__version__.split(".")[:3])
"""Version of these packages: they come with the generator."""
_MAINTAINED = ("maintainer_name", "maintainer_email", "license")


def package_answers(
    template: str,
    name: str,
    description: str,
    monitors: Mapping[str, Mapping[str, JsonValue]],
    /,
    **more: JsonValue,
) -> dict[str, JsonValue]:
    """Return the answers of one such package; who maintains a monitor, maintains it too."""
    answers = {"template": template, **identity_answers(name, description, None), **more}
    answers["package_version"], nobody = _RELEASE, answers["maintainer_email"]
    for package in sorted(monitors, reverse=True):
        said = {key: monitors[package][key] for key in _MAINTAINED if key in monitors[package]}
        answers |= said if said.get("maintainer_email") != nobody else {}
    return answers


def runtime_parts(monitors: Mapping[str, Mapping[str, JsonValue]]) -> set[str]:
    """Return the parts of the runtime that monitors need."""
    return {part for answers in monitors.values() for part in _parts(answers)}


def _parts(answers: Mapping[str, JsonValue]) -> Sequence[str]:
    needed = runtime_parts_of(str(answers["compiled"]))
    asked = {"fleet": PEERS, "lifecycle": LIFE_CYCLE}
    return with_needed([*needed, *(part for name, part in asked.items() if answers.get(name))])
