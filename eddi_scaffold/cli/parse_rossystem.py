"""``eddi-scaffold parse-rossystem``: the topics of a robot's system into a configuration."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.options import DryRun

if TYPE_CHECKING:
    from eddi_scaffold.connect.rossystem import Parsed


class Format(str, Enum):
    """What is made of the result."""

    yaml = "yaml"
    json = "json"


class Extra(str, Enum):
    """Topics in addition to the published ones."""

    subscribed = "subscribed"
    actions = "actions"


class NameSource(str, Enum):
    """Whose names the topics get."""

    label = "label"
    model = "model"


_EXTRAS: dict[Extra, Literal["subscribed", "actions"]] = {
    Extra.subscribed: "subscribed",
    Extra.actions: "actions",
}


def parse_rossystem(
    system: Annotated[
        Path, typer.Option("-s", "--system", help="The .rossystem: which components run.")
    ],
    models: Annotated[
        Path,
        typer.Option("-m", "--models", help="Directory of .ros, .ros1 and .ros2, with all below."),
    ],
    config: Annotated[
        Path, typer.Option("-c", "--config", help="The configuration to update or to create.")
    ] = Path("eddi_config.yml"),
    dry_run: DryRun = False,
    format: Annotated[  # noqa: A002 - the name of the option
        Format, typer.Option("--format", help="yaml writes the configuration, json prints.")
    ] = Format.yaml,
    include: Annotated[
        list[Extra] | None,
        typer.Option(
            "--include", help="Also topics only subscribed, or those of action servers; repeatable."
        ),
    ] = None,
    exclude_infrastructure: Annotated[
        bool,
        typer.Option(
            "--exclude-infrastructure",
            help="Leave out dynamic_reconfigure, rcl_interfaces, bond and lifecycle_msgs.",
        ),
    ] = False,
    only: Annotated[
        list[str] | None,
        typer.Option("--only", metavar="GLOB", help="Keep topics that match; repeatable."),
    ] = None,
    component: Annotated[
        list[str] | None,
        typer.Option(
            "--component",
            metavar="GLOB",
            help="Keep topics that a matching component provides; repeatable.",
        ),
    ] = None,
    topics: Annotated[
        NameSource,
        typer.Option("--topics", help="Names of the system, or those of the node models."),
    ] = NameSource.label,
) -> None:
    """Write a robot's topics into a configuration.

    They are the block SimulatorOutputs.

    Only that block changes. Ids that are there stay.

    Example: eddi-scaffold parse-rossystem -s robot.rossystem -m models -c eddi_config.yml
    """
    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.problems import has_errors
    from eddi_scaffold.connect.rossystem import Filters, parse, read_robot, save

    robot = read_robot(system, models)
    parsed = parse(
        robot,
        config,
        include=[_EXTRAS[extra] for extra in include or ()],
        filters=Filters(tuple(only or ()), tuple(component or ()), exclude_infrastructure),
        names="model" if topics is NameSource.model else "label",
    )
    if format is Format.json:
        console.json(parsed.as_json())
    elif dry_run:
        if diff := parsed.diff(str(config)):
            console.data(diff.rstrip("\n"))
    elif parsed.is_changed:
        save(config, parsed.after, parsed.before)
    console.problems(robot.located(parsed.problems), summary=False)
    summary = _summary(parsed)
    if format is Format.yaml:
        summary += f"; {_result(parsed, config, dry_run=dry_run)}"
    if has_errors(parsed.problems):
        console.complain(summary)
        raise typer.Exit(exit_status.NO)
    console.say(summary)


def _summary(parsed: Parsed) -> str:
    """Return how much there is in the system."""
    from eddi_scaffold.common.problems import plural

    counts = parsed.summary()

    def counted(*keys: str) -> list[str]:
        return [plural(counts[key], key.removesuffix("s")) for key in keys]

    unheard = " and ".join(counted(*(key for key in ("services", "actions") if counts[key])))
    silent = f"; {unheard} cannot be listened to" if unheard else ""
    topics = ", ".join(counted("components", "publishers", "topics"))
    return f"{topics}{silent}; {', '.join(counted('errors', 'warnings'))}"


def _result(parsed: Parsed, config: Path, *, dry_run: bool) -> str:
    """Return what became of the configuration."""
    from eddi_scaffold.common.problems import has_errors
    from eddi_scaffold.config.topic_block import KEPT_ENTRIES

    failed = has_errors(parsed.problems)
    if failed and not parsed.outputs.topics:
        changed = "written" if parsed.before is None else "changed"
        return f"nothing resolved, so {config} is not {changed}"
    if not parsed.is_changed:
        result = f"{config} is up to date"
    elif parsed.before is None:
        result = f"{config} {'would be' if dry_run else 'is'} written"
    else:
        result = f"{config}{' would change' if dry_run else ': SimulatorOutputs is rewritten'}"
    if failed:
        result += " with what resolved"
    kept = sum(problem.case in KEPT_ENTRIES for problem in parsed.problems)
    stays = "1 entry of before stays" if kept == 1 else f"{kept} entries of before stay"
    return f"{result}; {stays}" if kept else result
