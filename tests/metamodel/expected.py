"""EDDIs of the public metamodel of SESAME, and what each of them must give."""

from functools import cache
from pathlib import Path
from typing import Any

import yaml

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import Model, ReadResult
from eddi_scaffold.monitors.loading import checked_models, read_models
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


def changed(path: Path, *pairs: tuple[str, str]) -> ReadResult:
    """Return what is read of a file in which texts, each of them once there, are replaced."""
    text = path.read_text("utf-8")
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return read_models(Source(path.name, text.encode()))


def models(file: str) -> tuple[Model, ...]:
    """Return the models of one of the files, which has no error."""
    return tuple(checked_models(FOLDER / file).models)
