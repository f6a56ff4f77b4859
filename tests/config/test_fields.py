import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.config.field_paths import FieldPathError, expression, parse_field, pattern
from tests.data_files import tabled


@tabled
def test_expressions(text: str, code: str) -> None:
    assert expression("m", parse_field(text)) == code


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("scan.ranges[*]", ".scan .ranges []"),
        ("a[2..5].b", ".a [] .b"),
        ("a[*].b[c].d[0]", ".a [] .b [] .d []"),
    ],
)
def test_lists_are_for_reductions_only(text: str, parts: str) -> None:
    assert pattern(parse_field(text, lists=True)) == parts.split()
    with pytest.raises(FieldPathError, match="is a list, one value is expected") as refused:
        parse_field(text)
    assert "condition" in (refused.value.hint or "")


@tabled
def test_what_is_no_path(text: str, reason: str) -> None:
    with pytest.raises(FieldPathError) as failure:
        parse_field(text)
    assert reason in f"{failure.value} {failure.value.hint}"


@given(
    st.text(alphabet=st.sampled_from("ab0.[]()'\"\\_ \n{}:=,"), max_size=12) | st.text(max_size=8)
)
def test_no_text_becomes_more_than_lookups(text: str) -> None:
    try:
        code = expression("m", parse_field(text))
    except FieldPathError:
        return
    allowed = (ast.Attribute, ast.Subscript, ast.Call, ast.Name, ast.Constant, ast.Load)
    for node in ast.walk(ast.parse(code, mode="eval").body):
        assert isinstance(node, allowed)
        if isinstance(node, ast.Call):
            assert isinstance(node.func, ast.Name)
            assert node.func.id in {"by_id", "by_key"}
        if isinstance(node, ast.Name):
            assert node.id in {"m", "by_id", "by_key"}
