"""What is heavy is imported where it is used, and the runtime is our own, not the workspace's."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, ROOT

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


COMMANDS = f"""
import sys
from eddi_scaffold.cli import main

model, config = "{EXAMPLE}/two_conserts.xml", "{EXAMPLE}/consert_a_config.yml"
for words in (
    ["check", model, config],
    ["show", model],
    ["run", model, "-c", config, "--inputs", "{EXAMPLE}/recording.csv"],
):
    sys.argv = ["eddi-scaffold", *words]
    try:
        main()
    except SystemExit as end:
        assert end.code == 0, words
import eddi_runtime.transports.dds, eddi_scaffold.kinds.bayesian_network.cross_check
import of_the_workspace  # message classes, for watch
"""


def test_the_runtime_is_the_own_one_whatever_the_workspace_has(tmp_path: Path) -> None:
    (tmp_path / "eddi_runtime").mkdir()
    (tmp_path / "eddi_runtime/__init__.py").write_text("raise ImportError('of the workspace')\n")
    (tmp_path / "of_the_workspace.py").touch()
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    words = [sys.executable, "-c", COMMANDS]
    done = subprocess.run(
        words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
