"""``eddi-scaffold example`` and ``explain``: where to start, and what a problem means."""

from __future__ import annotations

import json
import math
import re
from contextlib import closing
from pathlib import Path
from textwrap import fill
from typing import Annotated

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Domains, Files
from eddi_scaffold.cli.run import recorded
from eddi_scaffold.cli.watch import opened
from eddi_scaffold.common.problems import EddiError, Place, did_you_mean, problem


def example(name: str, folder: Annotated[Path | None, typer.Argument()] = None) -> None:
    """Write a worked example: model, configurations, a recording.

    Example: eddi-scaffold example two-conserts demo

    Args:
        name: Name of the example; `list` prints them.
        folder: New folder for its files.
    """
    from eddi_scaffold.packages.transaction import write

    names = list(described())
    if name == "list":
        width = max(map(len, names), default=0)
        for known, heading in described().items():
            console.data(f"{known.ljust(width)}  {heading}")
        return
    if name not in names:
        hint = did_you_mean(name, names) or f"examples: {', '.join(names)}"
        raise EddiError(problem("G008.example", hint=hint, name=name))
    target = folder or Path(name)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        case = "G006.not_empty" if target.is_dir() else "G006.file"
        raise EddiError(problem(case, Place(str(target))))
    folder = _examples() / name
    paths = {path.relative_to(folder): path for path in folder.rglob("*") if path.is_file()}
    files = {
        name.as_posix(): path.read_bytes()
        for name, path in paths.items()
        if not {"expected", "__pycache__"}.intersection(name.parts)
    }
    write(target, files)
    for file in sorted(files):
        console.data(str(target / file))
    console.say(f"next: read {target / 'README.md'}")


def described() -> dict[str, str]:
    """Return name -> the heading of its README, of every example, sorted."""
    texts = {path.parent.name: path.read_text("utf-8") for path in _examples().glob("*/README.md")}
    return {name: text.partition("\n")[0].lstrip("# ") for name, text in sorted(texts.items())}


def _examples() -> Path:
    """Return the folder of the checkout, or the copy in an installed wheel."""
    package = Path(__file__).resolve().parents[1]
    checkout = package.parent / "examples"
    return checkout if checkout.is_dir() else package / "_examples"


_CODE = re.compile(r"[A-Za-z][0-9]{3}")


def explain(
    name: str,
    files: Files = None,
    inputs: Path | None = None,
    bag: Path | None = None,
    at: float = math.inf,
    config: list[Path] | None = None,
    workspace: Path | None = None,
    no_code: bool = False,
    master: str | None = None,
    domain: Domains = None,
    as_json: bool = False,
) -> None:
    """Say why a claim does not hold, or what a problem means.

    Of a recording or of a robot that runs. Ends with status 0 when the claim holds, 1 when it does
    not, 2 when nobody tells.

    Example: eddi-scaffold explain FullSpeed robot.yml --bag shift.bag --at 12.7

    Args:
        name: A claim, as ID or MONITOR.ID, or the code of a problem, such as K007.
        files: What `run` plays: models, configurations, a deployment.yml, folders of packages.
        inputs: CSV, as of `run`.
        bag: ROS 1 or 2 bag with the topics of the configurations.
        at: Seconds from its start, as `run` prints them; by default its end.
        workspace: Workspace or output folder: its packages run.
        no_code: Leave out the code of packages.
        master: ROS 1 master of the robot that runs.
        domain: ROS 2 domain of the robot that runs, read over DDS; may be repeated.
    """
    if _CODE.fullmatch(name) or not (inputs or bag or files or workspace or master or domain):
        _explain_code(name, as_json=as_json)
        return
    from eddi_runtime.why import TRUE, ClaimWhy, clean

    from eddi_scaffold.recordings.playing import play, played
    from eddi_scaffold.recordings.results import sentence, told
    from eddi_scaffold.watch.fleet import FleetState
    from eddi_scaffold.watch.following import Clock, ask

    clock: Clock = "{:.3f}".format
    last: dict[str, tuple[float, ClaimWhy]] = {}
    if master or domain:
        played_of = {"FILE": files, "--inputs": inputs, "--bag": bag, "--workspace": workspace}
        if names := [name for name, value in played_of.items() if value]:
            names = ["--master" if master else "--domain", *names]
            raise EddiError(problem("G000.exclude", options=" and ".join(names)))
        source, clock = opened(None, master, domain, None)
        with closing(source):
            last = ask(source, FleetState(), name, console.say)
    else:
        options = {"--config": config or [], "--name": None, "--default-guarantee": ()}
        options |= {"--system": None, "--models": None}
        code = not no_code
        members, recording = recorded(files or [], inputs, bag, workspace, options, code=code)
        for monitor, t, why in told(play(played(members), recording), name):
            if t > at + 1e-9 and last:
                break
            last[monitor] = (t, why)
    for monitor, (t, why) in last.items():
        if as_json:
            row = {"t": t, "monitor": monitor, "claim": why.id, **why.as_json()}
            console.data(json.dumps(row))
            continue
        console.data(f"{f'{monitor}: ' if monitor else ''}{sentence(why)}")
        for cause in why.causes:
            console.data(f"  since {clock(max(t - cause.since, 0.0))}  {clean(cause.chain)}")
    if any(why.verdict != TRUE for _, why in last.values()):
        raise typer.Exit(ExitStatus.NO)


def _explain_code(code: str, *, as_json: bool) -> None:
    from eddi_scaffold.common import catalogue

    diagnostic = catalogue.find(code)
    if diagnostic is None:
        raise EddiError(problem("G008.code", code=code))
    if as_json:
        console.json(diagnostic.as_json())
        return
    console.data(f"{diagnostic.code}: {diagnostic.title} ({', '.join(diagnostic.levels)})")
    for text in (diagnostic.why, f"What to do: {diagnostic.fix}"):
        console.data(f"\n{fill(text, 96, break_long_words=False, break_on_hyphens=False)}")
    console.data("\n".join(["\nPrinted as:", "", *diagnostic.shown()]))
