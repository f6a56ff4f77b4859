"""Every character of a scalar's value has its place in the file, except for blanks."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import Place
from eddi_scaffold.yaml_text.spans import inside_scalar


def scalar(text: str) -> tuple[str, Place]:
    """Return value and place of what stands behind ``key:``, as PyYAML has it."""
    (value,) = (node for _, node in yaml.compose(text).value)
    while not isinstance(value, yaml.ScalarNode):
        value = value.value[0] if isinstance(value.value[0], yaml.Node) else value.value[0][1]
    mark = value.start_mark
    return value.value, Place("f.yml", mark.line + 1, mark.column + 1)


def check(text: str) -> None:
    value, start = scalar(text)
    inside = inside_scalar(text, start, value)
    if ("\\" in text or "''" in text) and inside(len(value)) == start:
        return  # with escapes
    lines = [line.removesuffix("\r") for line in text.split("\n")]
    before = (0, 0)
    for offset, char in enumerate(value):
        place = inside(offset)
        assert place.line is not None
        assert place.col is not None
        assert (place.line, place.col) >= before, "places go forward"
        if char not in " \n":
            assert (place.line, place.col) > before
            assert lines[place.line - 1].startswith(char, place.col - 1)
            before = (place.line, place.col)


@pytest.mark.parametrize(
    "text",
    [
        "key: a b\n",
        "key: a\n\n  b\n  c\n",
        "key: 'a\n\n\n  b  \n  c'\n",
        'key: "a  \n\n  b"\n',
        "key: |\n  a\n\n  b\n",
        "key: |\n\n  a\n    b\n   \n  c",
        "key: >\n  a\n  b\n\n  c\n\n\n   more\n  d\n",
        "key: >-\n  a\n\n   more\n\n  b\n\n",
        "key: |2\n   a\n  b\n",
        "key:\n  - |1\n    a\n   b\n",
        "key:\n  - deep: >+1\n      a\n     b\n\n",
        "key: |\r\n  a\r\n\r\n  b\r\n",
    ],
)
def test_each_style(text: str) -> None:
    check(text)


@pytest.mark.parametrize("text", ["key: 'it''s'\n", 'key: "a\\x41 b"\n', 'key: "a\\\n  b"\n'])
def test_with_escapes_every_place_is_that_of_the_start(text: str) -> None:
    value, start = scalar(text)
    assert {inside_scalar(text, start, value)(k) for k in range(len(value) + 1)} == {start}


def test_what_stands_behind_the_value() -> None:
    for text, line, col in (("key: 'a b'\n", 1, 10), ("key: a b\n", 1, 9), ("key: |\n  a\n", 2, 4)):
        value, start = scalar(text)
        place = inside_scalar(text, start, value)(len(value.rstrip("\n")))
        assert (place.line, place.col) == (line, col)


_TEXTS = st.text("ab :#'\"\\\n é", max_size=40)


@given(_TEXTS, st.sampled_from([None, "'", '"', "|", ">"]), st.integers(4, 30), st.booleans())
def test_every_position_comes_back(value: str, style: str | None, width: int, nested: bool) -> None:
    data = {"key": [{"inner": value}]} if nested else {"key": value}
    text = yaml.dump(data, default_style=style, width=width, allow_unicode=True)
    if style is not None:
        text = text.replace(f"{style}key{style}", "key").replace(f"{style}inner{style}", "inner")
    assert scalar(text)[0] == value
    check(text)


@pytest.mark.parametrize("end", ["\r", "\r\n", "\u2028"])
def test_every_line_end_of_yaml_counts(end: str) -> None:
    text = f'a: {{b:{end}1}}\nkey: "xy"\n'
    start = Place("f.yml", 3, 6)
    assert inside_scalar(text, start, "xy")(1) == Place("f.yml", 3, 8)
