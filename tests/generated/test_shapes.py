"""What the shapes of answers let through is a name, a literal or a text of its language."""

from __future__ import annotations

import ast
import re
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jinja2 import Environment, FileSystemLoader

from eddi_scaffold.common import escaping
from eddi_scaffold.common.identifiers import RESERVED, is_package_name
from eddi_scaffold.regions import markers
from tests.checkouts import HERE
from tests.fuzz.test_names_are_no_code import shown
from tests.test_escaping import texts

SHAPES = (
    Environment(
        loader=FileSystemLoader(HERE),
        extensions=["jinja2_ansible_filters.AnsibleCoreFiltersExtension"],
    )
    .get_template("copier_templates/shapes.jinja")
    .module
)
MARKUP = {"html_block", "html_inline", "link_open", "image"}


def shape_of(name: str) -> str:
    shape: str = vars(SHAPES)[name]
    return shape


def fits(text: str, shape: str) -> bool:
    return re.fullmatch(shape_of(shape), text) is not None


def any_of(shape: str) -> st.SearchStrategy[str]:
    return st.from_regex(shape_of(shape), fullmatch=True)


@given(text=texts)
def test_what_is_escaped_fits(text: str) -> None:
    assert fits(escaping.one_line(text), "LINE")
    assert fits(escaping.python_comment(text), "DOCSTRING")
    assert fits(escaping.python_literal(text), "TEXT")
    assert fits(escaping.python_literal((text,)), "TEXTS")
    assert fits(escaping.python_literal((text, text)), "TEXTS")
    assert fits(escaping.toml_text(text), "TOML_TEXT")
    assert fits(escaping.markdown_text(text), "MARKDOWN")
    assert fits(escaping.markdown_code(text), "CODE")
    line = f"- {escaping.markdown_text(text)}, `{escaping.markdown_code(text)}`"
    assert fits(line, "MARKDOWN_LINE")
    if text:
        name = markers.encode_id(text)
        tail = markers.tail_of(markers.Digests(uses="12345678"), [text, text])
        assert fits(f"{name}{tail}", "REGION")


@pytest.mark.parametrize("value", [None, True, 0, -1, 1e300, 5e-324, 0.1, "", "a'\"\\\n\U0001f916"])
def test_values_of_python_fit(value: object) -> None:
    assert fits(escaping.python_literal(value), "LITERAL")


@given(text=any_of("TEXT"), value=any_of("LITERAL"), several=any_of("TEXTS"))
def test_a_literal_is_nothing_else(text: str, value: str, several: str) -> None:
    assert isinstance(ast.literal_eval(text), str)
    if not re.fullmatch(r"-?0[0-9]+", value):  # 007 is no number of Python
        assert not isinstance(ast.literal_eval(value), tuple)
    assert isinstance(ast.literal_eval(several), tuple)


@given(line=any_of("LINE"), text=any_of("DOCSTRING"), region=any_of("REGION"))
def test_comments_and_markers_are_no_statements(line: str, text: str, region: str) -> None:
    (only,) = ast.parse(f'"""The {text}."""  # {line}').body
    assert isinstance(only, ast.Expr)
    (marker,) = ast.parse(f"'''-----Manual edit begin-----'''  # region: {region}").body
    assert isinstance(marker, ast.Expr)
    assert isinstance(marker.value, ast.Constant)


@pytest.mark.parametrize("shape", ["LINE", "DOCSTRING", "MARKDOWN_LINE", "MARKDOWN", "CODE"])
def test_no_text_is_a_marker_of_a_region(shape: str) -> None:
    text = "-----Manual edit begin-----"
    assert not fits(text, shape)
    assert fits(escaping.python_comment(text), shape)


@given(expression=any_of("TAKEN"))
def test_what_is_taken_calls_helpers_only(expression: str) -> None:
    try:
        tree = ast.parse(expression)
    except SyntaxError:
        return  # brackets that do not fit
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            assert isinstance(node.func, ast.Name)
            assert node.func.id == "given" or node.func.id.startswith("by_")


@given(lines=st.lists(any_of("MARKDOWN_LINE")), text=any_of("MARKDOWN"), code=any_of("CODE"))
def test_markdown_shows_no_markup(lines: list[str], text: str, code: str) -> None:
    document = "\n".join([*lines, "", "", "| a | b |", "|---|---|", f"| `{code}` | {text} |"])
    assert not MARKUP & set(shown(document.encode("utf-8", "replace")))


@pytest.mark.parametrize("word", [*sorted(RESERVED), "__import__", "__class__", "a b", "ä", ""])
def test_words_of_python_are_no_names(word: str) -> None:
    assert not fits(word, "NAME")


@pytest.mark.parametrize("word", ["sitecustomize", "usercustomize", "os", "json", "class", "a"])
def test_names_that_hide_others_are_no_packages(word: str) -> None:
    assert not fits(word, "PACKAGE")


def test_the_modules_of_python_are_known() -> None:
    known = set(shape_of("MODULES").split("|"))
    assert known - {"sitecustomize", "usercustomize"} <= sys.stdlib_module_names
    young = {"tomllib", "annotationlib", "compression", "imp"}
    ours = {name for name in sys.stdlib_module_names if is_package_name(name)}
    assert len(ours - known - young) <= 30, "modules that later versions do not have any more"
