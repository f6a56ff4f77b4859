"""What the commands print about each file: nothing is lost in silence, and nothing cries wolf."""

from __future__ import annotations

import re

import pytest

from tests.cli.command import run
from tests.metamodel.expected import FOLDER, expected

WRONG = re.compile(r"\[(X008|X010|X011|X015|X017|R016)\]")
SEVERE = re.compile(r": (warning|error): ")


def printed(file: str, kinds: set[str]) -> str:
    commands = [["check", "--verbose"], ["show", "--verbose"]]
    commands += [["compose"]] if kinds == {"consert"} else []
    results = [run(*command, file, cwd=FOLDER) for command in commands]
    return "\n".join(result.out + result.err for result in results)


@pytest.mark.parametrize("file", list(expected()))
def test_what_is_said_of_each_file(file: str) -> None:
    case = expected()[file]
    text = printed(file, {model["kind"] for model in case["read"]})
    assert not WRONG.search(text)
    severe = [one for one in case.get("say", ()) if one.get("severity") == "error"]
    assert (": error: " in text) == bool(severe)
    for one in case.get("say", ()):
        assert all(word in text for word in one["words"]), one
        if "severity" in one:
            said = [line for line in text.splitlines() if SEVERE.search(line)]
            assert any(all(word in line for word in one["words"]) for line in said), one
    for model in case["read"]:
        assert not re.search(rf"{re.escape(model['name'])}[^\n]* not read", text)
