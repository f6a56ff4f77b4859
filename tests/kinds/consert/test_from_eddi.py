"""ConSerts from EDDI XML: content, each diagnostic with its text, and no file that breaks us."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.kinds.consert import read_eddi
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    Bound,
    Gate,
    NumericDimension,
    Propagation,
    Range,
)
from eddi_scaffold.kinds.consert.read_eddi_dimensions import read_english
from eddi_scaffold.kinds.consert.write_yaml import to_yaml
from tests.data_files import data_file
from tests.diagnosed import Cases
from tests.eddi_xml.eddi_texts import MODELS, OLDER, ROVER, SAFETY_CASE, read, texts
from tests.kinds.consert.example import oracle


def test_texts_of_the_oracle_agree() -> None:
    checked = 0
    by_id = {entry["id"]: entry for entry in oracle()["xml_import"]}
    for entry in by_id.values():
        if "text" not in entry or "error" in entry:
            continue
        want = by_id[entry["same_as"]] if "same_as" in entry else entry
        dimension = read_english(str(entry["text"]))[0]
        assert dimension.type == want["type"]
        assert isinstance(dimension, BinaryDimension) == bool(want.get("binary"))
        if isinstance(dimension, NumericDimension):
            (covered,) = dimension.covered
            assert covered.start.value == want["start"]
            assert covered.end.value == want["end"]
            assert covered.inclusive == (want["kind"] == "Inclusive")
            assert (dimension.uom, dimension.subset) == (want["uom"], want["subset"])
        checked += 1
    assert checked == 5


def test_a_lower_bound_is_open_upwards() -> None:
    at_least = read_english("Distance >= 5.7 m")[0]
    assert at_least == NumericDimension(
        "Distance",
        (Range(Bound("5.7", 5.7), Bound("inf", math.inf), inclusive=True),),
        "Guarantee",
        "m",
    )
    above = read_english("Distance > 5.7 m")[0]
    assert isinstance(above, NumericDimension)
    assert above.covered[0].start.value == math.nextafter(5.7, math.inf)
    assert float(above.covered[0].start.text) == above.covered[0].start.value


@pytest.mark.parametrize(
    ("text", "kind", "is_read"),
    [
        ("Delay < 3 minutes", "Delay3Minutes", False),
        ("Delay < 3 ms at most", "Delay3MsAtMost", False),
        ("Delay < 3,5 ms", "Delay35Ms", False),
        ("Delay == 3 ms", "Delay3Ms", False),
        ("Delay <== 3 ms", "Delay3Ms", False),
        ("< 3 ms", "3Ms", False),
        (" \r\nWifi Module is healthy : ASIL D \n", "WifiModuleIsHealthy", True),
    ],
)
def test_a_bound_that_cannot_be_read_is_binary_with_a_remark(
    text: str, kind: str, is_read: bool
) -> None:
    assert read_english(text) == (BinaryDimension(kind), is_read)


@given(st.text())
def test_any_text_is_read(text: str) -> None:
    read_english(text)
    read_english(f"x < {text}")


((DRIVE,), _) = read(ROVER)


@pytest.mark.parametrize("name", ["rover", "older"])
def test_every_kind_of_content_is_read(name: str) -> None:
    ((consert,), problems) = read((MODELS / f"{name}.xml").read_text("utf-8"))
    assert problems == []
    assert to_yaml(consert) == (MODELS / f"{name}.yml").read_text("utf-8")


def _example() -> str:
    return data_file("conserts/eddi_consert_example.xml").read_text()


def described(value: object) -> object:
    """Return plain data without its descriptions, as the models in the oracle are."""
    if isinstance(value, list):
        return [described(item) for item in value]
    if isinstance(value, dict):
        return {key: described(item) for key, item in value.items() if key != "description"}
    return value


def test_the_shared_example_gives_the_models_of_the_oracle() -> None:
    want = oracle()["models"]
    conserts, problems = read(_example())
    assert problems == []
    for consert in conserts:
        assert described(yaml.load(to_yaml(consert), yaml.CSafeLoader)) == want[consert.name]
    assert [consert.name for consert in conserts] == ["ConSertA", "ConSertB"]
    assert conserts[0].guarantees[0].description == "GuaranteeG0Descr"


PREFIXES = re.compile(r"\b(integration|consert|architecture)_:")
VARIANTS: dict[str, Callable[[str], str]] = {
    "prefixes without underscore": lambda t: (
        PREFIXES.sub(r"\1:", t)
        .replace("xmlns:integration_", "xmlns:integration")
        .replace("xmlns:consert_", "xmlns:consert")
        .replace("xmlns:architecture_", "xmlns:architecture")
    ),
    "merged URIs": lambda t: t.replace("/ode/", "/ode/mergedODE/"),
    "omitted gate type": lambda t: t.replace(' gateType="AND"', ""),
    "comments everywhere": lambda t: re.sub(r">(\s*)<(?!\?)", r"><!-- <x/> -->\1<?pi?><", t),
    "byte order mark": lambda t: "\ufeff" + t,
    "one line": lambda t: re.sub(r">\s+<", "><", t),
    "trailing slashes": lambda t: re.sub(r'(//@[^"]*)"', r'\1/"', t),
    "no index where it is 0": lambda t: re.sub(r"(@\w+)\.0", r"\1", t),
    "sharps": lambda t: t.replace('"//@', '"#//@'),
    "foreign prefixes": lambda t: t.replace("consert_", "zz").replace(
        "http://www.deis-project.eu/ode/consert", "urn:whatever"
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_variants_of_one_file_are_identical(name: str) -> None:
    for text in (ROVER, _example()):
        changed = VARIANTS[name](text)
        assert read(changed)[0] == read(text)[0]
        assert not has_errors(read(changed)[1])


def test_several_roots_and_a_consert_package_as_root() -> None:
    package = re.search(r"<odeProductPackages.*?</odeProductPackages>", ROVER, re.DOTALL)
    assert package is not None
    root = (
        package.group()
        .replace('odeProductPackages xsi:type="consert_:ConSertPackage"', "c:ConSertPackage")
        .replace("</odeProductPackages>", "</c:ConSertPackage>")
        .replace("//@odeProductPackages.0/", "//")
    )
    root = re.sub(r' (required|provided)Service="[^"]*"', "", root)
    names = (
        ' xmlns:c="urn:consert" xmlns:consert_="urn:consert"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    )
    alone = root.replace("<c:ConSertPackage", f"<c:ConSertPackage{names}", 1)
    ((consert,), problems) = read(alone)
    assert problems == []
    assert consert.place.path == "//@conSerts.0"
    wrapped = f'<x:XMI xmlns:x="http://www.omg.org/XMI"{names}><other/>{root}</x:XMI>'
    ((second,), problems) = read(wrapped.replace('"//@', '"/1/@').replace(" //@", " /1/@"))
    assert problems == []
    assert second == consert
    assert second.place.path == "/1/@conSerts.0"


def test_older_dialect_is_read_in_singular_and_plural() -> None:
    for one, other in (
        ("guaranteePropagations", "guaranteePropagation"),
        ("runtimeEvidence", "runtimeEvidences"),
    ):
        changed = re.sub(rf"\b{one}\b", other, OLDER)
        assert changed != OLDER
        assert read(changed) == read(OLDER)


def test_an_invariant_supports_every_guarantee_that_has_support() -> None:
    invariant = '<invariant name="ready"/>'
    edge = (
        '<guaranteePropagations sourceElement="//@configurations.0/@conSert/@runtimeEvidence.1" '
        'targetElement="//@configurations.0/@conSert/@invariant"/>'
    )
    ((consert,), problems) = read(OLDER.replace("</conSert>", f"{invariant}{edge}</conSert>"))
    assert consert.gates[-1] == Gate("ready", "And")
    assert consert.tree_propagations[-2:] == (
        Propagation("radar", "ready"),
        Propagation("ready", "keeps_gap"),
    )
    assert texts(problems) == [
        'm.xml:21: info X006: the invariant "ready" is read as an input of every guarantee'
    ]
    ((consert,), problems) = read(OLDER.replace("</conSert>", f"{invariant}</conSert>"))
    assert consert == read(OLDER)[0][0]
    assert texts(problems) == [
        'm.xml:21: warning X006: the invariant "ready" has no input, it is ignored'
    ]


def test_a_bound_that_cannot_be_read_is_said() -> None:
    ((consert,), problems) = read(OLDER.replace("300 ms", "300 bananas"))
    assert consert.evidence[0].dimension == BinaryDimension("RadioDelayBoundTo300Bananas")
    assert texts(problems) == [
        (
            'm.xml:14: warning X014: the bound in "Radio delay bound to < 300 bananas" cannot be '
            'read: it is taken as the binary property "RadioDelayBoundTo300Bananas"'
        )
    ]


REPORTED = Cases(Path(__file__).with_name("eddi_diagnostics.txt"))
"""Each input is what is changed in a file, and into what."""


@pytest.mark.parametrize("name", REPORTED.inputs)
def test_what_is_reported(name: str) -> None:
    before, after = REPORTED.inputs[name].removesuffix("\n").split("\n->\n")
    assert before in ROVER
    conserts, problems = read(ROVER.replace(before, after))
    assert conserts or has_errors(problems)
    assert all(problem.place.path for problem in problems if problem.level == "error")
    if name.startswith("Fig"):  # SESAME D7.2 exists as scanned text, and users copy from it
        assert conserts == (DRIVE,)
    REPORTED.check(name, problems)


def test_a_file_without_conserts_has_none() -> None:
    assert read(SAFETY_CASE) == ((), [])


def test_too_many_edges(monkeypatch: pytest.MonkeyPatch) -> None:
    """References are many-valued: a small file can ask for any number of edges."""
    monkeypatch.setattr(read_eddi, "MAX_EDGES", 3)
    conserts, (problem,) = read(ROVER)
    assert (conserts, problem.case) == ((), "X003.edges")


@pytest.mark.parametrize("text", [ROVER, OLDER], ids=["sesame", "older"])
def test_without_any_one_attribute(text: str) -> None:
    for match in re.finditer(r' [\w:]+="[^"]*"', text):
        conserts, problems = read(text[: match.start()] + text[match.end() :])
        assert conserts or has_errors(problems)
