"""``eddi-scaffold inject``: faults in a recording, and when guarantees are gone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Files
from eddi_scaffold.cli.run import members_of, recorded
from eddi_scaffold.common.problems import EddiError, Place, plural, problem

_HEAD = ("guarantee", "fault", "on", "measured", "bound", "within", "verdict")
_OPTIONS = {"-c": (), "--name": None, "-g": (), "--system": None, "--models": None}


def inject(
    files: Files = None,
    inputs: Path | None = None,
    bag: Path | None = None,
    faults: str | None = None,
    phases: Annotated[int, typer.Option("--phases", min=1, max=1000)] = 8,
    vectors: Path | None = None,
    as_json: bool = False,
) -> None:
    """Inject faults into a recording.

    Prints after what time each guarantee of `Reactions:` is gone, with the computed bound and the
    time that is allowed.

    Example: eddi-scaffold inject robot.yml --bag shift.bag

    Args:
        files: Configurations that name their models, or a deployment.yml.
        inputs: CSV as `run` takes it.
        bag: ROS 1 or 2 bag with the topics of the configurations.
        faults: Only these of `Reactions:`, with commas between them.
        phases: How often each fault is injected, at other times and with other starts of the
            monitors.
        vectors: Inject nothing: write the test vectors of a ConSert as this bag, of ROS 1 (`.bag`)
            or 2.
    """
    if vectors is not None and (inputs or bag):
        raise EddiError(problem("G000.exclude", options="--vectors and a recording"))
    if vectors is not None:
        _write_vectors(vectors, files or [])
        return
    from eddi_scaffold.config.schema import FAULTS
    from eddi_scaffold.deployments.injection import Injector

    members, recording = recorded(files or [], inputs, bag, None, _OPTIONS, code=False)
    chosen = [name.strip() for name in faults.split(",")] if faults else FAULTS
    if unknown := [name for name in chosen if name not in FAULTS]:
        raise typer.BadParameter(f"{unknown[0]!r}; there are {', '.join(FAULTS)}")
    configured = all(member.monitor.config is not None for member in members)
    rows = [*Injector(members, recording, phases).rows(chosen)] if configured else []
    if not rows:
        raise EddiError(problem("G000.no_reactions"))
    if as_json:
        facts = {member.name: member.monitor.facts for member in members}
        monitors = [
            {"monitor": name, "digest": of.digest, "file": of.file, "sha256": of.file_sha256}
            for name, of in facts.items()
        ]
        head = {"format": 1, "recording": str(inputs or bag), "phases": phases}
        console.json({**head, "monitors": monitors, "rows": [row.as_json() for row in rows]})
    else:
        table = [_HEAD, *(row.cells() for row in rows)]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        for cells in table:
            line = "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
            console.data(line.rstrip())
    if any(row.verdict != "met" and not row.is_accepted for row in rows):
        raise typer.Exit(ExitStatus.NO)


def _write_vectors(path: Path, files: Sequence[Path]) -> None:
    from eddi_scaffold.packages.assembly import only
    from eddi_scaffold.packages.transaction import write

    try:
        from eddi_scaffold.recordings.vector_bags import bag_of
    except ImportError:
        raise EddiError(problem("I010.rosbags")) from None

    place = Place(str(path))
    if path.exists() or not path.name:
        raise EddiError(problem("G006.recording_exists", place))
    members, problems = members_of(files, None, _OPTIONS, code=False)
    console.problems(problems)
    monitors = [member.monitor for member in members]
    bag, told, left = bag_of(
        only([of for of in monitors if of.kind.name == "consert"] or monitors), path.name
    )
    if not told:
        raise EddiError(problem("G000.no_vectors", place))
    write(path.parent, bag)
    console.data("\n".join(told))
    console.say(f"{path}: {plural(len(told), 'vector')}")
    if left:
        console.say(f"these cannot be messages: {', '.join(left)}")
