"""Package names that would break a workspace: those of packages that are there already.

A package name is also a top-level Python module of every node, and ``PYTHONPATH`` comes before the
standard library: a monitor called ``json`` stops every Python node of the workspace.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath

import rospkg

from eddi_scaffold.identifiers import taken_by_python
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.regions.package import LINK, entries

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

    Args:
        root: folder of all our packages.
        environment: folders with installed packages.
        ignoring: name of the file that hides a folder from the build tool.
        imported: modules that every node imports.
        own: packages that are generated beside ours of both ROS.
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
