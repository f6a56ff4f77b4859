from __future__ import annotations

from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.regions.marked_file import parse, split_lines
from eddi_scaffold.regions.markers import (
    begin_marker,
    decode_id,
    encode_id,
    end_marker,
    read_marker,
    with_sig,
)
from tests.fuzz.damage import watched

BEGIN, END = "'''-----Manual edit begin-----'''", "'''-----Manual edit end-----'''"


def one(text: str):
    document, faults = parse(text)
    assert not faults
    (region,) = document.regions.values()
    return region


@pytest.mark.parametrize("style", ["python", "xml", "hash"])
def test_written_form_is_read(style: str) -> None:
    begin = begin_marker("input:a b", style, ("input:old", "input:x,y"), "1a2b3c4d")
    region = one(f"  {begin}\nbody\n  {end_marker('input:a b', style)}\n")
    assert (region.id, region.was, region.sig) == (
        "input:a b",
        ("input:old", "input:x,y"),
        "1a2b3c4d",
    )
    assert (region.body, region.line, region.indent) == ("body\n", 1, "  ")


def test_written_form_of_python() -> None:
    text = begin_marker("input:RtE_A_E0", "python", (), "1a2b3c4d")
    assert text == f"{BEGIN}  # region: input:RtE_A_E0 sig: 1a2b3c4d"


@given(st.text(min_size=1), st.sampled_from(["python", "xml", "hash"]))
def test_any_id_travels(name: str, style: str) -> None:
    marker = begin_marker(f"node:{name}", style, (f"node:{name}2",))
    region = one(f"{marker}\n{end_marker(f'node:{name}', style)}\n")
    assert region.id == f"node:{name}"
    assert region.was == (f"node:{name}2",)
    assert decode_id(encode_id(name)) == name


@pytest.mark.parametrize("written", ["input:%E1", "input:%FFx%20", "%"])
def test_an_id_that_was_never_written_stays_as_it_is(written: str) -> None:
    assert one(f"{BEGIN}  # region: {written}\n{END}  # region: {written}\n").id == written


def test_xml_form_is_legal_xml() -> None:
    text = f"<a>{begin_marker('x:a--b---', 'xml')}{end_marker('x:a--b---', 'xml')}</a>"
    assert ET.fromstring(text).tag == "a"


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        (BEGIN, END),
        (
            "'''----------Manual edit begin----------'''",
            "'''----------Manual edit end----------'''",
        ),
        ('"""---Manual edit begin---"""', '"""---Manual edit end---"""'),
        ("# ----- Manual edit begin -----", "# ----- Manual edit end -----"),
        ("-----Manual edit begin-----", "-----Manual edit end-----"),
        ("'-----Manual edit begin-----'   ", "'-----Manual edit end-----'\t"),
    ],
)
def test_forms_without_id(begin: str, end: str) -> None:
    text = f"class C:\n    def f(self):\n        {begin}\n        x = 1\n        {end}\n"
    region = one(text)
    assert (region.id, region.explicit) == ("function:C.f", False)
    stripped = one(
        "\n".join(line.strip() if "Manual" in line else line for line in text.split("\n"))
    )
    assert stripped.id == "function:C.f"
    assert one(text.replace("\n", "\r\n")).body == "        x = 1\r\n"


