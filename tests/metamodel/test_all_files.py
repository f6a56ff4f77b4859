"""What the commands print about each file: nothing is lost in silence, and nothing cries wolf."""

import re

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.parsing import XMI
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import run
from tests.metamodel.expected import FOLDER, expected
from tests.metamodel.test_random import NOT_THESE

WRONG = re.compile(r"\[(X010|X011)\]")
KINDS = {
    "consert": "consert",
    "bayesian_network": "bayesian_network",
    "fault_tree": "reliability",
    "markov_chain": "reliability",
    "state_machine": "",
}
"""Kind of a model in an EDDI -> that of its monitor; a machine has none yet."""
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
    if case["read"]:
        reading = read_models(read_source(FOLDER / file))
        checked = [model.check() for model in reading.models]
        problems = [*reading.problems, *(problem for of in checked for problem in of)]
        assert not {problem.case for problem in problems} & NOT_THESE
    severe = [one for one in case.get("say", ()) if one.get("severity") == "error"]
    assert (": error: " in text) == bool(severe)
    for one in case.get("say", ()):
        assert all(word in text for word in one["words"]), one
        if "severity" in one:
            said = [line for line in text.splitlines() if SEVERE.search(line)]
            assert any(all(word in line for word in one["words"]) for line in said), one
    wanted = [(KINDS[one["kind"]], one["name"]) for one in case["read"]]
    found = read_models(read_source(FOLDER / file)).models if wanted else ()
    in_order = sorted((model.place.line or 0, model.kind, model.name) for model in found)
    assert [(kind, name) for _, kind, name in in_order] == [one for one in wanted if one[0]]
    document, _ = read_document(read_source(FOLDER / file))
    assert document is not None
    every = list(document.document.iter())
    beside = [one for one in every if one.tag == f"{{{XMI}}}XMI" or "href" in one.attrib]
    assert len(every) - len(beside) == case["objects"]
    for model in case["read"]:
        assert not re.search(rf"{re.escape(model['name'])}[^\n]* not read", text)
