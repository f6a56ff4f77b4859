"""Refuse answers that a person or a merge has damaged, before something is made of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eddi_scaffold.config.file import from_json
from eddi_scaffold.kinds import kinds
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.platforms import owner_of
from eddi_scaffold.problems import EddiError, Place, error

_OF_INPUTS = ("id", "attribute", "title", "sources", "region_begin")


def check_answers(package: Path, answers: Mapping[str, Any]) -> None:
    """Refuse the answers of a package that other code could not follow.

    Raises:
        EddiError: they are damaged (T005).
    """
    try:
        owner_of(str(answers["template"]))
        if "model_json" in answers:
            _check_monitor(answers, package.name)
    except (KeyError, TypeError, ValueError, RecursionError) as damage:
        reason = str(damage).partition("\n")[0]
        message = f"the answers of the package are damaged: {reason}"
        hint = "restore the file from git, or generate the package again"
        place = Place(str(package / ANSWERS_FILE))
        raise EddiError(error("T005", message, place, hint)) from None


def _check_monitor(answers: Mapping[str, Any], package: str) -> None:
    model_id(answers)
    kinds()[answers["kind"]]
    answers["model_file"]
    if answers.get("config_json"):
        from_json(answers["config_json"], package)
    for item in answers["inputs"]:
        for key in _OF_INPUTS:
            if not isinstance(item[key], str):
                raise TypeError(f"{key!r} of an input is not text")


def model_id(answers: Mapping[str, Any]) -> str:
    """Return the id of the model that a monitor package was generated from."""
    return str(json.loads(answers["model_json"])["id"])
