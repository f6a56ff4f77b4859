"""`--help` answers at once, ConSerts without numpy: what is heavy is imported where it is used."""

import json
import os
import subprocess
import sys

import pytest

from tests.cli.command import ROOT

HEAVY = {"copier", "lxml", "numpy", "pgmpy", "pydantic", "jinja2", "yaml", "rospkg", "catkin_pkg"}
PROGRAM = """
import json, sys
from eddi_scaffold.cli import main
sys.argv = ["eddi-scaffold", *sys.argv[1:]]
try:
    main()
except SystemExit:
    pass
print(json.dumps(sorted({name.partition(".")[0] for name in sys.modules})), file=sys.stderr)
"""


CONSERTS = str(ROOT / "examples" / "two-conserts" / "two_conserts.xml")
OF_TYPER = {"pydantic"}
"""What Typer itself imports as soon as it parses the arguments of a command."""


@pytest.mark.parametrize(
    ("words", "allowed"),
    [
        (["--help"], set()),
        (["--version"], set()),
        (["generate", "--help"], OF_TYPER),
        (["chek"], OF_TYPER),
        (["check", CONSERTS], {*OF_TYPER, "lxml", "rospkg", "yaml"}),
    ],
)
def test_nothing_heavy_is_imported_before_it_is_needed(words: list[str], allowed: set[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words],
        env={**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert set(json.loads(done.stderr.splitlines()[-1])) & HEAVY <= allowed
