"""Monitors of random models pass their test vectors."""

from pathlib import Path

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled
from tests.conditions.test_agreement import batches
from tests.evidence.mutants import input_class
from tests.frozen.random_models import MAKERS


@pytest.mark.parametrize("kind", ["reliability", "safeml", "state_machine"])
def test_monitors_of_random_models_pass_their_vectors(kind: str, tmp_path: Path) -> None:
    for number in range(5 * batches()):
        folder = tmp_path / str(number)
        folder.mkdir()
        for name, text in MAKERS[kind](number).items():
            (folder / name).write_text(text)
        configs = [*folder.glob("*_config.yml")]
        monitor = monitors_of(None if configs else next(folder.iterdir()), configs)[0][0]
        text, class_ = monitor.model.vectors(monitor.bound, {}), type(compiled(monitor))
        (folder / "vectors.json").write_text(text)
        if text or kind != "reliability":  # of which those that are not covered have none
            assert failures(str(folder / "vectors.json"), class_, input_class(class_)) == [], number
