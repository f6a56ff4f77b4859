"""The readers on real files, on damaged ones, and on everything that either dialect may hold."""

import json
from typing import Any

import pytest

from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.show import failure_json, model_json, model_tree, system_json, system_tree
from tests.data_files import data_file, data_text

WORDS = {"M004": "surplus-brace", "M005": "unknown-key"}
"""The oracles name problems by words, as this project did before they had codes."""


def read(data: bytes | str, name: str) -> dict[str, Any]:
    try:
        if name.endswith("rossystem"):
            return system_json(read_rossystem(data, name))
        return model_json(read_ros_models(data, name))
    except MrosSyntaxError as failed:
        return failure_json(failed)


def test_every_file_of_the_corpus() -> None:
    corpus = data_file("mros/corpus")
    lines = data_file("mros/golden.jsonl").read_text("utf-8").splitlines()
    different = []
    for line in lines:
        expected = json.loads(line)
        name = expected.pop("file")
        actual = read((corpus / name).read_bytes(), name)
        expected.pop("msg", None)
        actual.pop("msg", None)
        for row in actual.get("warnings", []):
            row[2] = WORDS[row[2]]
        if actual != expected:
            different.append(name)
    assert (different, len(lines)) == ([], 552)


def test_the_errors_of_damaged_texts() -> None:
    different: list[str] = []
    for line in data_file("mros/errors.jsonl").read_text("utf-8").splitlines():
        case = json.loads(line)
        reader = read_rossystem if case["file"] == "rossystem" else read_ros_models
        try:
            problem = reader(case["text"], "damaged").problems[0]
        except MrosSyntaxError as failed:
            (problem,) = failed.problems
            lines = [*case["text"].split("\n"), ""]
            if problem.excerpt != lines[(problem.place.line or 1) - 1]:
                different.append(case["name"])
        assert (problem.place.line, problem.place.col) == (case["line"], case["col"]), case["name"]
        for word in case["mention"]:
            assert word in problem.message, case["name"]
    assert not different


SYSTEM = data_text("mros/braces.rossystem")
SYSTEM_TREE = data_text("mros/braces_system_tree.txt")
MODEL = data_text("mros/braces.ros2")
MODEL_TREE = data_text("mros/braces_model_tree.txt")
INDENT_SYSTEM = data_text("mros/indent.rossystem")
INDENT_SYSTEM_TREE = data_text("mros/indent_system_tree.txt")
INDENT_MODEL = data_text("mros/indent.ros2")
INDENT_MODEL_TREE = data_text("mros/indent_model_tree.txt")


@pytest.mark.parametrize(
    ("text", "tree"), [(SYSTEM, SYSTEM_TREE), (INDENT_SYSTEM, INDENT_SYSTEM_TREE)]
)
def test_systems(text: str, tree: str) -> None:
    assert "\n".join(system_tree(read_rossystem(text))) == tree


@pytest.mark.parametrize(("text", "tree"), [(MODEL, MODEL_TREE), (INDENT_MODEL, INDENT_MODEL_TREE)])
def test_models(text: str, tree: str) -> None:
    model = read_ros_models(text)
    assert "\n".join(model_tree(model)) == tree
    problems = [(problem.case, problem.place.line, problem.place.col) for problem in model.problems]
    assert problems == ([("M004.brace", 11, 27)] if model.dialect == "brace" else [])


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (SYSTEM, "RosComponentStacks (", "RosComponentStacks s", "expected '(' or '{'"),
        (SYSTEM, "QualityAttributes {", "QualityAttributes high {", "expected '{', found 'high'"),
        (SYSTEM, "[ c ]", "[ c }", "']' (it closes the '[' of line 16, column 33), found '}'"),
        (SYSTEM, "RosParameter r {", "Parameter r {", "expected 'RosParameter', found"),
        (SYSTEM, "value 3 [", "value 3 ) [", "(it closes the '{' of line 2, column 26), found ')'"),
        (MODEL, "bool[] ok", "bool[ ok", "expected ']'"),
        (MODEL, "default { 3 }", "default { '3", "never closed"),
        (INDENT_MODEL, "type: p/action/Go", "type:", "expected the type of 'go' behind 'type:'"),
        (INDENT_MODEL, "type: p/action/Go", "", "the interface 'go' has no 'type:'"),
        (INDENT_MODEL, "      request\n", "      question\n", "expected message, request"),
        (INDENT_MODEL, "uint8[4] raw", "uint8[4 raw", "this '[' is never closed"),
        (INDENT_MODEL, "flags: [bool]", "flags: [bool", "this '[' is never closed"),
        (INDENT_MODEL, "int8 N= 3", "int8 N=", "expected the value of N, found end of line"),
        (INDENT_SYSTEM, "  base:", "  base", "the name of a node followed by :, found 'base'"),
        (INDENT_SYSTEM, '"p.base"', '"p.\nbase"', "ends on its line: this quote is not closed"),
        (INDENT_SYSTEM, 'fromPub: "p.x.n.s"', "", "and a reference behind 'old:'"),
    ],
)  # fmt: skip
def test_what_is_refused(text: str, old: str, new: str, message: str) -> None:
    assert old in text
    reader = read_rossystem if text in (SYSTEM, INDENT_SYSTEM) else read_ros_models
    with pytest.raises(MrosSyntaxError) as refused:
        reader(text.replace(old, new, 1))
    assert message in refused.value.problems[0].message


def test_bytes_that_are_no_text() -> None:
    with pytest.raises(MrosSyntaxError, match="byte 4 ") as refused:
        read_rossystem(b"a:\n \xff")
    place = refused.value.problems[0].place
    assert (place.line, place.col) == (2, 2)
