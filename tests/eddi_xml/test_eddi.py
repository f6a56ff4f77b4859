"""Binding and survey: every kind of package is listed, whatever the generation of its metamodel."""

import re

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.eddi_xml import vocabulary
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document
from eddi_scaffold.eddi_xml.parsing import Limits
from eddi_scaffold.eddi_xml.vocabulary import ClassName, Spelling, fold, package_key
from tests.cli.command import ROOT
from tests.eddi_xml.eddi_texts import ROVER, texts


def document(text: str) -> EddiDocument:
    found, problems = read_document(Source("m.xml", text.encode()))
    assert found is not None
    assert problems == []
    return found


def test_every_name_that_readers_use_is_in_the_table() -> None:
    for path in (ROOT / "eddi_scaffold").rglob("*.py"):
        for name in re.findall(
            r"\b(?:names|word|vocabulary)\.([A-Z_]+)\b", path.read_text("utf-8")
        ):
            assert hasattr(vocabulary, name), (path, name)


@pytest.mark.parametrize(
    ("uri", "key"),
    [
        ("http://www.deis-project.eu/ode/failureLogic", "failurelogic"),
        ("http://www.deis-project.eu/ode/mergedODE/failureLogic", "failurelogic"),
        ("http://omg.sacm/2.0/artifact", "artifact"),
        ("failureLogic_", "failurelogic"),
        ("allInOnePkg", "allinone"),
        ("allInOne", "allinone"),
        ("consent:_".rstrip(":_"), "consert"),
    ],
)
def test_package_keys(uri: str, key: str) -> None:
    assert package_key(uri) == key


def test_classes_are_bound_without_prefix_and_case() -> None:
    assert fold("_ConsentPackage") == fold("ConSertPackage") == "consertpackage"
    doc = document(ROVER)
    first = next(iter(doc.roots[0]))
    assert doc.class_of(first) == ClassName("consert", "consertpackage", "consert_:ConSertPackage")
    assert doc.class_of(first[0]) == ClassName()
    assert doc.describe(first[0]) == 'conSerts "Drive"'


def test_too_many_references() -> None:
    data = b'<r><a/><b to="//@a //@a //@a"/></r>'
    doc, _ = read_document(Source("m.xml", data), Limits(reference_tokens=2))
    assert doc is not None
    _, problems, _ = doc.targets(doc.roots[0][1], Spelling("to"))
    assert texts(problems) == ["m.xml:1: error X003: to has 3 references, more than the limit of 2"]
