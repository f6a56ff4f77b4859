"""What the formatter and the linter of this project have against a text."""

import ast
import subprocess
import sys

from eddi_scaffold.program.python_text import WIDTH

HOSTILE = ['"""', "\\", "\n", "__import__('os')", "class", "self", "é", "\ud800", "x" * 500, "#"]
"""Names that want to be code."""


def assert_plain_data(text: str) -> None:
    """Assert that a text is what formatters leave as it is, for Python 3.8, without own code.

    Behind its first line, which other formatters would part from the rest.
    """
    assert objections(text.partition("\n")[2]) == ""
    tree = ast.parse(text, feature_version=(3, 8))
    assert text.isascii()
    assert "__import__" not in {one.id for one in ast.walk(tree) if isinstance(one, ast.Name)}


def objections(text: str) -> str:
    """Return what they print, empty when both agree."""
    found = ""
    for words in (("format", "--diff", "--line-length", str(WIDTH)), ("check", "--select", "F,E9")):
        command = [sys.executable, "-m", "ruff", *words, "--isolated", "--quiet"]
        command += ["--stdin-filename", "compiled.py", "-"]
        done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
        assert done.returncode in (0, 1), done.stderr
        found += done.stdout
    return found
