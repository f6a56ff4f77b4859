"""Package names that would break a ROS 1 workspace.

A package name is also a top-level Python module of every node, and ``PYTHONPATH`` comes before the
standard library: a monitor called ``json`` stops every Python node of the workspace.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath

import rospkg

from eddi_scaffold.identifiers import RESERVED, STARTUP_MODULES
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.regions.files import LINK, entries

RUNTIME = "eddi_runtime"
ROSDEP_KEY = "python3-eddi-runtime-pip"
"""The runtime library as a distribution that is installed."""
METAPACKAGE = "eddi_monitor"
LAUNCHER = "eddi_monitor_launcher"
OWN = (METAPACKAGE, MESSAGE_PACKAGE, LAUNCHER, RUNTIME)
_IMPORTED_BY_ROSPY = (
    "catkin", "catkin_pkg", "defusedxml", "diagnostic_msgs", "genmsg", "genpy", "numpy", "rosclean",
    "rosgraph", "rosgraph_msgs", "roscpp", "roslaunch", "roslib", "roslz4", "rosmaster", "rosnode",
    "rospkg", "rospy", "rosservice", "rostopic", "setuptools", "std_msgs", "std_srvs", "yaml",
)  # fmt: skip

_MANIFESTS = frozenset(["package.xml", "manifest.xml"])


def taken_names(root: Path | None) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason.

    Packages of the ROS environment (``ROS_PACKAGE_PATH``) and of the workspace count, those below
    ``root`` do not: they are our own. Without ``root`` no package of ours counts: it may be the
    one that is meant.
    """
    around = [*rospkg.get_ros_paths(), *(_manifests(root.parent) if root is not None else ())]
    own = root.resolve() if root is not None else None
    taken: dict[str, str] = {}
    for name, place in _packages(around):
        if not (place.is_relative_to(own) if own is not None else _is_ours(place)):
            taken.setdefault(name, f"the ROS package {name} is in {place}")
    taken |= dict.fromkeys(
        sys.stdlib_module_names, "it would hide a module of Python's standard library"
    )
    taken.update(
        dict.fromkeys(_IMPORTED_BY_ROSPY, "it would hide a module that every ROS node imports")
    )
    taken.update(dict.fromkeys(STARTUP_MODULES, "every Python would import it at its start"))
    taken.update(dict.fromkeys(RESERVED, "it is a word of Python"))
    taken.update(dict.fromkeys(OWN, "eddi-scaffold generates a package of this name itself"))
    return taken


def _packages(paths: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """Yield the packages of ROS paths; a path with a damaged manifest has none."""
    for path in paths:
        found = rospkg.RosPack([path])
        with suppress(rospkg.InvalidManifest):
            yield from ((name, Path(found.get_path(name)).resolve()) for name in found.list())


def _manifests(source: Path) -> Iterator[str]:
    """Yield the folders of a workspace that hold a manifest, as rospkg finds them.

    It would follow every link, and one to `/` is the whole machine: here a link leads to one
    package, or to a repository with packages directly in it.
    """
    found = {PurePosixPath(name): kind for name, kind in entries(source, {".git"})}
    leaves = {path.parent for path in found if path.name in {*_MANIFESTS, "CATKIN_IGNORE"}}
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
