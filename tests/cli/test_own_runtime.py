"""In a terminal that has sourced a workspace, PYTHONPATH leads to the workspace's runtime."""

import os
import subprocess
import sys
from pathlib import Path

from tests.cli.command import EXAMPLE

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