def test_id_on_one_marker_is_enough() -> None:
    assert one(f"def f():\n  {BEGIN}\n  {END}  # region: a:b\n").id == "a:b"
    assert one(f"def f():\n  {BEGIN} # region: a:b\n  {END}\n").id == "a:b"


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        (f"{BEGIN}  # region: a\n{BEGIN}  # region: b\n{END}\n", 2, "is missing"),
        (f"x\n{END}  # region: a\n", 2, "without begin"),
        (f"x\n{BEGIN}  # region: a\n", 2, "no end marker"),
        (f"{BEGIN}  # region: a\n{END}\n{BEGIN}  # region: a\n{END}\n", 3, "second region 'a'"),
        (f"x = 1; {BEGIN}  # region: a\n{END}\n", 1, "alone on its line"),
        (f"{BEGIN}  # region: a\nx = 1  {END}\n", 2, "alone on its line"),
        (f"{BEGIN}  # region: a\n{END}  # region: b\n", 2, "give both the same id"),
        (f"{BEGIN}  # region: a sig: xyz\n{END}  # region: a\n", 1, "put the generated line back"),
        (f"{BEGIN}\n{END}\n", 1, "must be inside a function"),
        ("<!-- Manual edit begin | region: a --><x/>\n", 1, "alone on its line"),
        ("a\n<<<<<<< before updating\n", 2, "merge conflict"),
    ],
)
def test_faults(text: str, line: int, word: str) -> None:
    _, faults = parse(text)
    assert any(f.line == line and word in f.reason for f in faults), faults


METHODS = f"""class C:
    def f(self):
        {BEGIN}  # region: a
        x = 1

    @cached
    def g(self):
        {BEGIN}  # region: b
        y = 1
        {END}  # region: b
    def h(self):
        {BEGIN}
        z = 1
        {END}
    def i(self):
        {BEGIN}
        z = 1
        {END}
"""


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (METHODS, 5, ("end marker of region 'a', which begins in line 3", "before line 5")),
        (METHODS.replace("\n", "\r\n"), 5, ("region 'a'", "before line 5")),
        (
            METHODS.replace(f"{END}\n    def i", "\n    def i").replace(
                "x = 1\n", f"x = 1\n        {END}\n"
            ),
            15,
            ("end marker of the region that begins in line 13", "before line 15"),
        ),
        (f"{BEGIN}  # region: a\n{BEGIN}  # region: b\n{END}  # region: b\n", 2, ("'a'", "line 2")),
        (f"{BEGIN}  # region: a\n{BEGIN}  # region: b\n{END}  # region: a\n", 2, ("remove this",)),
        (f"{BEGIN}  # region: a\n{BEGIN}  # region: a\n{END}  # region: a\n", 2, ("remove this",)),
    ],
)
def test_one_marker_that_is_missing_or_too_many_is_one_fault(
    text: str, line: int, words: tuple[str, ...]
) -> None:
    (fault,) = parse(text)[1]
    assert fault.line == line
    assert all(word in fault.reason for word in words), fault


def test_sig_is_replaced_in_every_form() -> None:
    for style in ("python", "xml", "hash"):
        old = begin_marker("a:b", style, ("a:c",), "11111111")
        assert with_sig(old, "22222222") == begin_marker("a:b", style, ("a:c",), "22222222")
        assert with_sig(old, None) == begin_marker("a:b", style, ("a:c",))
        assert with_sig(with_sig(old, None), "11111111") == old


@given(st.text())
def test_lines_join_to_the_text(text: str) -> None:
    assert "".join(split_lines(text)) == text


MANY = 50_000


@pytest.mark.parametrize(
    "line",
    [
        "-" * MANY,
        " " * MANY,
        "# " + " " * MANY + "x",
        "-" * MANY + " Manual edit begin",
        "-----Manual edit begin" + "-" * MANY + "x",
        "# " + " " * MANY + "Manual edit begin",
        "-----Manual edit begin-----" + " " * MANY + "x",
        "<!--" * (MANY // 4) + "Manual edit begi",
        "<!--" + " " * MANY + "Manual edit begin" + " " * MANY + "x-->",
        "-----Manual edit begin----- region: a was: " + "b," * (MANY // 2) + "b b",
        "-----Manual edit begin----- region: a was: b" + " " * MANY + "sig: x",
        "-----Manual edit begin----- region: a " + "sig: " * (MANY // 5),
    ],
)
def test_a_long_line_is_read_at_once(line: str) -> None:
    """A pattern that goes back for every character takes ten seconds and more."""
    with watched(5.0):
        read_marker(line, 1)
        with_sig(line, "1a2b3c4d")
