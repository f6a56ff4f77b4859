"""``eddi-scaffold parse-rossystem``: the topics of a robot's system into a configuration."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.common.problems import has_errors, plural

if TYPE_CHECKING:
    from eddi_scaffold.connect.rossystem import Parsed


class Extra(str, Enum):
    """Topics in addition to the published ones."""

    subscribed = "subscribed"
    actions = "actions"


def parse_rossystem(
    system: Annotated[Path, typer.Option("-s", "--system")],
    models: Annotated[Path, typer.Option("-m", "--models")],
    config: Path = Path("eddi_config.yml"),
    dry_run: bool = False,
    format: Literal["yaml", "json"] = "yaml",  # noqa: A002 - the name of the option
    include: list[Extra] | None = None,
    exclude_infrastructure: bool = False,
    only: Annotated[list[str] | None, typer.Option("--only", metavar="GLOB")] = None,
    component: Annotated[list[str] | None, typer.Option("--component", metavar="GLOB")] = None,
    topics: Literal["label", "model"] = "label",
) -> None:
    """Write a robot's topics into a configuration.

    They are the block SimulatorOutputs.

    Only that block changes. Ids that are there stay.

    Example: eddi-scaffold parse-rossystem -s robot.rossystem -m models -c eddi_config.yml

    Args:
        system: The .rossystem: which components run.
        models: Directory of .ros, .ros1 and .ros2, with all below.
        config: The configuration to update or to create.
        format: yaml writes the configuration, json prints.
        include: Also topics only subscribed, or those of action servers; repeatable.
        exclude_infrastructure: Leave out dynamic_reconfigure, rcl_interfaces, bond and
            lifecycle_msgs.
        only: Keep topics that match; repeatable.
        component: Keep topics that a matching component provides; repeatable.
        topics: Names of the system, or those of the node models.
    """
    from eddi_scaffold.connect.robot import read_robot
    from eddi_scaffold.connect.rossystem import Filters, parse
    from eddi_scaffold.packages.transaction import rewrite

    robot = read_robot(system, models)
    filters = Filters(tuple(only or ()), tuple(component or ()), exclude_infrastructure)
    parsed = parse(robot, config, include=include or (), filters=filters, names=topics)
    if format == "json":
        console.json(parsed.as_json())
    elif dry_run:
        if diff := parsed.diff():
            console.data(diff.rstrip("\n"))
    elif parsed.is_changed:
        rewrite(parsed.name, parsed.before, parsed.after)
    console.problems(robot.located(parsed.problems), summary=False)
    counts = {key: plural(n, key.removesuffix("s")) for key, n in parsed.summary().items()}
    summary = ", ".join(counts[key] for key in ("components", "publishers", "topics"))
    unheard = [counts[key] for key in ("services", "actions") if parsed.summary()[key]]
    if unheard:
        summary += f"; {' and '.join(unheard)} cannot be listened to"
    summary += f"; {counts['errors']}, {counts['warnings']}"
    if format == "yaml":
        summary += f"; {_result(parsed, config, dry_run=dry_run)}"
    if has_errors(parsed.problems):
        console.complain(summary)
        raise typer.Exit(exit_status.NO)
    console.say(summary)


def _result(parsed: Parsed, config: Path, *, dry_run: bool) -> str:
    """Return what became of the configuration."""
    from eddi_scaffold.config.topic_block import KEPT_ENTRIES

    failed, is_new = has_errors(parsed.problems), parsed.before is None
    if failed and not parsed.outputs.topics:
        return f"nothing resolved, so {config} is not {'written' if is_new else 'changed'}"
    if not parsed.is_changed:
        result = f"{config} is up to date"
    elif is_new:
        result = f"{config} {'would be' if dry_run else 'is'} written"
    else:
        result = f"{config}{' would change' if dry_run else ': SimulatorOutputs is rewritten'}"
    if failed:
        result += " with what resolved"
    kept = sum(problem.case in KEPT_ENTRIES for problem in parsed.problems)
    stays = "1 entry of before stays" if kept == 1 else f"{kept} entries of before stay"
    return f"{result}; {stays}" if kept else result
