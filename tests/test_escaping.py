"""Whatever a text says, it stays a text: asked of the parsers of each target."""

from __future__ import annotations

import ast
import re
from xml.etree import ElementTree as ET

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_it.token import Token

from eddi_scaffold.common import escaping
from tests.checkouts import HERE
from tests.hostile_texts import HOSTILE

texts = st.one_of(
    st.text(),
    st.sampled_from(HOSTILE),
    st.lists(st.sampled_from([*"`|\\<>[]()!*_~#-+=&.:1 \"'?/\n\t", "a", "é"])).map("".join),
)


@given(text=texts)
def test_python_literal(text: str) -> None:
    written = escaping.python_literal(text)
    assert ast.literal_eval(written) == text
    assert written.isascii()


@given(text=texts)
def test_python_comment(text: str) -> None:
    shown = escaping.python_comment(text)
    (only,) = ast.parse(f'"""{shown}."""  # {shown}').body
    assert isinstance(only, ast.Expr)
    assert ast.literal_eval(only.value) == f"{shown}."


@given(text=texts)
@example(text="???/")
def test_c_comment(text: str) -> None:
    shown = escaping.c_comment(text)
    assert not re.search(r"\*/|/\*|\?\?|\\|\"|[^ -~]", shown)


@given(text=texts)
def test_xml(text: str) -> None:
    written = escaping.xml_text(text)
    parsed = ET.fromstring(f'<a b="{written}">{written}</a>')
    kept = re.sub("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", text)
    assert (parsed.text or "", parsed.get("b")) == (kept, kept)


@given(text=texts)
def test_toml(text: str) -> None:
    tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")
    assert tomllib.loads(f"a = {escaping.toml_text(text)}")["a"] == escaping.one_line(text)


@given(text=texts)
@example(text="12345) one")
def test_markdown_text_shows_what_it_says(text: str) -> None:
    line = escaping.one_line(text)
    assert shown(escaping.markdown_text(text)) == [line] * bool(line)
    table = f"| a | b |\n|---|---|\n| {escaping.markdown_text(text)} | end |"
    assert shown(table) == ["a", "b", line, "end"]


@given(text=texts)
def test_markdown_code_shows_code(text: str) -> None:
    code = f"`{escaping.markdown_code(text)}`"
    line = escaping.one_line(text).replace("`", "'").replace("|", "¦") or " "
    assert shown(code) == [line]
    assert shown(f"| a | b |\n|---|---|\n| {code} | end |") == ["a", "b", line, "end"]


def test_one_module_escapes() -> None:
    """Console and page have languages of their own: a terminal's, and HTML."""
    texts = {path: path.read_text("utf-8") for path in (HERE / "eddi_scaffold").rglob("*.py")}
    ad_hoc = re.compile(r"saxutils|quoteattr|!a\}|&(amp|quot|lt);")
    assert {path.stem for path, text in texts.items() if ad_hoc.search(text)} == {"escaping"}


def shown(markdown: str) -> list[str]:
    """Return the text of each paragraph or cell; nothing in it may be more than text and code."""
    tokens = MarkdownIt("commonmark").enable("table").enable("strikethrough").parse(markdown)
    assert {token.type for token in tokens} <= PLAIN
    return ["".join(said(token)) for token in tokens if token.type == "inline"]


PLAIN = {"inline", "paragraph_open", "paragraph_close"} | {
    f"{part}_{end}"
    for part in ("table", "thead", "tbody", "tr", "th", "td")
    for end in ("open", "close")
}


def said(inline: Token) -> list[str]:
    parts = [child for child in inline.children or [] if child.content]
    assert {part.type for part in inline.children or []} <= {"text", "text_special", "code_inline"}
    return [part.content for part in parts]
