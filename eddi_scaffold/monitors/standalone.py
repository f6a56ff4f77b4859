"""Standalone monitors of models that are compiled to a program."""

from __future__ import annotations

from eddi_scaffold.compiling.compilation import program_of
from eddi_scaffold.compiling.document import parse_model
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.problems import EddiError, Problem, error, warning
from eddi_scaffold.targets import Target, printed
from eddi_scaffold.targets.monitor_model import named


def standalone(monitor: BoundMonitor, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor of a ConSert in C99.

    Args:
        monitor: what is monitored.
        target: the language.
        name: what files and functions begin with; any text.

    Raises:
        EddiError: there is none of this kind, or not in this language (E026).
    """
    model, kind = monitor.model, monitor.kind
    program = program_of(parse_model(monitor.model_json)) if target == "c" else None
    if program is None:
        message = f"there is no standalone monitor in {target} of the {kind.title} {model.name!r}"
        hint = "--target c takes ConSerts and files of events; generate makes packages of all kinds"
        raise EddiError(error("E026", message, model.place, hint))
    source = (f"{kind.title} {model.name}", f"{model.source.file_name} {model.place.path or ''}")
    return printed(named(program, name, source, kind=kind.name), target)


def without_limits(monitor: BoundMonitor) -> list[Problem]:
    """Report the inputs of a model without a configuration: no value of theirs gets old (K017)."""
    names = [binding.model.id for binding in monitor.inputs if binding.max_age is None]
    if monitor.config is not None or not names:
        return []
    message = f"{', '.join(names)}: no max_age, so a value stays as it was if its source dies"
    hint = "give the configuration with the `max_age` of each input: -c CONFIG"
    return [warning("K017", message, monitor.model.place, hint)]
