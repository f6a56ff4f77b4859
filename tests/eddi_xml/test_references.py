from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document
from eddi_scaffold.eddi_xml.references import Fragment, parse_fragment


@pytest.mark.parametrize(
    ("text", "root", "segments"),
    [
        ("//@a.0/@b.3", 0, "/@a.0/@b.3"),
        ("/@a.0", 0, "/@a.0"),
        ("//@a/@b", 0, "/@a/@b"),
        ("//@a.0/", 0, "/@a.0"),
        ("/3/@a.0", 3, "/@a.0"),
    ],
)
def test_fragments(text: str, root: int, segments: str) -> None:
    assert parse_fragment(text) == Fragment(root, segments)


@pytest.mark.parametrize(
    "text", ["", "a", "//@a..0", "//@a.0//@b", "//@a[name='x']", "//@a.x", "/topic", "//@a.-1"]
)
def test_what_is_no_fragment(text: str) -> None:
    assert parse_fragment(text) is None


def document(text: str) -> EddiDocument:
    found, _ = read_document(Source("m.xml", text.encode()))
    assert found is not None
    return found


def test_several_roots() -> None:
    doc = document('<X:XMI xmlns:X="http://www.omg.org/XMI"><a><c/></a><b><c/><c/></b></X:XMI>')
    second = doc.roots[1]
    assert [doc.references.path(child) for child in second] == ["/1/@c.0", "/1/@c.1"]
    assert doc.references.resolve(Fragment(1, "/@c.1")) is second[1]
    assert doc.references.resolve(Fragment(0, "/@c")) is doc.roots[0][0]
    assert doc.references.resolve(Fragment(2, "")) is None
    assert "the file has 2 roots" in doc.references.explain(Fragment(2, ""))


def test_xmi_ids() -> None:
    doc = document('<a xmlns:xmi="http://www.omg.org/XMI"><b xmi:id="_1" id="_2"/></a>')
    assert doc.references.by_id("_1") == [doc.roots[0][0]]
    assert not doc.references.by_id("_2")


@pytest.mark.parametrize(
    ("text", "case"),
    [
        ("other.xml#//@a", "X007.resource"),
        ("_x1", "X007.nothing"),
        ("//@a.9", "X007.nothing"),
        ("#", "X007.token"),
        ("/topic", "X007.token"),
        ("#//@a.0", None),
        ("//@a", None),
    ],
)
def test_other_files_ids_and_what_is_no_reference(text: str, case: str | None) -> None:
    doc = document("<r><a/></r>")
    end = doc.target(doc.roots[0], "f", text)
    assert end.case == case if isinstance(end, Problem) else end is doc.roots[0][0] and not case


def test_an_index_out_of_range_says_the_range() -> None:
    doc = document("<r><a/><a/></r>")
    assert doc.references.explain(Fragment(0, "/@a.5")) == (
        '/ has 2 "a", the index 5 is out of range (0 to 1)'
    )
    assert doc.references.explain(Fragment(0, "/@a.1/@b")) == (
        '//@a.1 has no "b", it has no children'
    )


def test_names_with_points_are_told_from_indices() -> None:
    doc = document("<r><a.b><c/></a.b><a.0/></r>")
    assert doc.references.path(doc.roots[0][0][0]) == "//@a.b.0/@c.0"
    assert doc.references.explain(Fragment(0, "/@c.0")) == (
        '/ has no "c", it has "a.b" (1) and "a.0" (1)'
    )


NAMES = st.sampled_from(["a", "b", "c_", "D", "consert"])
Tree = tuple[str, list[Any]]
TREES: st.SearchStrategy[Tree] = st.recursive(
    st.tuples(NAMES, st.just([])),
    lambda children: st.tuples(NAMES, st.lists(children, max_size=5)),
    max_leaves=25,
)


def _text(tree: Tree, prefix: str, noise: str) -> str:
    name, children = tree
    inner = noise.join(_text(child, prefix, noise) for child in children)
    tag = f"{prefix}{name}"
    return f"<{tag} name={quoteattr(name)}>{noise}{inner}{noise}</{tag}>"


@given(TREES)
def test_the_path_of_an_element_resolves_to_it(tree: Tree) -> None:
    doc = document(_text(tree, "", ""))
    for element in doc.roots[0].iter():
        path = doc.references.path(element)
        fragment = parse_fragment(path)
        assert fragment is not None
        assert doc.references.resolve(fragment) is element
