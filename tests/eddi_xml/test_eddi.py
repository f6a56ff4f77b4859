"""Binding and survey: every kind of package is listed, whatever the generation of its metamodel."""

import io
import re

import pytest

from eddi_scaffold.eddi_xml import vocabulary
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import Limits
from eddi_scaffold.eddi_xml.reading import read_stream
from eddi_scaffold.eddi_xml.survey import survey
from eddi_scaffold.eddi_xml.vocabulary import ClassName, Spelling, fold, package_key
from tests.cli.command import ROOT
from tests.eddi_xml.eddi_texts import OLDER, ROVER, SAFETY_CASE, texts


def document(text: str) -> EddiDocument:
    found, problems = read_stream(io.BytesIO(text.encode()), "m.xml")
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


def counted(*numbers: int) -> dict[str, int]:
    """Return the counts of a ConSert."""
    kinds = ("guarantees", "demands", "evidence", "gates", "tree_propagations")
    return dict(zip((*kinds, "required_services", "provided_services"), numbers, strict=True))


CASE = {"argumentation_elements": 3, "claims": 1, "artifact_references": 1, "artifact_elements": 0}
EFFECTS = ("fmea", "Effects", {"entries": 1, "failures": 1})
SURVEYS = [
    (ROVER, [("consert", "Drive", counted(2, 1, 2, 1, 3, 1, 1))], (11, 0)),
    (OLDER, [("consert", "Follower", counted(2, 1, 2, 1, 4, 1, 1))], (11, 0)),
    (
        SAFETY_CASE,
        [
            EFFECTS,
            ("failure_model", "Plain", {"failures": 2}),
            ("assurance_case", "The case", CASE),
        ],
        (3, 1),
    ),
]


@pytest.mark.parametrize(("text", "models", "references"), SURVEYS)
def test_surveys(
    text: str, models: list[tuple[str, str, dict[str, int]]], references: tuple[int, int]
) -> None:
    found = survey(document(text))
    assert [(m["kind"], m["name"], m["counts"]) for m in found["models"]] == models
    assert tuple(found["references"].values()) == references


def test_too_many_references() -> None:
    data = b'<r><a/><b to="//@a //@a //@a"/></r>'
    doc, _ = read_stream(io.BytesIO(data), "m.xml", Limits(reference_tokens=2))
    assert doc is not None
    _, problems, _ = doc.targets(doc.roots[0][1], Spelling("to"))
    assert texts(problems) == ["m.xml:1: error X003: to has 3 references, more than the limit of 2"]
