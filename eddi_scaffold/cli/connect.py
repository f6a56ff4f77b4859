"""``eddi-scaffold connect`` and ``parse-rossystem``: topics of a robot into a configuration."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Output
from eddi_scaffold.common.problems import has_errors, plural

if TYPE_CHECKING:
    pass


def connect(
    model: Path,
    system: Path | None = None,
    models: Path | None = None,
    others: Annotated[list[Path] | None, typer.Option("--with")] = None,
    bag: Path | None = None,
    output: Output = None,
    name: str | None = None,
    default_guarantee: list[str] | None = None,
    dry_run: bool = False,
    as_json: bool = False,
) -> None:
    """Draft a configuration: which topics fit which inputs.

    What is not clear says TODO, with candidates and reasons as comments; `check` lists it. In a
    configuration that is there, only what says TODO changes, and what is missing is added.

    Example: eddi-scaffold connect Rover.yml --system rover.rossystem --models nodes -o draft.yml

    Args:
        model: EDDI XML, or a model file of a kind.
        system: A .rossystem: the topics of the robot.
        others: eddi_config.yml of another monitor; repeatable.
        bag: ROS 1 or 2 bag of the robot: its topics, and max_age.
        output: The configuration to write or to complete; else it is printed.
    """
    from eddi_scaffold.connect.connecting import Surroundings, connect
    from eddi_scaffold.connect.draft import recorded_age
    from eddi_scaffold.packages.transaction import rewrite
    from eddi_scaffold.recordings.bags import read_contents

    surroundings = Surroundings(system, models, others or (), default_guarantee or ())
    if bag is not None:
        contents = read_contents(bag)
        ages = {
            topic: age
            for topic, times in contents.times.items()
            if (age := recorded_age(times, bag.name)) is not None
        }
        surroundings = replace(
            surroundings, ages=ages, topics=contents.topics, types=contents.types
        )
    draft = connect(model, name, output, surroundings)
    if as_json:
        console.json(draft.as_json())
    elif dry_run and output is not None:
        console.data(draft.diff().rstrip("\n"))
    elif output is None:
        console.data(draft.after.rstrip("\n"))
    elif draft.is_changed:
        rewrite(draft.document, draft.after)
    console.problems(draft.problems, summary=False)
    if not (system or bag or others or any(of.candidates for of in draft.decisions)):
        console.say("topics come from --system, --bag, or SimulatorOutputs of the configuration")
    summary = (
        f"{plural(len(draft.decisions), 'input')}; {plural(draft.todo, 'value')} to be decided"
    )
    if output is not None and not dry_run and not as_json:
        summary += f"; {draft.document.name} is {'written' if draft.is_changed else 'up to date'}"
    console.say(summary)
    if has_errors(draft.problems):
        raise typer.Exit(ExitStatus.NO)


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
    from eddi_scaffold.connect.rossystem import Filters, parse, read_config_text
    from eddi_scaffold.packages.transaction import rewrite

    robot = read_robot(system, models)
    filters = Filters(tuple(only or ()), tuple(component or ()), exclude_infrastructure)
    parsed = parse(
        robot, read_config_text(config), include=include or (), filters=filters, names=topics
    )
    if format == "json":
        console.json(parsed.as_json())
    elif dry_run:
        if diff := parsed.diff():
            console.data(diff.rstrip("\n"))
    elif parsed.is_changed:
        rewrite(parsed.document, parsed.after)
    console.problems(robot.located(parsed.problems), summary=False)
    counts = {key: plural(n, key.removesuffix("s")) for key, n in parsed.summary().items()}
    summary = ", ".join(counts[key] for key in ("components", "publishers", "topics"))
    summary += f"; {counts['errors']}, {counts['warnings']}"
    if format == "yaml":
        written = "would be written" if dry_run else "is written"
        summary += f"; {config} {written if parsed.is_changed else 'is not changed'}"
    if has_errors(parsed.problems):
        console.complain(summary)
        raise typer.Exit(ExitStatus.NO)
    console.say(summary)
