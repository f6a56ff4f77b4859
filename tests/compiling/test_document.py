"""What a model file must be: everything else is refused with path and reason."""

import contextlib
import copy
import json

import pytest
from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import (
    RESERVED_ATTRIBUTES,
    ModelError,
    canonical,
    check_document,
    parse_model,
)
from eddi_scaffold.compiling.execution import build
from runtime_lib.tests.conserts import categorical, document, numeric, signed


def good():
    return document(
        [("x", numeric("[0, 5)")), ("y", categorical("a")), "z"],
        ["d"],
        gates=["g&"],
        guarantees=["G"],
        edges=["x>g", "y>g", "z>g", "d>g", "g>G"],
        services=[("S", ["G"])],
        specs={"x": {"factor": [5, 18], "max_age": 0.5}, "z": {"max_age": "none"}},
    )


def test_what_is_no_model_file():
    for text in ("", "[" * 100_000, "{}", "[]", "null", '{"format": NaN}'):
        with pytest.raises(ModelError) as caught:
            parse_model(text, "model.json")
        assert str(caught.value).startswith("model.json: ")


def test_every_changed_byte_of_content_is_found():
    text = canonical(good())
    for k in range(0, len(text), 7):
        changed = text[:k] + ("X" if text[k] != "X" else "Y") + text[k + 1 :]
        with pytest.raises(ModelError):
            build(parse_model(changed))


def test_an_unknown_kind_is_refused():
    with pytest.raises(ModelError, match="the kind 'os' is not known"):
        compile_model(check_document(signed(dict(good(), kind="os"))))


def change(path, value):
    data = copy.deepcopy(good())
    item = data
    for key in path[:-1]:
        item = item[key]
    if value is KeyError:
        del item[path[-1]]
    else:
        item[path[-1]] = value
    return signed(data)


M = "model"
WRONG = [
    (("inputs", 0, "attribute"), "states", "cannot be held in an attribute 'states'"),
    (("inputs", 0, "attribute"), "", "cannot be held"),
    (("inputs", 0, "attribute"), "y", "two inputs have the attribute 'y'"),
    (("inputs", 0, "id"), "y", "two inputs have the id 'y'"),
    (("inputs", 0, "id"), "q", "'x' of 'evidence' has no entry in 'inputs'"),
    (("inputs", 0, "max_age"), 0, "'max_age' of input 'x'"),
    (("inputs", 0, "max_age"), True, "'max_age' of input 'x'"),
    (("inputs", 0, "factor"), [1, 0], "'factor' of input 'x'"),
    (("inputs", 0, "factor"), 3.6, "'factor' of input 'x'"),
    (("inputs", 1, "factor"), [1, 2], "input 'y' has a factor but is not numeric"),
    (("inputs", 0, "requires"), "ab", "'requires' of input 'x' has the wrong type str"),
    ((M, "gates", 0, "function"), "Not", "gate 'g' has the unknown function 'Not'"),
    ((M, "gates", 0, "id"), "x", "two elements have the id 'x'"),
    ((M, "edges", 0), ["x"], "an element of 'edges' is not a pair of ids"),
    ((M, "edges", 0), ["nix", "g"], "an edge names 'nix', which does not exist"),
    ((M, "edges", 0), ["g", "x"], "an edge leads into 'x', which is evidence or a demand"),
    ((M, "edges", 0), ["G", "g"], "the edges close a cycle"),
    ((M, "edges", 0), ["g", "g"], "the edges close a cycle"),
    ((M, "edges", 4), ["x", "g"], "constant without being meant as default: 'G'"),
    ((M, "guarantees", 0, "default"), True, "constant without being meant as default: 'G'"),
    ((M, "guarantees", 0, "default"), 1, "'default' of guarantee 'G' has the wrong type"),
    ((M, "guarantees", 0, "ranking"), 1.5, "'ranking' of guarantee 'G' has the wrong type"),
    ((M, "evidence", 1, "dimension", "kind"), "odd", "the unknown kind 'odd'"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), "nan", "is not a decimal number"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), "1_0", "is not a decimal number"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), "1/3", "is not a decimal number"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), "9" * 1001, "not a decimal number"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), 1, "has the wrong type int"),
    ((M, "evidence", 0, "dimension", "covered", 0, "start"), "7", "starts above its end"),
    ((M, "evidence", 1, "dimension", "covered"), [1], "'covered' of 'y' is not a list of texts"),
    ((M, "provided_services", 0, "guarantees"), ["H"], "names 'H', which does not exist"),
    (("settings", "guarantee_ids"), "both", "guarantee_ids 'both'"),
    ((M, "evidence"), KeyError, "the model has no 'evidence'"),
    ((M,), [], "'model' of the model file has the wrong type list"),
    (("format",), 2, "format 2 is not known, only 1"),
    (("format",), True, "wrong type bool"),
]


@pytest.mark.parametrize("row", range(len(WRONG)))
def test_wrong_content_is_refused_with_the_reason(row):
    path, value, reason = WRONG[row]
    with pytest.raises(ModelError) as caught:
        build(check_document(change(path, value), "model.json"))
    assert reason in caught.value.reason
    assert str(caught.value).startswith("model.json: ")


def test_any_value_anywhere_gives_a_model_or_a_model_error():
    def places(item, path=()):
        yield path
        if isinstance(item, (dict, list)):
            for key in item if isinstance(item, dict) else range(len(item)):
                yield from places(item[key], (*path, key))

    for path in list(places(good()))[1:]:
        for value in (None, True, 0, -1, 1.5, "", "x", [], {}, [[]], [{}], 10**400, KeyError):
            with contextlib.suppress(ModelError):  # most are refused, some are fine
                build(check_document(change(path, value)))


def test_extreme_bounds_are_doubles():
    for text in ("1e999999999", "-1e999999999", "1e-999999999", "0e999999999", "+.5", "5."):
        low = text if text.startswith("-") else "-inf"
        build(
            check_document(
                document(
                    [("x", numeric(f"[{low}, {text}]"))],
                    guarantees=["G"],
                    edges=["x>G"],
                    specs={"x": {"factor": [1, 3]}},
                )
            )
        )


def test_canonical_text_survives_json():
    assert json.loads(canonical(good())) == good()
    assert canonical(good()).isascii()


def test_files_of_a_model_in_memory():
    found = check_document(good(), data={"rows.npy": b"rows"})
    assert found.data("rows.npy") == b"rows"
    with pytest.raises(ModelError, match=r"the file 'gone\.npy' that belongs to the model is not"):
        found.data("gone.npy")


def test_another_format_is_refused():
    with pytest.raises(ModelError, match="format 2 is not known, only 1"):
        check_document(signed(dict(good(), format=2)))


def test_what_json_cannot_hold_is_damage():
    data = dict(good(), settings={"deep": float("nan")})
    with pytest.raises(ModelError, match="the file is damaged"):
        check_document(data)


@pytest.mark.parametrize("names", [None, [], {"a": ["message"]}, {"a": ["topic", "a"]}])
def test_an_expression_says_what_its_words_mean(names):
    with pytest.raises(ModelError, match=r"'expression' of .* has no 'names'"):
        check_document(signed(change(["inputs", 0, "expression"], {"names": names})))


def test_no_input_hides_a_member_of_the_base_class():
    members = {name for name in dir(EDDIInputBase) if not name.startswith("_")}
    assert RESERVED_ATTRIBUTES - {"processing", "states"} == members
