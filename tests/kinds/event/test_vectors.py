"""Vectors of events: every mutant of a package is killed, or ``verify`` sees it."""

import json
from pathlib import Path

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.monitors.answers import VECTORS, files_of
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.packages.verifying import checked
from tests.checkouts import HERE
from tests.conditions.test_agreement import batches, text_of
from tests.evidence.mutants import Mutated, input_class, mutants


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_each_mutant_is_killed_or_verify_sees_it(tmp_path: Path) -> None:
    monitors, _ = monitors_of(None, [HERE / "examples" / "warehouse-robot" / "robot.yml"])
    lidar = next(monitor for monitor in monitors if monitor.id == "lidar")
    mutated, kills = Mutated(lidar, tmp_path), 0
    for text in mutants(mutated.body):
        is_killed, _ = mutated.killed(text)
        kills += is_killed
        assert is_killed or checked(lidar, f"{mutated.head}\n{text}")[1] != [], text
    assert kills >= 115


def test_random_events_pass(tmp_path: Path) -> None:
    for seed in range(3 * batches()):
        file = tmp_path / f"e{seed}.events"
        file.write_text(text_of(seed, count=2))
        files = files_of(monitors_of(file, [])[0][0])
        scope = {"__name__": "compiled", "__file__": "no file"}
        exec(files["compiled.py"].decode(), scope)
        vectors = tmp_path / "vectors.json"
        vectors.write_bytes(files[VECTORS])
        assert json.loads(files[VECTORS])["runs"]
        assert failures(str(vectors), scope["Monitor"], input_class(scope["Monitor"])) == []
