"""The public helpers for tests of monitors, and a runtime copied under another name."""

import shutil
import subprocess
import sys
from pathlib import Path

import eddi_runtime
import pytest
from eddi_runtime.model_file import canonical
from eddi_runtime.testing import FakeClock, inputs, script

from runtime_lib.tests.documents import GOOD, active, document, nested


def test_scripted_inputs():
    made = nested()
    assert [active(rows) for rows in script(made, [{}, GOOD, {"d": True}])] == [[], ["G"], ["G"]]
    with pytest.raises(LookupError, match="no input q; there: a, b, c, n, d"):
        inputs(made, {"q": 1})


def test_the_clock_stands_still():
    clock = FakeClock(5.0)
    clock.advance(0.5)
    assert clock() == clock() == 5.5


def test_a_copy_under_another_name_works(tmp_path):
    """A plain package carries the runtime inside: nothing in it may know its own name."""
    package = tmp_path / "carrier"
    shutil.copytree(
        Path(eddi_runtime.__file__).parent,
        package / "inner",
        ignore=shutil.ignore_patterns("node", "transports", "ros1.py", "__pycache__"),
    )
    (package / "__init__.py").write_text("")
    model = document(["e"], guarantees=["G"], edges=["e>G"])
    (tmp_path / "model.json").write_text(canonical(model))
    code = (
        "import sys, carrier.inner as r; m = r.load('model.json'); class_ = type(m);"
        "assert class_.__module__ == 'carrier.inner.consert.monitor';"
        "x = type('X', (), {'e': True})(); print(m.execute_step(x), m.explain('G').text());"
        "assert not {'eddi_runtime', 'numpy', 'rospy'} & set(sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        cwd=tmp_path,
        check=True,
        capture_output=True,
        text=True,
        env={},
    )
    assert done.stdout.startswith("[{'id': 'G', 'active': True}] G is active")
