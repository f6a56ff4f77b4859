"""``eddi-scaffold show``: what is in a model file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, has_errors

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model
    from eddi_scaffold.monitors.survey import Shown


def show(
    model: Path,
    name: str | None = None,
    config: list[Path] | None = None,
    default_guarantee: list[str] | None = None,
    as_json: bool = False,
) -> None:
    """Show the models of a file as a tree, or as JSON.

    With configurations also what they add, such as thresholds and bins, what they accept in place
    of known values, and the claims that rest on it.

    Example: eddi-scaffold show example.xml -c consert_a_config.yml

    Args:
        model: EDDI XML, a model file of a kind, .rossystem or .ros; or an eddi_config.yml that
            names its model.
    """
    from eddi_scaffold.deployments.joining import accepted_of
    from eddi_scaffold.monitors.loading import read_models, select_models, unfit
    from eddi_scaffold.monitors.survey import configured, mros_of, only, survey_of

    source = read_source(model)
    robot = mros_of(source)
    if robot is not None:
        _show_robot(robot, as_json=as_json)
        return
    files = configured(source, [read_source(path) for path in config or ()])
    marks = default_guarantee or ()
    survey, problems = survey_of(files.source)
    reading = read_models(files.source, marks)
    if has_errors(problems) or (not reading.models and has_errors(reading.problems)):
        raise EddiError(*(problems if has_errors(problems) else reading.problems))
    chosen: Sequence[Model] = reading.models
    if name is not None:
        chosen = select_models(reading.models, name)
        survey = only(survey, chosen)
    accepted, models, wrong = accepted_of(reading.models, files.configs, marks)
    if as_json:
        rows = [acceptance.as_json() for acceptance in accepted]
        console.json({**survey, "accepted": rows} if files.configs else survey)
    else:
        pairs = zip(reading.models, models, strict=True)
        _print(survey, reading.models, [joined for model, joined in pairs if model in chosen])
        if accepted:
            console.data("\n".join(["", "accepted:", *(f"  {a.as_text()}" for a in accepted)]))
    of_models = [] if as_json else [*reading.problems, *reading.unread, *unfit(chosen)]
    console.problems([*files.problems, *wrong, *of_models])
    if wrong or has_errors(reading.problems):  # what remains of the file was shown
        raise typer.Exit(exit_status.NO)


def _show_robot(shown: Shown, *, as_json: bool) -> None:

    if as_json:
        console.json(shown.document)
    else:
        for line in shown.tree:
            console.data(line)
        console.problems(shown.problems)
    if has_errors(shown.problems):
        raise typer.Exit(exit_status.NO if shown.tree else exit_status.BAD_INPUT)


def _print(survey: Mapping[str, Any], models: Sequence[Model], chosen: Sequence[Model]) -> None:
    from eddi_scaffold.kinds import kinds
    from eddi_scaffold.monitors.survey import is_one_of

    for model in chosen:
        console.data(f"{kinds()[model.kind].title} {model.name}")
        for line in model.outline():
            console.data(f"  {line}")
        for linked in model.links.values():
            names = "; ".join(f"{link.class_name} {link.name}" for link in linked.links)
            console.data(f"  {linked.element} {linked.id} is linked with {names}")
    for other in survey["models"]:
        if not is_one_of(other, models):
            counts = ", ".join(f"{number} {what}" for what, number in other["counts"].items())
            console.data(f"{other['kind']} {other['name']} ({counts}); no monitor yet")
