"""``eddi-scaffold connect``: the draft of a configuration, and what is still to be decided."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.options import DefaultGuarantees, DryRun, Json, Name, NodeModels, in_a_folder

if TYPE_CHECKING:
    from eddi_scaffold.connect.connecting import DraftResult
    from eddi_scaffold.connect.surroundings import Surroundings

_STATES = {
    "kept": "decided before",
    "taken": "with one topic that fits",
    "listed": "with candidates",
    "none": "without a topic",
}


def connect(
    model: Annotated[Path, typer.Argument(help="EDDI XML, or a model file of a kind.")],
    system: Annotated[
        Path | None, typer.Option("--system", help="A .rossystem: the topics of the robot.")
    ] = None,
    models: NodeModels = None,
    others: Annotated[
        list[Path] | None,
        typer.Option("--with", help="eddi_config.yml of another monitor; repeatable."),
    ] = None,
    bag: Annotated[
        Path | None,
        typer.Option("--bag", help="ROS 1 or 2 bag of the robot: its topics, and max_age."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            callback=in_a_folder,
            help="The configuration to write or to complete; else it is printed.",
        ),
    ] = None,
    name: Name = None,
    default_guarantee: DefaultGuarantees = None,
    dry_run: DryRun = False,
    as_json: Json = False,
) -> None:
    """Draft a configuration: which topics fit which inputs.

    What is not clear says TODO, with candidates and reasons as comments; `check` lists it. In a
    configuration that is there, only what says TODO changes, and what is missing is added.

    Example: eddi-scaffold connect Rover.yml --system rover.rossystem --models nodes -o draft.yml
    """
    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.problems import has_errors
    from eddi_scaffold.connect.connecting import connect
    from eddi_scaffold.connect.rossystem import save
    from eddi_scaffold.connect.surroundings import Surroundings

    surroundings = Surroundings(system, models, others or (), default_guarantee or ())
    if bag is not None:
        surroundings = _with_bag(surroundings, bag)
    found = connect(model, name, output, surroundings)
    if as_json:
        console.json(found.as_json())
    elif dry_run and output is not None:
        console.data(found.diff().rstrip("\n"))
    elif output is None:
        console.data(found.after.rstrip("\n"))
    elif found.is_changed:
        save(output, found.after, found.before)
    console.problems(found.problems, summary=False)
    if not (system or bag or others or found.has_topics):
        console.say("topics come from --system, --bag, or SimulatorOutputs of the configuration")
    console.say(_what(found, writes=output is not None and not dry_run and not as_json))
    if has_errors(found.problems):
        raise typer.Exit(exit_status.NO)


def _with_bag(surroundings: Surroundings, bag: Path) -> Surroundings:
    """Return what is given, with the topics of a bag, and when their messages are too old."""
    from eddi_scaffold.connect.draft import recorded_age
    from eddi_scaffold.recordings.bags import read_contents

    found = read_contents(bag)
    ages = {topic: recorded_age(times, bag.name) for topic, times in found.times.items()}
    known = {topic: age for topic, age in ages.items() if age is not None}
    return replace(surroundings, ages=known, topics=found.topics, types=found.types)


def _what(found: DraftResult, *, writes: bool) -> str:
    """Return the last line: how far the draft is decided."""
    states = Counter(map(found.state, found.decisions))
    total = sum(states.values())
    counts = ", ".join(f"{states[one]} {text}" for one, text in _STATES.items() if states[one])
    inputs = f"{total} input{'s' if total != 1 else ''}{': ' if counts else ''}{counts}"
    todo = f"{found.todo} value{'s' if found.todo != 1 else ''} to be decided"
    done = ""
    if writes:
        done = f"; {found.name} is {'written' if found.is_changed else 'up to date'}"
    return f"{inputs}; {todo}{done}"
