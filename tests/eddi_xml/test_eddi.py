"""Binding and survey: every kind of package is listed, whatever the generation of its metamodel."""

from __future__ import annotations

import io

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.eddi_xml.document import EddiDocument, read_document, read_stream, recognises
from eddi_scaffold.eddi_xml.parsing import Limits
from eddi_scaffold.eddi_xml.survey import survey
from eddi_scaffold.eddi_xml.vocabulary import ClassName, Spelling, fold, package_key
from tests.data_files import ORACLES, data_file
from tests.eddi_xml.eddi_texts import OLDER, ROVER, SAFETY_CASE, texts


def document(text: str) -> EddiDocument:
    found, problems = read_stream(io.BytesIO(text.encode()), "m.xml")
    assert found is not None
    assert problems == []
    return found


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


def test_survey_of_conserts() -> None:
    found = survey(document(ROVER)).as_json()
    assert found["models"] == [
        {
            "kind": "consert",
            "name": "Drive",
            "path": "//@odeProductPackages.0/@conSerts.0",
            "line": 4,
            "counts": {
                "guarantees": 2,
                "demands": 1,
                "evidence": 2,
                "gates": 1,
                "tree_propagations": 3,
                "required_services": 1,
                "provided_services": 1,
            },
        }
    ]
    assert found["elements"] == 42
    assert found["references"] == {"total": 11, "unresolved": 0}


def test_survey_of_the_older_dialect() -> None:
    (model,) = survey(document(OLDER)).models
    assert (model.kind, model.name, model.path) == (
        "consert",
        "Follower",
        "//@configurations.0/@conSert.0",
    )
    assert dict(model.counts) == {
        "guarantees": 2,
        "demands": 1,
        "evidence": 2,
        "gates": 1,
        "tree_propagations": 4,
        "required_services": 1,
        "provided_services": 1,
    }


def test_survey_of_what_has_no_monitor() -> None:
    found = survey(document(SAFETY_CASE))
    assert [(m.kind, m.name, dict(m.counts)) for m in found.models] == [
        ("fmea", "Effects", {"entries": 1, "failures": 1}),
        ("failure_model", "Plain", {"failures": 2}),
        (
            "assurance_case",
            "The case",
            {
                "argumentation_elements": 3,
                "claims": 1,
                "artifact_references": 1,
                "artifact_elements": 0,
            },
        ),
    ]
    assert (found.references, found.unresolved) == (3, 1)
    assert [p.class_name for p in found.packages] == [
        "integration:DDIPackage",
        "failureLogic:FailureLogicPackage",
        "assuranceCasePackages",
        "argumentPackages",
    ]


def test_survey_of_oracle_networks_and_failure_models() -> None:
    kinds = set()
    for path in [*ORACLES.glob("bn/*.xml"), *ORACLES.glob("monitors/*.xml")]:
        doc, problems = read_document(read_source(path))
        assert doc is not None
        assert problems == []
        found = survey(doc)
        assert found.references > 0
        assert found.unresolved == 0
        kinds |= {model.kind for model in found.models}
    assert kinds == {"bayesian_network", "fault_tree", "markov_chain"}


def test_survey_of_the_shared_example() -> None:
    doc, _ = read_document(read_source(data_file("conserts/eddi_consert_example.xml")))
    assert doc is not None
    found = survey(doc)
    assert (found.elements, found.references, found.unresolved) == (50, 20, 0)
    assert [model.name for model in found.models] == ["ConSertA", "ConSertB"]


def test_references_by_href_by_id_and_into_other_files() -> None:
    doc = document(
        '<r xmlns:xmi="http://www.omg.org/XMI"><a xmi:id="_1"/>\n'
        '<b to="_1 #_1 //@a.0"><to href="#//@a.0"/></b>\n'
        '<b to="x.xml#//@a.0 _2 //@a[k]"/>\n<b to=" "/></r>'
    )
    to = Spelling("to")
    _, good, bad, empty = doc.roots[0]
    found, problems, present = doc.targets(good, to)
    assert (found, problems, present) == ([doc.roots[0][0]] * 4, [], True)
    found, problems, present = doc.targets(bad, to)
    assert (found, present) == ([], True)
    assert texts(problems) == [
        'm.xml:3: error X007: to "//@a[k]" is not a reference',
        'm.xml:3: error X007: to "_2" points at nothing: no element has xmi:id "_2"',
        'm.xml:3: error X007: to "x.xml#//@a.0" points into another file, x.xml',
    ]
    assert doc.targets(empty, to) == ([], [], False)


def test_too_many_references() -> None:
    data = b'<r><a/><b to="//@a //@a //@a"/></r>'
    doc, _ = read_stream(io.BytesIO(data), "m.xml", Limits(reference_tokens=2))
    assert doc is not None
    _, problems, _ = doc.targets(doc.roots[0][1], Spelling("to"))
    assert texts(problems) == ["m.xml:1: error X003: to has 3 references, more than the limit of 2"]


def test_sniffing_looks_at_the_content() -> None:
    assert recognises(Source("a.model", b"\xef\xbb\xbf \n<r/>"))
    assert recognises(Source("a.model", "<r/>".encode("utf-16")))
    assert not recognises(Source("a.xml", b"guarantees: []"))
