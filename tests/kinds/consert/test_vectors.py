"""Vectors of ConSerts: those of an independent program, and every mutant is killed or equal."""

from __future__ import annotations

import itertools
import json
import random
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from hypothesis import settings

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.read_short import read_consert
from eddi_scaffold.kinds.consert.vectors import ConSertVectors
from eddi_scaffold.packages.assembly import monitors_of
from tests.data_files import tabled
from tests.evidence.mutants import Mutated

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests" / "data" / "evidence" / "conserts.yml"
CASES = {case["id"]: case for case in yaml.safe_load(DATA.read_text("utf-8"))}


@pytest.mark.parametrize("name", CASES)
def test_vectors_are_those_of_the_definition(name: str) -> None:
    case = CASES[name]
    consert, _ = read_consert(Source(f"{name}.yml", json.dumps(case["model"]).encode()))
    assert consert is not None
    vectors = ConSertVectors(consert)
    ids = [guarantee.id for guarantee in consert.guarantees]
    assert list(consert.leaves) == case["want"]["leaves"]
    for id_, expected in case["want"]["guarantees"].items():
        got = defaultdict[str, set[str]](set)
        for class_, leaves in vectors.of(id_):
            verdict = vectors.verdicts(leaves)[ids.index(id_)]
            got[class_].add(f"{vectors.letters(leaves)} {verdict}")
        for class_ in ("path", "path_rest_unknown", "cut", "cut_rest_unknown", "unknown"):
            assert got[class_] == set(expected[class_]), class_
        assert len(got["mcdc"]) == expected["mcdc_minimum"]
        assert len(got["mcdc"]) == len(expected["mcdc_pairs"]) + 1
        pairs = itertools.combinations(got["mcdc"], 2)
        flips = ([a != b for a, b in zip(*pair, strict=True)] for pair in pairs)
        decided = {of.index(True) for of in flips if of[-1] and sum(of) == 2}
        assert [vectors.consert.leaves[k] for k in sorted(decided)] == expected["mcdc_pairs"]
        assert [sorted(path) for path in vectors.paths[id_] or ()] == expected["paths"]
        assert [sorted(cut) for cut in vectors.cuts[id_] or ()] == expected["cuts"]


PROVED = 20  # of the survivors of a package in the quick profile
RAW = (True, False, None, 1, float("nan"), "True")


def observed(monitor_class: Any) -> list[object]:
    """Return all that a monitor shows, for all that its inputs can be."""
    names = [spec.attribute for spec in monitor_class.inputs]
    rows: list[object] = []
    for values in itertools.product(RAW, repeat=len(names)):
        monitor = monitor_class()
        output = monitor.execute_step(SimpleNamespace(**dict(zip(names, values, strict=True))), 0)
        rows += [repr(output), monitor.verdicts(), monitor.input_verdicts()]
        rows += [monitor.explain(), monitor.best_guarantees(), monitor.faults()]
    return rows


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@tabled
def test_each_mutant_is_killed_or_proved_equal_by_exhaustion(
    id_: str, model: str | None, config: str, least: int, tmp_path: Path
) -> None:
    examples = ROOT / "examples"
    monitors, _ = monitors_of(examples / model if model else None, [examples / config])
    mutated = Mutated(next(monitor for monitor in monitors if monitor.id == id_), tmp_path)
    survivors = [*mutated.survivors()]
    assert mutated.kills >= least
    if settings.default.max_examples <= 1000 and len(survivors) > PROVED:
        survivors = random.Random(1).sample(survivors, PROVED)  # the long profile proves all
    expected = observed(mutated.original)
    for change, mutant in survivors:
        assert observed(mutant) == expected, change
