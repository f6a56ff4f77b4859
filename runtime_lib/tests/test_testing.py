"""The public helpers for tests of monitors, and a runtime copied under another name."""

import shutil
import subprocess
import sys
from pathlib import Path

import eddi_runtime
import pytest
from eddi_runtime.testing import FakeClock, inputs, script

from runtime_lib.tests.conserts import GOOD, active, consert, nested


def test_scripted_inputs():
    made = nested()
    assert [active(rows) for rows in script(made, [{}, GOOD, {"d": True}])] == [[], ["G"], ["G"]]
    with pytest.raises(LookupError, match="no input q; there: a, b, c, n, d"):
        inputs(made, {"q": 1})


def test_the_clock_stands_still():
    clock = FakeClock(5.0)
    clock.advance(0.5)
    assert clock() == clock() == 5.5


def test_a_copy_inside_of_a_package_works(tmp_path):
    """A plain package carries the runtime inside: nothing in it may know its own name."""
    package = tmp_path / "carrier"
    shutil.copytree(
        Path(eddi_runtime.__file__).parent,
        package / "eddi_runtime",
        ignore=shutil.ignore_patterns("node", "transports", "__pycache__"),
    )
    (package / "__init__.py").write_text("")
    model = consert(["e"], guarantees=["G"], edges=["e>G"])
    text = model.text().replace("import eddi_runtime\n", "from . import eddi_runtime\n", 1)
    text = text.replace("\nfrom eddi_runtime", "\nfrom .eddi_runtime")
    (package / "compiled.py").write_text(text)
    code = (
        "import sys; from carrier.compiled import Monitor; m = Monitor();"
        "assert Monitor.__mro__[1].__module__ == 'carrier.eddi_runtime.consert.monitor';"
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
