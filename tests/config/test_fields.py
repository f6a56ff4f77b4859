import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.config.field_paths import (
    Attribute,
    ByKey,
    FieldPathError,
    Index,
    expression,
    parse_field,
    path_text,
)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("data", "m.data"),
        ("pose.position.x", "m.pose.position.x"),
        ("items[0]", "m.items[0]"),
        ("items[12].value", "m.items[12].value"),
        ("guarantees[G0].active", "by_id(m.guarantees, 'G0').active"),
        ("a[b][1].c", "by_id(m.a, 'b')[1].c"),
        ("a[it's]", 'by_id(m.a, "it\'s")'),
        ("a[ä]", "by_id(m.a, '\\xe4')"),
        ("a[-1]", "by_id(m.a, '-1')"),
        ("a[1234567]", "by_id(m.a, '1234567')"),
        ('a["b.c]"].d', "by_id(m.a, 'b.c]').d"),
        ("a[title=b]", "by_key(m.a, 'title', 'b')"),
        ("a[id=3].x", "by_id(m.a, 3).x"),
    ],
)
def test_expressions(text: str, code: str) -> None:
    assert expression("m", parse_field(text)) == code


def test_steps() -> None:
    assert parse_field("a[0][b].c") == (Attribute("a"), Index(0), ByKey("b"), Attribute("c"))
    assert parse_field('a[k="x y"]') == (Attribute("a"), ByKey("x y", "k"))
    assert parse_field("a[id=3]") == (Attribute("a"), ByKey(3, "id"))
    assert parse_field("a[header.frame_id=map]")[1] == ByKey("map", "header.frame_id")
    assert parse_field('a["12"]')[1] == ByKey("12")


@pytest.mark.parametrize("text", ["scan.ranges[*]", "a[2..5].b", "a[*].b[c].d[0]"])
def test_lists_are_for_reductions_only(text: str) -> None:
    assert path_text(parse_field(text, lists=True)) == text
    with pytest.raises(FieldPathError, match="is a list, `field:` takes one value") as refused:
        parse_field(text)
    assert "expression" in (refused.value.hint or "")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "the path is empty"),
        (".a", "column 1 of '.a'"),
        ("a.", "column 2 of 'a.'"),
        ("a..b", "column 2 of 'a..b'"),
        ("a b", "column 2 of 'a b'"),
        ("a[0]b", "column 5 of 'a[0]b'"),
        ("a[]", "column 2 of 'a[]'"),
        ("a[0", "column 2 of 'a[0'"),
        ("[0]", "a path begins with a field name"),
        ("a()", "column 2 of 'a()'"),
        ("__class__", "column 1 of '__class__'"),
        ("a.__dict__", "column 2 of 'a.__dict__'"),
        ("a.import", "'import' cannot be the name of a field"),
        ("a[x\ny]", "column 2"),
    ],
)
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
    assert parse_field(path_text(parse_field(text))) == parse_field(text)
