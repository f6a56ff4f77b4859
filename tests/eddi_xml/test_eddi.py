"""Binding and survey: every kind of package is listed, whatever the generation of its metamodel."""

import re
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.eddi_xml import document as document_module
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document
from eddi_scaffold.eddi_xml.references import Fragment, parse_fragment
from eddi_scaffold.eddi_xml.vocabulary import ClassName, Spelling, fold
from tests.data_files import data_text
from tests.eddi_xml.eddi_texts import ROVER, parsed, texts


def document(text: str) -> EddiDocument:
    found, problems = parsed(text)
    assert problems == []
    return found


def test_classes_are_bound_without_prefix_and_case() -> None:
    assert fold("_ConsentPackage") == fold("ConSertPackage") == "consertpackage"
    doc = document(ROVER)
    first = next(iter(doc.roots[0]))
    assert doc.class_of(first) == ClassName("consert", "consertpackage", "consert_:ConSertPackage")
    assert doc.class_of(first[0]) == ClassName()
    assert doc.describe(first[0]) == 'conSerts "Drive"'


def test_too_many_references(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(document_module, "MAX_REFERENCES", 2)
    data = b'<r><a/><b to="//@a //@a //@a"/></r>'
    doc, _ = read_document(Source("m.xml", data))
    assert doc is not None
    _, problems, _ = doc.targets(doc.roots[0][1], Spelling("to"))
    assert texts(problems) == ["m.xml:1: error X003: to has 3 references, more than the limit of 2"]


def said(package: str, model: str) -> list[str]:
    text = data_text("eddi_xml/package.xml").replace("PACKAGE", package).replace("MODEL", model)
    _, problems = parsed(text)
    return [f"{p.place.line}: {p.level} {p.code} {p.message} | {p.hint}" for p in problems]


def test_classes_of_the_metamodel_and_of_others_are_no_slips() -> None:
    _, models, others = re.split(r"# .*", data_text("eddi_xml/classes.txt"))
    for name in models.split():
        assert said("f:FailureLogicPackage", f"f:{name}") == []
    for name in others.split():
        assert not [one for one in said("a:StrangePackage", f"a:{name}") if '"M"' in one]
    assert said("a:StrangePackage", "a:AssertedInference") == []
    assert said("f:FailureLogicPackage", "failurelogic_:markovchain") == []


@pytest.mark.parametrize(
    ("model", "hint"),
    [
        ("f:FaultTre", "did you mean 'FaultTree'?"),
        ("MarkovChian", "did you mean 'MarkovChain'?"),
        ("f:PetriNet", "known are: BayesianNetwork, ConSert, FaultTree, MarkovChain, StateMachine"),
    ],
)
def test_a_model_of_an_unknown_class_is_named(model: str, hint: str) -> None:
    what = f'{model} "M": the class is unknown, so that nothing is read from it'
    assert said("f:FailureLogicPackage", model) == [f"5: warning X006 {what} | {hint}"]


@pytest.mark.parametrize(
    "text", ["", "a", "//@a..0", "//@a.0//@b", "//@a[name='x']", "//@a.x", "/topic", "//@a.-1"]
)
def test_what_is_no_fragment(text: str) -> None:
    assert parse_fragment(text) is None


def test_several_roots() -> None:
    doc = document('<X:XMI xmlns:X="http://www.omg.org/XMI"><a><c/></a><b><c/><c/></b></X:XMI>')
    second = doc.roots[1]
    assert [doc.references.path(child) for child in second] == ["/1/@c.0", "/1/@c.1"]
    assert doc.references.resolve(Fragment(1, "/@c.1")) is second[1]
    assert doc.references.resolve(Fragment(0, "/@c")) is doc.roots[0][0]
    assert doc.references.resolve(Fragment(2, "")) is None
    assert "the file has no root 2" in doc.references.explain(Fragment(2, ""))


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


def test_names_with_points_are_told_from_indices() -> None:
    doc = document("<r><a.b><c/></a.b><a.0/></r>")
    assert doc.references.path(doc.roots[0][0][0]) == "//@a.b.0/@c.0"
    assert doc.references.explain(Fragment(0, "/@c.0")) == '/ has no "c.0"'


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
