"""``eddi-scaffold connect``: the draft of a configuration, and what is still to be decided."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Output
from eddi_scaffold.common.problems import has_errors, plural

if TYPE_CHECKING:
    from eddi_scaffold.connect.connecting import DraftResult

_STATES = {
    "kept": "decided before",
    "taken": "with one topic that fits",
    "listed": "with candidates",
    "none": "without a topic",
}


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
        rewrite(draft.name, draft.before, draft.after)
    console.problems(draft.problems, summary=False)
    if not (system or bag or others or draft.has_topics):
        console.say("topics come from --system, --bag, or SimulatorOutputs of the configuration")
    console.say(_summary(draft, writes=output is not None and not dry_run and not as_json))
    if has_errors(draft.problems):
        raise typer.Exit(exit_status.NO)


def _summary(draft: DraftResult, *, writes: bool) -> str:
    """Return the last line: how far the draft is decided."""
    states = Counter(map(draft.state, draft.decisions))
    counts = ", ".join(f"{states[key]} {text}" for key, text in _STATES.items() if states[key])
    inputs = plural(states.total(), "input") + (f": {counts}" if counts else "")
    done = f"; {draft.name} is {'written' if draft.is_changed else 'up to date'}" if writes else ""
    return f"{inputs}; {plural(draft.todo, 'value')} to be decided{done}"
