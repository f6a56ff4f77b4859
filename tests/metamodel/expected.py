"""EDDIs of the public metamodel of SESAME, and what each of them must give."""

from functools import cache
from typing import Any

import yaml

from eddi_scaffold.kinds import Model
from eddi_scaffold.monitors.loading import checked_models
from tests.data_files import ORACLES

FOLDER = ORACLES / "metamodel"


@cache
def expected() -> dict[str, Any]:
    return dict(yaml.load((FOLDER / "expected.yml").read_text("utf-8"), yaml.CSafeLoader))


def cases(kind: str) -> list[tuple[str, dict[str, Any]]]:
    return [
        (file, model)
        for file, case in expected().items()
        for model in case["read"]
        if model["kind"] == kind
    ]


def models(file: str) -> tuple[Model, ...]:
    """Return the models of one of the files, which has no error."""
    return tuple(checked_models(FOLDER / file).models)
