"""Each diagnostic of ConSert YAML: a small file that earns it, and its exact text.

The cases stand in ``diagnostics.txt``: ``### NAME``, a file, ``>>>``, what is reported. Sections of
the file replace those of one sound ConSert, unless the name says ``(whole file)``.
"""

import re
from pathlib import Path

import pytest

from eddi_scaffold.common.catalogue import area
from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.consert_model import ConSertModel

SOUND = {
    "guarantees": "guarantees:\n  - id: G\n    dimensions:\n      - Binary: {type: Safe}\n",
    "demands": "demands: []\n",
    "evidence": "evidence:\n  - id: E\n    dimension:\n      Binary: {type: Seen}\n",
    "gates": "gates: []\n",
    "tree_propagations": "tree_propagations:\n  - {from: E, to: G}\n",
    "required_services": "required_services: []\n",
    "provided_services": "provided_services: []\n",
}


def read_cases() -> dict[str, tuple[str, str]]:
    text = Path(__file__).with_name("diagnostics.txt").read_text(encoding="utf-8")
    cases = {}
    for case in re.split(r"(?m)^### ", text)[1:]:
        title, _, rest = case.partition("\n")
        given, _, expected = rest.partition(">>>\n")
        name, whole, _ = title.partition(" (whole file)")
        cases[name] = (given if whole else changed(given), expected.rstrip("\n"))
    return cases


def changed(given: str) -> str:
    sections = [part for part in re.split(r"(?m)^(?=\S+:)", given) if part]
    return "".join({**SOUND, **{part.partition(":")[0]: part for part in sections}}.values())


CASES = read_cases()


@pytest.mark.parametrize("name", CASES)
def test_text_of_the_diagnostic(name):
    text, expected = CASES[name]
    lines = []
    for problem in ConSertModel.read_file(Source("m.yml", text.encode()), ()).problems:
        place = problem.place
        where = f"{place.file}:{place.line}:{place.col}"
        lines.append(f"{where}: {problem.level}: {problem.message} [{problem.code}]")
        lines += [f"  hint: {problem.hint}"] if problem.hint else []
    assert "\n".join(lines) == expected


def test_every_code_has_a_case():
    diagnostics = area("C").diagnostics.values()
    codes = {name[:4] for name in CASES}
    assert all(codes & {diagnostic.code, *diagnostic.absorbed} for diagnostic in diagnostics)


def test_the_sound_file_has_no_problem():
    reading = ConSertModel.read_file(Source("m.yml", changed("").encode()), ())
    assert reading.problems == ()
    assert [model.name for model in reading.models] == ["m"]
