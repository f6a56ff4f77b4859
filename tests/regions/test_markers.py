from __future__ import annotations

import textwrap
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.marked_file import parse, split_lines
from eddi_scaffold.regions.markers import (
    Digests,
    Look,
    begin_marker,
    decode_id,
    digest,
    encode_id,
    end_marker,
    read_marker,
    tail_of,
    with_tail,
)
from tests.data_files import data_text, tabled
from tests.fuzz.damage import watched

BEGIN, END = "'''-----Manual edit begin-----'''", "'''-----Manual edit end-----'''"


METHODS = data_text("regions/methods.txt")


def marked(text: str):
    """Parse a text in which BEGIN and END stand for markers without an id."""
    return parse(text.replace("BEGIN", BEGIN).replace("END", END))


def one(text: str):
    document, faults = parse(text)
    assert not faults
    (region,) = document.regions.values()
    return region


STYLES = ("python", "xml", "hash")
LOOK = Look(Digests("22222222", "33333333"), ("Ea", "x y"))


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("now", [None, LOOK, Look(Digests("22222222"))])
def test_written_form_is_read(style: str, now: Look | None) -> None:
    digests = Digests("1a2b3c4d", "81fdda7e")
    begin = begin_marker("a b", style, digests, ("old", "x,y"), now)
    region = one(f"  {begin}\nbody\n  {end_marker('a b', style)}\n")
    assert (region.id, region.was, region.digests) == ("a b", ("old", "x,y"), digests)
    assert (region.body, region.line, region.indent) == ("body\n", 1, "  ")
    assert region.now == now


def test_written_form_of_python() -> None:
    text = begin_marker("process_Ea", "python", Digests("1a2b3c4d", "81fdda7e"), ["process_E"])
    assert text == f"{BEGIN}  # region: process_Ea of:1a2b3c4d for:81fdda7e was:process_E"


@given(st.text(min_size=1), st.sampled_from(STYLES))
def test_any_id_travels(name: str, style: str) -> None:
    marker = begin_marker(name, style, was=(f"{name}2",))
    region = one(f"{marker}\n{end_marker(name, style)}\n")
    assert (region.id, region.was) == (name, (f"{name}2",))
    assert decode_id(encode_id(name)) == name


def test_what_editors_and_git_change_is_not_in_a_digest() -> None:
    body = "    x = 1\n    if x:\n        y = 2\n"
    for other in (body.replace("\n", "\r\n"), textwrap.indent(body, "  "), f"\n\n{body} \n"):
        assert digest(other) == digest(body)
    assert digest("") == "e3b0c442"


@pytest.mark.parametrize("written", ["%E1", "%FFx%20", "%"])
def test_an_id_that_was_never_written_stays_as_it_is(written: str) -> None:
    assert one(f"{BEGIN}  # region: {written}\n{END}  # region: {written}\n").id == written


def test_xml_form_is_legal_xml() -> None:
    text = f"<a>{begin_marker('a--b---', 'xml')}{end_marker('a--b---', 'xml')}</a>"
    assert ET.fromstring(text).tag == "a"


@tabled
def test_forms_without_id(begin: str, end: str) -> None:
    text = f"class C:\n    def f(self):\n        {begin}\n        x = 1\n        {end}\n"
    region = one(text)
    assert region.id == "f"
    stripped = one(
        "\n".join(line.strip() if "Manual" in line else line for line in text.split("\n"))
    )
    assert stripped.id == "f"
    assert one(text.replace("\n", "\r\n")).body == "        x = 1\r\n"


def test_id_on_one_marker_is_enough() -> None:
    assert one(f"def f():\n  {BEGIN}\n  {END}  # region: a:b\n").id == "a:b"
    assert one(f"def f():\n  {BEGIN} # region: a:b\n  {END}\n").id == "a:b"


@tabled
def test_faults(text: str, line: int, word: str) -> None:
    _, faults = marked(text)
    assert any(f.line == line and word in f.reason for f in faults), faults


@tabled
def test_one_marker_that_is_missing_or_too_many_is_one_fault(changes, line, words):
    text = METHODS
    for old, new in changes:
        text = text.replace(old, new)
    (fault,) = marked(text)[1]
    assert fault.line == line
    assert words in fault.reason, fault


def test_a_tail_is_replaced_in_every_form() -> None:
    for style in STYLES:
        old = begin_marker("a", style, Digests("11111111"), ("c",), LOOK)
        new = begin_marker("a", style, Digests("22222222"), ("c",))
        assert with_tail(old, "a", tail_of(Digests("22222222"), ("c",))) == new
    bare = with_tail(f"  {BEGIN}", "f", tail_of(Digests("11111111")))
    assert bare == f"  {BEGIN}  # region: f of:11111111"


@given(st.text())
def test_lines_join_to_the_text(text: str) -> None:
    assert "".join(split_lines(text)) == text


LONG = {"BLANKS": " ", "DASHES": "-", "OPENS": "<!--", "NAMES": "b,", "DIGESTS": "of:1 "}
"""Word in a row of the table -> what stands there, 50,000 characters of it."""


@tabled
def test_a_long_line_is_read_at_once(line: str) -> None:
    """A pattern that goes back for every character takes ten seconds and more."""
    for word, text in LONG.items():
        line = line.replace(word, text * (50_000 // len(text)))
    assert len(line) >= 50_000
    with watched(5.0):
        read_marker(line, 1)


def test_without_a_manifest_the_files_with_regions_are_listed(tmp_path: Path) -> None:
    region = f"{BEGIN}  # region: a of:e3b0c442\nx = 1\n{END}  # region: a\n"
    (tmp_path / "a.py").write_text(region)
    (tmp_path / "own.py").write_text("")
    found = [(one.file, one.id, one.state) for one in list_regions(tmp_path)]
    assert found == [(".eddi/manifest", "", "missing"), ("a.py", "a", "edited")]
