"""Packages that all monitors of a workspace share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_scaffold import __version__
from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import ModelError, parse_model
from eddi_scaffold.compiling.parts import LIFE_CYCLE, PEERS, needed_by, with_needed
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import identity_answers
from eddi_scaffold.problems import EddiError, Place, error

_RELEASE = ".".join(__version__.split(".")[:3])
"""Version of these packages: they come with the generator."""
_MAINTAINED = ("maintainer_name", "maintainer_email", "license")


def package_answers(
    template: str,
    name: str,
    description: str,
    monitors: Mapping[str, Mapping[str, JsonValue]],
    /,
    **more: JsonValue,
) -> dict[str, JsonValue]:
    """Return the answers of one such package.

    Args:
        template: of it.
        name: of the package.
        description: one sentence.
        monitors: package -> answers of those that share it: the first one by its name that says
            who maintains it, says so of this one too.
        more: answers that only this template asks for.
    """
    answers = {"template": template, **identity_answers(name, description, None), **more}
    answers["package_version"], nobody = _RELEASE, answers["maintainer_email"]
    for package in sorted(monitors, reverse=True):
        said = {key: monitors[package][key] for key in _MAINTAINED if key in monitors[package]}
        answers |= said if said.get("maintainer_email") != nobody else {}
    return answers


def runtime_parts(monitors: Mapping[str, Mapping[str, JsonValue]]) -> set[str]:
    """Return the parts of the runtime that monitors need.

    Args:
        monitors: package -> its answers.

    Raises:
        EddiError: a model cannot be compiled (K028).
    """
    return {part for name, answers in monitors.items() for part in _parts(name, answers)}


def _parts(package: str, answers: Mapping[str, JsonValue]) -> Sequence[str]:
    try:
        needed = needed_by(compile_model(parse_model(str(answers["model_json"]))))
    except ModelError as refused:
        raise EddiError(error("K028", refused.reason, Place(package))) from None
    asked = {"fleet": PEERS, "lifecycle": LIFE_CYCLE}
    return with_needed([*needed, *(part for name, part in asked.items() if answers.get(name))])
