"""Formats of a report, each loaded by its own tool."""

from __future__ import annotations

import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from datetime import datetime
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.report.formats import (
    Case,
    Item,
    Node,
    export_ids,
    gsn,
    junit,
    needs_conf,
    needs_json,
    reqif,
    sacm,
)

NOW = datetime(2026, 1, 1)  # noqa: DTZ001 - a time without a zone, as the formats write it
HAZARD = ("hazard", "", "HitsPerson")
GUARANTEE = ("guarantee", "warehouse", "FullSpeed")
# what a model may hold: markup of each format, and what XML cannot say
HOSTILE = (
    ".. raw:: html\n\n   <script>1</script> {{ 7*7 }} :need:`X` |x| a_ ''' \x01 \udc80 &amp; \"]"
)
ITEMS = [
    Item(HAZARD, "It drives into a person", "linked", place="robot.xml:3"),
    Item(GUARANTEE, HOSTILE, "proved", {"mitigates": [HAZARD]}, sha256="ab"),
]


def test_ids_are_of_the_key_alone_and_never_the_same() -> None:
    keys = [HAZARD, ("evidence", "a", "x.y"), ("evidence", "a", "x y")]
    ids = export_ids(keys)
    assert ids[HAZARD] == "HAZARD_HITSPERSON"
    assert ids == {key: export_ids(reversed(keys))[key] for key in keys}
    assert len({*ids.values()}) == 3
    assert all(id_.startswith("EVIDENCE_A_X_Y_") for key, id_ in ids.items() if key != HAZARD)


@pytest.mark.slow
def test_sphinx_needs_imports_them_without_a_warning(tmp_path: Path) -> None:
    (tmp_path / "needs.json").write_text(needs_json("it's \\ warehouse", ITEMS, NOW), "utf-8")
    (tmp_path / "conf.py").write_text(needs_conf("it's \\ warehouse"), "utf-8")
    (tmp_path / "index.rst").write_text(
        "Trace\n=====\n\n.. needimport:: needs.json\n\n.. needtable::\n   :columns: id, status\n"
    )
    for builder, file in (("html", "index.html"), ("needs", "needs.json")):
        paths = [tmp_path, tmp_path / "out"]
        command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", builder, *paths]
        subprocess.run([*command, "-d", tmp_path / "trees"], check=True)
        assert "GUARANTEE_WAREHOUSE_FULLSPEED" in (tmp_path / "out" / file).read_text("utf-8")
    page = (tmp_path / "out" / "index.html").read_text("utf-8")
    assert "<script>1" not in page
    assert "&lt;script&gt;1&lt;/script&gt; {{ 7*7 }} :need:`X` |x| a_" in page


def test_reqif_loads_by_its_schema(tmp_path: Path) -> None:
    file = tmp_path / "case.reqif"
    file.write_text(reqif("warehouse", ITEMS, NOW), "utf-8")
    command = [Path(sys.executable).with_name("reqif"), "validate", "--use-reqif-schema", file]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "0 errors, 0 schema issues found, 0 semantic issues found" in done.stdout
    from reqif.parser import ReqIFParser

    bundle = ReqIFParser.parse(str(file))
    (specification,) = bundle.core_content.req_if_content.specifications
    names = [
        bundle.get_spec_object_by_ref(entry.spec_object).long_name
        for entry in bundle.iterate_specification_hierarchy(specification)
    ]
    assert names == ["HitsPerson", "FullSpeed"]
    (relation,) = bundle.core_content.req_if_content.spec_relations
    assert (relation.source, relation.target) == tuple(export_ids([GUARANTEE, HAZARD]).values())


NODES = [
    Node("G1", "goal", HOSTILE, ["S1"], ["C1"]),
    Node("C1", "context", "warehouse.yml"),
    Node("S1", "strategy", "text and time", ["G2", "G3"]),
    Node("G2", "goal", "compiled.py is the model", ["Sn1"]),
    Node("G3", "goal", "in time", undeveloped=True),
    Node("Sn1", "solution", "verify", url="report.html#verify"),
]


def test_the_argument_is_a_graph_in_both_forms() -> None:
    loaded = yaml.safe_load(gsn(NODES))
    assert {id_: node.get("supportedBy", []) for id_, node in loaded.items()} == {
        node.id: [*node.supported_by] for node in NODES
    }
    assert [id_ for id_, node in loaded.items() if node.get("undeveloped")] == ["G3"]
    root = ET.fromstring(sacm("warehouse", NODES))
    elements = [*root.iter("argumentationElement")]
    ends = [
        tuple(elements[int(of.get(end, "").rpartition(".")[2])].get("gid") for end in _ENDS)
        for of in elements
        if of.get("source")
    ]
    expected = {(to, node.id) for node in NODES for to in (*node.supported_by, *node.in_context_of)}
    assert {*ends} == expected


_ENDS = ("source", "target")


def test_junit_has_a_case_for_what_is_not_covered() -> None:
    cases = [Case("w.G", "path"), Case("w.G", "cut", HOSTILE), Case("w.I", "body", "", "by hand")]
    root = ET.fromstring(junit({"w": ({"compiled_sha256": "ab"}, cases)}))
    (suite,) = root
    assert [suite.get(name) for name in ("tests", "failures", "skipped")] == ["3", "1", "1"]
    assert [case.get("name") for case in suite.iter("testcase") if not len(case)] == ["path"]


def test_needs_hold_the_links() -> None:
    needs = json.loads(needs_json("w", ITEMS, NOW))["versions"]["1.0"]["needs"]
    assert needs["GUARANTEE_WAREHOUSE_FULLSPEED"]["links"] == ["HAZARD_HITSPERSON"]
