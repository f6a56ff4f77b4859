"""Random EDDIs against truth tables, and damaged ones of every kind."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest
from hypothesis import settings
from lxml import etree

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.eddi_xml.document import MONITORED
from eddi_scaffold.eddi_xml.reading import read_document
from eddi_scaffold.eddi_xml.survey import survey
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.monitors.loading import read_models
from tests.kinds.consert.running import monitor_of
from tests.metamodel.eddis import random_eddi
from tests.metamodel.expected import FOLDER, expected

IS_LONG = settings().max_examples > 1000
SEEDS = range(500 if IS_LONG else 100)
DAMAGES = 300 if IS_LONG else 15
NOT_OURS = {"X009", "X010", "X011"}
NOT_THESE = {"X006.unknown", "X014.no_input", "R013.cut_sets_differ"}
NOT_THESE |= {"X007.at", "X007.nothing", "X007.token"}

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", SEEDS)
def test_random_eddis_give_what_truth_tables_say(seed: int) -> None:
    eddi = random_eddi(seed)
    reading = read_models(Source(f"{seed}.xml", eddi.data))
    assert not [one for one in reading.problems if one.level == "error"]
    consert, tree = reading.models
    problems = [
        *reading.problems,
        *(p for model in reading.models for p in model.check()),
    ]
    assert not {one.code for one in problems} & NOT_OURS
    assert not {one.case for one in problems} & NOT_THESE
    monitor, inputs = monitor_of(consert)
    for row in product([False, True], repeat=len(eddi.leaves)):
        true = dict(zip(eddi.leaves, row, strict=True))
        found = {one["id"]: one["active"] for one in monitor.execute_step(inputs(true))}
        assert found == {name: holds(true) for name, holds in eddi.guarantees.items()}
    assert at_start(tree.data).p_fail == pytest.approx(eddi.p_fail, rel=1e-9, abs=1e-12)


def damaged(data: bytes, random: Random) -> bytes:
    """Return a file in which an attribute or an element is lost, repeated or another one."""
    root = etree.fromstring(data)
    for _ in range(random.randint(1, 2)):
        element = random.choice(list(root.iter()))
        names = list(element.attrib)
        what = random.choice(["drop", "change", "exchange", "remove", "repeat"])
        parent = element.getparent()
        if what == "remove" and parent is not None:
            parent.remove(element)
        elif what == "repeat" and parent is not None:
            copy = etree.fromstring(etree.tostring(element))
            parent.insert(random.randint(0, len(parent)), copy)
        elif names and what == "drop":
            del element.attrib[random.choice(names)]
        elif names and what == "change":
            texts = ["", "0", "-1", "NaN", "x", "//", "//@a.0", "true", "a.xml#//@a.0", "1e999"]
            element.set(random.choice(names), random.choice(texts))
        elif names:
            other = random.choice(list(root.iter()))
            values = list(other.attrib.values()) or [""]
            element.set(random.choice(names), random.choice(values))
    return etree.tostring(root, encoding="UTF-8", xml_declaration=True)


@pytest.mark.parametrize("file", list(expected()))
def test_damaged_files_are_a_model_or_a_diagnostic_with_a_line(file: str) -> None:
    data = (FOLDER / file).read_bytes()
    for seed in range(DAMAGES):
        changed = damaged(data, Random(f"{file} {seed}"))
        reading = read_models(Source(file, changed))
        problems = [*reading.problems, *reading.unread]
        for model in reading.models if not has_errors(problems) else ():
            found = model.check()
            problems += found
            if not has_errors(found):
                problems += model.configure(Options())[1]
        assert all(one.place.line for one in problems if one.code[0] in "XRC"), (seed, problems)
        if not reading.models and not problems:
            document, _ = read_document(Source(file, changed))
            assert document is not None
            assert not {model["kind"] for model in survey(document)["models"]} & MONITORED, seed
