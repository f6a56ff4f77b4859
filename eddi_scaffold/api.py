"""Use eddi-scaffold from a program: what the commands do, without their words and exit statuses.

Every function raises ``EddiError`` where its command would exit with 2; ``EddiError.problems`` has
codes, places and hints. What this module exports is public and changes only with a major version.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.kinds import JsonValue, Model, ReadResult
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.assembly import assemble, monitors_of, only
from eddi_scaffold.packages.generation import WriteResult, write_packages
from eddi_scaffold.packages.handwritten import until_written_near
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.workspace import alone, packages_root
from eddi_scaffold.platforms import choices, chosen
from eddi_scaffold.recordings.members import Member, read_values
from eddi_scaffold.recordings.playing import play, played
from eddi_scaffold.recordings.results import steps

__all__ = [
    "EddiError",
    "Model",
    "Place",
    "Problem",
    "ReadResult",
    "WriteResult",
    "check",
    "generate",
    "load",
    "run",
]


def _paths(files: str | Path | Iterable[str | Path] | None) -> list[Path]:
    """Return one file, several or none as a list; a text is one file, not its letters."""
    if files is None:
        return []
    return [Path(files)] if isinstance(files, str | Path) else [Path(file) for file in files]


def load(path: str | Path) -> ReadResult:
    """Read every model of a file: EDDI XML, or a model file of a kind.

    Args:
        path: the file.

    Returns:
        The models, every problem of the file, and what else is in it.

    Raises:
        EddiError: the file cannot be opened (F001).
    """
    return read_models(read_source(Path(path)))


def check(files: str | Path | Iterable[str | Path], platform: str | None = None) -> list[Problem]:
    """Check models and configurations, each by itself and as monitors together.

    Args:
        files: models and configurations, in any order; or one.
        platform: ``ros1``, ``ros2``, ``plain`` or ``dds``; by default models with configurations
            are checked for ROS 1, with ``lifecycle`` for ROS 2, others by themselves.

    Returns:
        Every problem; the files are sound when no ``Problem.level`` is ``error``. What is to be
        written by hand is none once it is, in a package near the files.

    Raises:
        EddiError: there is no such platform (G008).
    """
    paths = _paths(files)
    return until_written_near(check_files(paths, platform=platform), paths)


def generate(
    folder: str | Path,
    model: str | Path | None = None,
    configs: str | Path | Iterable[str | Path] = (),
    platform: str = "ros1",
    *,
    runtime: str | None = None,
    single_process: bool | None = None,
    dry_run: bool = False,
) -> WriteResult:
    """Generate packages, or bring those that are there up to date; hand-written lines stay.

    Args:
        folder: the workspace, or the folder of the packages on other platforms.
        model: the model file; ``None`` where the configurations name theirs.
        configs: one ``eddi_config.yml`` for each monitor, or one for one.
        platform: ``ros1``, ``ros2``, ``plain`` or ``dds``.
        runtime: where the runtime library is, ``vendored`` or ``installed``; by default as it is.
        single_process: whether one process runs all monitors of a workspace; by default as it is.
        dry_run: change nothing; ``WriteResult.diff()`` shows what would change.

    Returns:
        What was changed, and what a person should look at.

    Raises:
        EddiError: an input cannot be used, or a package could not be written; nothing was changed.
    """
    target = chosen(platform)
    place = Path(folder)
    root = packages_root(target, place)
    with alone(() if dry_run else [root]):
        monitors, problems = monitors_of(_paths(model), _paths(configs), root=root)
        plan = assemble(monitors, target, root, problems, choices(runtime, single_process))
        return write_packages(root, plan.packages, own_template(), dry_run=dry_run)


def run(
    recording: str | Path, model: str | Path | None = None, config: str | Path | None = None
) -> Iterator[Mapping[str, JsonValue]]:
    """Run one monitor on recorded inputs, with the steps of its node; hand-written code is not run.

    Args:
        recording: CSV with a column ``t`` in seconds and one column for each input.
        model: the model file; ``None`` where the configuration names it.
        config: how the model is connected; without one, no ages are checked and each row is a step.

    Yields:
        Time in seconds and outputs of each step, as ``run --json`` prints them.

    Raises:
        EddiError: an input cannot be used, or the files hold several models (G005).
    """
    monitors, _ = monitors_of(_paths(model), _paths(config))
    members, rows, _ = read_values(read_source(Path(recording)), [Member(only(monitors))])
    yield from steps(play(played(members), rows))
